#include "particles/morton.h"

#include <algorithm>
#include <array>
#include <utility>

namespace meniscus {
namespace {

/// Two zero bits after each of the lowest 21 bits.
std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

}  // namespace

std::uint64_t morton_key(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

std::uint64_t hash_of(std::uint64_t v) {
  v += 0x9e3779b97f4a7c15;
  v = (v ^ v >> 30) * 0xbf58476d1ce4e5b9;
  v = (v ^ v >> 27) * 0x94d049bb133111eb;
  return v ^ v >> 31;
}

// The upper half of the bits by radix, 11 bits a pass, the rest where particles agree in those.
void sort_by_key(std::vector<Keyed>& items) {
  constexpr int kBits = 11, kUpper = 3 * kMortonLevels - 3 * kBits;
  std::vector<Keyed> other(items.size());
  for (int shift = kUpper; shift < 3 * kMortonLevels; shift += kBits) {
    std::array<std::size_t, 1 << kBits> starts{};
    const auto digit = [&](const Keyed& item) { return item.key >> shift & ((1 << kBits) - 1); };
    for (const Keyed& item : items) ++starts[digit(item)];
    if (starts[digit(items.front())] == items.size()) continue;
    std::size_t sum = 0;
    for (std::size_t& start : starts) sum += std::exchange(start, sum);
    for (const Keyed& item : items) other[starts[digit(item)]++] = item;
    items.swap(other);
  }
  const auto before = [](const Keyed& a, const Keyed& b) { return a.key != b.key ? a.key < b.key : a.index < b.index; };
  for (std::size_t begin = 0, end = 0; begin < items.size(); begin = end) {
    while (end < items.size() && items[end].key >> kUpper == items[begin].key >> kUpper) ++end;
    if (end - begin < 2) continue;
    std::sort(items.begin() + static_cast<std::ptrdiff_t>(begin), items.begin() + static_cast<std::ptrdiff_t>(end),
              before);
  }
}

}  // namespace meniscus
