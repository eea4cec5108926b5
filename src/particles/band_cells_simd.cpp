#include "particles/band_cells.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "particles/band_cells_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using IntTag = hn::RebindToSigned<Tag>;
using WordTag = hn::RebindToUnsigned<Tag>;

HWY_INLINE void find_range(const float* HWY_RESTRICT values, std::size_t count, float& low, float& high) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  float least = values[0], most = values[0];
  if (count >= 2 * lanes) {
    auto least_a = hn::LoadU(d, values), least_b = hn::LoadU(d, values + lanes);
    auto most_a = least_a, most_b = least_b;
    for (i = 2 * lanes; i + 2 * lanes <= count; i += 2 * lanes) {
      const auto a = hn::LoadU(d, values + i), b = hn::LoadU(d, values + i + lanes);
      least_a = hn::Min(least_a, a);
      least_b = hn::Min(least_b, b);
      most_a = hn::Max(most_a, a);
      most_b = hn::Max(most_b, b);
    }
    least = hn::GetLane(hn::MinOfLanes(d, hn::Min(least_a, least_b)));
    most = hn::GetLane(hn::MaxOfLanes(d, hn::Max(most_a, most_b)));
  }
  for (; i < count; ++i) {
    least = std::min(least, values[i]);
    most = std::max(most, values[i]);
  }
  low = least;
  high = most;
}

/// Cells of one vector along an axis; no value lies below `low`.
HWY_INLINE hn::Vec<IntTag> cells_of(const float* HWY_RESTRICT values, float low, float per_cell) {
  const Tag d;
  return hn::ConvertTo(IntTag(), hn::Mul(hn::Sub(hn::LoadU(d, values), hn::Set(d, low)), hn::Set(d, per_cell)));
}

/// Quarters of them, four of which are a cell to the last bit.
HWY_INLINE hn::Vec<IntTag> quarters_of(const float* HWY_RESTRICT values, float low, float per_cell) {
  const Tag d;
  const auto cells = hn::Mul(hn::Sub(hn::LoadU(d, values), hn::Set(d, low)), hn::Set(d, per_cell));
  return hn::ConvertTo(IntTag(), hn::Mul(cells, hn::Set(d, 4.0f)));
}

class DenseKeys {
 public:
  explicit DenseKeys(const BandCells& cells) : cells_(cells) {}

  HWY_INLINE hn::Vec<WordTag> vector(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                                     const float* HWY_RESTRICT z) const {
    return of_cells(cells_of(x, cells_.low.x, cells_.per_cell), cells_of(y, cells_.low.y, cells_.per_cell),
                    cells_of(z, cells_.low.z, cells_.per_cell));
  }

  /// With the bits of patches.
  HWY_INLINE hn::Vec<WordTag> vector(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                                     const float* HWY_RESTRICT z, hn::Vec<WordTag>& patches) const {
    const WordTag d;
    const auto qx = quarters_of(x, cells_.low.x, cells_.per_cell), qy = quarters_of(y, cells_.low.y, cells_.per_cell),
               qz = quarters_of(z, cells_.low.z, cells_.per_cell);
    // A cell's first quarter counts as 0 or 4, which leaves the patches of a cell apart as they are.
    const auto sum = hn::Add(hn::Add(qx, qz), hn::ShiftLeft<1>(hn::Add(qy, qz)));
    const auto patch = hn::And(hn::BitCast(d, sum), hn::Set(d, 7u));
    patches = hn::Shl(hn::Set(d, 1u << kBandCountBits), patch);
    return of_cells(hn::ShiftRight<2>(qx), hn::ShiftRight<2>(qy), hn::ShiftRight<2>(qz));
  }

  std::uint32_t one(float x, float y, float z, std::uint32_t& patches) const {
    const auto quarter = [&](float value, float low) {
      return static_cast<std::uint32_t>((value - low) * cells_.per_cell * 4.0f);
    };
    patches = 1u << (kBandCountBits +
                     band_patch(quarter(x, cells_.low.x), quarter(y, cells_.low.y), quarter(z, cells_.low.z)));
    return one(x, y, z);
  }

  std::uint32_t one(float x, float y, float z) const {
    const auto cell = [&](float value, float low) {
      return static_cast<std::uint32_t>((value - low) * cells_.per_cell);
    };
    const std::uint32_t cx = cell(x, cells_.low.x), cy = cell(y, cells_.low.y), cz = cell(z, cells_.low.z);
    const std::uint32_t block = ((cz >> 3) * static_cast<std::uint32_t>(cells_.blocks_y) + (cy >> 3)) *
                                    static_cast<std::uint32_t>(cells_.blocks_x) +
                                (cx >> 3);
    return block << 9 | (cz & 7) << 6 | (cy & 7) << 3 | (cx & 7);
  }

 private:
  HWY_INLINE hn::Vec<WordTag> of_cells(hn::Vec<IntTag> cx, hn::Vec<IntTag> cy, hn::Vec<IntTag> cz) const {
    const IntTag d;
    const auto across = hn::Set(d, cells_.blocks_x), down = hn::Set(d, cells_.blocks_y), in_block = hn::Set(d, 7);
    const auto block = hn::Add(hn::Mul(hn::Add(hn::Mul(hn::ShiftRight<3>(cz), down), hn::ShiftRight<3>(cy)), across),
                               hn::ShiftRight<3>(cx));
    const auto cell = hn::Or(hn::ShiftLeft<6>(hn::And(cz, in_block)),
                             hn::Or(hn::ShiftLeft<3>(hn::And(cy, in_block)), hn::And(cx, in_block)));
    return hn::BitCast(WordTag(), hn::Or(hn::ShiftLeft<9>(block), cell));
  }

  BandCells cells_;
};

}  // namespace

void FindPieceBoxes(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y, const float* HWY_RESTRICT z,
                    std::size_t count, Bounds* HWY_RESTRICT boxes) {
  for (std::size_t i = 0; i < count; i += kBandBox, ++boxes) {
    const std::size_t here = std::min(kBandBox, count - i);
    find_range(x + i, here, boxes->low.x, boxes->high.x);
    find_range(y + i, here, boxes->low.y, boxes->high.y);
    find_range(z + i, here, boxes->low.z, boxes->high.z);
  }
}

void FindDenseKeys(const BandCells& cells, const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                   const float* HWY_RESTRICT z, std::size_t count, std::uint32_t* HWY_RESTRICT keys) {
  const DenseKeys keys_of(cells);
  const std::size_t lanes = hn::Lanes(IntTag());
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) hn::StoreU(keys_of.vector(x + i, y + i, z + i), WordTag(), keys + i);
  for (; i < count; ++i) keys[i] = keys_of.one(x[i], y[i], z[i]);
}

void FindDenseKeysAndPatches(const BandCells& cells, const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                             const float* HWY_RESTRICT z, std::size_t count, std::uint32_t* HWY_RESTRICT keys,
                             std::uint32_t* HWY_RESTRICT patches) {
  const WordTag d;
  const DenseKeys keys_of(cells);
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    auto bits = hn::Zero(d);
    hn::StoreU(keys_of.vector(x + i, y + i, z + i, bits), d, keys + i);
    hn::StoreU(bits, d, patches + i);
  }
  for (; i < count; ++i) keys[i] = keys_of.one(x[i], y[i], z[i], patches[i]);
}

std::size_t FindKeptKeys(const BandCells& cells, const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                         const float* HWY_RESTRICT z, std::size_t count, const std::uint32_t* HWY_RESTRICT left_out,
                         std::uint32_t* HWY_RESTRICT keys, std::uint32_t* HWY_RESTRICT places) {
  const WordTag d;
  const DenseKeys keys_of(cells);
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0, kept = 0;
  const auto keep_one = [&](std::uint32_t key, std::size_t place) {
    keys[kept] = key;
    places[kept] = static_cast<std::uint32_t>(place);
    kept += ~left_out[key >> 5] >> (key & 31u) & 1u;
  };
  for (; i + lanes <= count; i += lanes) {
    const auto key = keys_of.vector(x + i, y + i, z + i);
    alignas(64) std::uint32_t all[16];
    hn::Store(key, d, all);
#if HWY_TARGET == HWY_AVX3
    // Particles that follow each other lie in two blocks at most, mostly: a vector holds all 512 bits of each.
    const std::uint32_t first = all[0] >> 9, last = all[15] >> 9;
    const auto block = hn::ShiftRight<9>(key);
    const auto in_first = hn::Eq(block, hn::Set(d, first)), in_last = hn::Eq(block, hn::Set(d, last));
    if (HWY_LIKELY(hn::AllTrue(d, hn::Or(in_first, in_last)))) {
      const auto word = hn::IndicesFromVec(d, hn::And(hn::ShiftRight<5>(key), hn::Set(d, 15u)));
      const auto bits =
          hn::IfThenElse(in_first, hn::TableLookupLanes(hn::LoadU(d, left_out + std::size_t{16} * first), word),
                         hn::TableLookupLanes(hn::LoadU(d, left_out + std::size_t{16} * last), word));
      const auto bit = hn::And(hn::Shr(bits, hn::And(key, hn::Set(d, 31u))), hn::Set(d, 1u));
      const auto here = hn::Eq(bit, hn::Zero(d));
      if (hn::AllFalse(d, here)) continue;
      hn::CompressStore(key, here, d, keys + kept);
      kept += hn::CompressStore(hn::Iota(d, static_cast<std::uint32_t>(i)), here, d, places + kept);
      continue;
    }
#endif
    for (std::size_t l = 0; l < lanes; ++l) keep_one(all[l], i + l);
  }
  for (; i < count; ++i) keep_one(keys_of.one(x[i], y[i], z[i]), i);
  return kept;
}

void FindQuarters(float low, float per_cell, const float* HWY_RESTRICT values, std::size_t count,
                  std::int32_t* HWY_RESTRICT quarters) {
  const IntTag di;
  const std::size_t lanes = hn::Lanes(di);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) hn::StoreU(quarters_of(values + i, low, per_cell), di, quarters + i);
  for (; i < count; ++i) quarters[i] = static_cast<std::int32_t>((values[i] - low) * per_cell * 4.0f);
}

void FindWellFilled(const std::uint32_t* HWY_RESTRICT counts, std::uint32_t least,
                    const std::uint32_t* HWY_RESTRICT patches, std::uint32_t fewest, std::uint64_t* HWY_RESTRICT bits) {
  const WordTag d;
  const auto one = hn::Set(d, 1u);
  const std::size_t lanes = hn::Lanes(d);
  const auto enough = hn::Set(d, least);
  for (std::size_t word = 0; word < 8; ++word) {
    std::uint64_t all = 0;
    for (std::size_t k = 0; k < 64; k += lanes) {
      std::uint8_t mask[8] = {};
      const auto here = hn::LoadU(d, counts + 64 * word + k);
      auto apart = hn::LoadU(d, patches + 64 * word + k);
      for (std::uint32_t n = 1; n < fewest; ++n) apart = hn::And(apart, hn::Sub(apart, one));  // without the lowest bit
      hn::StoreMaskBits(d, hn::And(hn::Eq(hn::Max(here, enough), here), hn::Ne(apart, hn::Zero(d))), mask);
      all |= (std::uint64_t{mask[0]} | std::uint64_t{mask[1]} << 8) << k;
    }
    bits[word] = all;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(FindPieceBoxes);
HWY_EXPORT(FindDenseKeys);
HWY_EXPORT(FindKeptKeys);
HWY_EXPORT(FindDenseKeysAndPatches);
HWY_EXPORT(FindQuarters);
HWY_EXPORT(FindWellFilled);

void find_piece_boxes(const float* x, const float* y, const float* z, std::size_t count, Bounds* boxes) {
  HWY_DYNAMIC_DISPATCH(FindPieceBoxes)(x, y, z, count, boxes);
}

void find_dense_keys(const BandCells& cells, const float* x, const float* y, const float* z, std::size_t count,
                     std::uint32_t* keys) {
  HWY_DYNAMIC_DISPATCH(FindDenseKeys)(cells, x, y, z, count, keys);
}

void find_dense_keys(const BandCells& cells, const float* x, const float* y, const float* z, std::size_t count,
                     std::uint32_t* keys, std::uint32_t* patches) {
  HWY_DYNAMIC_DISPATCH(FindDenseKeysAndPatches)(cells, x, y, z, count, keys, patches);
}

std::size_t find_kept_keys(const BandCells& cells, const float* x, const float* y, const float* z, std::size_t count,
                           const std::uint32_t* left_out, std::uint32_t* keys, std::uint32_t* places) {
  return HWY_DYNAMIC_DISPATCH(FindKeptKeys)(cells, x, y, z, count, left_out, keys, places);
}

void find_well_filled(const std::uint32_t* counts, std::uint32_t least, const std::uint32_t* patches,
                      std::uint32_t fewest, std::uint64_t* bits) {
  HWY_DYNAMIC_DISPATCH(FindWellFilled)(counts, least, patches, fewest, bits);
}

void find_quarters(float low, float per_cell, const float* values, std::size_t count, std::int32_t* quarters) {
  HWY_DYNAMIC_DISPATCH(FindQuarters)(low, per_cell, values, count, quarters);
}

}  // namespace meniscus
#endif
