#include "particles/band_parts.h"

#include <algorithm>

namespace meniscus {

void BandPart::count(const Particles& particles) {
  std::uint32_t keys[kBandPiece], patches[kBandPiece];
  for (std::size_t from = begin_; from < end_; from += kBandPiece) {
    const std::size_t to = std::min(from + kBandPiece, end_);
    if (!dense_) {
      for_each_hashed(particles, from, to, [&](std::size_t, Entry& entry, std::uint32_t cell, std::uint32_t patch) {
        Counter& counter = counter_of(entry, cell);
        counter = (counter + 1) | 1u << (kBandCountBits + patch);
      });
      continue;
    }
    find_dense_keys(cells_, &particles.x[from], &particles.y[from], &particles.z[from], to - from, keys, patches);
    for (std::size_t i = 0; i < to - from; ++i) {
      Counter*& page = table_[keys[i] >> 9];
      if (!page) page = new_page();
      Counter& counter = page[keys[i] & 511u];
      counter = (counter + 1) | patches[i];
    }
  }
}

void BandPart::add_blocks(std::vector<std::uint64_t>& keys) const {
  for (std::size_t block = 0; block < table_.size(); ++block)
    if (table_[block]) keys.push_back(block);
  for (const Entry& entry : entries_) keys.push_back(entry.key);
}

std::int32_t BandPart::find(std::uint64_t key) const {
  if (hashed_.empty()) return -1;
  const std::size_t mask = hashed_.size() - 1;
  for (std::size_t at = hash_of(key) & mask;; at = (at + 1) & mask) {
    const std::int32_t entry = hashed_[at];
    if (entry < 0 || entries_[static_cast<std::size_t>(entry)].key == key) return entry;
  }
}

std::int32_t BandPart::find_or_add(std::uint64_t key) {
  const std::int32_t known = find(key);
  if (known >= 0) return known;
  const auto insert = [&](std::int32_t entry) {
    const std::size_t mask = hashed_.size() - 1;
    std::size_t at = hash_of(entries_[static_cast<std::size_t>(entry)].key) & mask;
    while (hashed_[at] >= 0) at = (at + 1) & mask;
    hashed_[at] = entry;
  };
  entries_.emplace_back().key = key;
  const auto added = static_cast<std::int32_t>(entries_.size() - 1);
  if (2 * entries_.size() > hashed_.size()) {
    hashed_.assign(std::max<std::size_t>(64, 2 * hashed_.size()), -1);
    for (std::int32_t entry = 0; entry <= added; ++entry) insert(entry);
  } else {
    insert(added);
  }
  return added;
}

BandPart::Counter& BandPart::counter_of(Entry& entry, std::uint32_t cell) {
  if (entry.page) return entry.page[cell];
  for (std::size_t i = 0; i < entry.cells; ++i)
    if (entry.cell[i] == cell) return entry.counter[i];
  if (entry.cells < kFew) {
    entry.cell[entry.cells] = static_cast<std::uint16_t>(cell);
    return entry.counter[entry.cells++];
  }
  entry.page = new_page();
  for (std::size_t i = 0; i < entry.cells; ++i) entry.page[entry.cell[i]] = entry.counter[i];
  return entry.page[cell];
}

}  // namespace meniscus
