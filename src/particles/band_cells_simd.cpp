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
  const IntTag di;
  const hn::RebindToUnsigned<IntTag> du;
  const std::size_t lanes = hn::Lanes(di);
  const auto across = hn::Set(di, cells.blocks_x), down = hn::Set(di, cells.blocks_y), in_block = hn::Set(di, 7);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto cx = cells_of(x + i, cells.low.x, cells.per_cell), cy = cells_of(y + i, cells.low.y, cells.per_cell),
               cz = cells_of(z + i, cells.low.z, cells.per_cell);
    const auto block = hn::Add(hn::Mul(hn::Add(hn::Mul(hn::ShiftRight<3>(cz), down), hn::ShiftRight<3>(cy)), across),
                               hn::ShiftRight<3>(cx));
    const auto cell = hn::Or(hn::ShiftLeft<6>(hn::And(cz, in_block)),
                             hn::Or(hn::ShiftLeft<3>(hn::And(cy, in_block)), hn::And(cx, in_block)));
    hn::StoreU(hn::BitCast(du, hn::Or(hn::ShiftLeft<9>(block), cell)), du, keys + i);
  }
  for (; i < count; ++i) {
    const auto cell = [&](float value, float low) {
      return static_cast<std::uint32_t>((value - low) * cells.per_cell);
    };
    const std::uint32_t cx = cell(x[i], cells.low.x), cy = cell(y[i], cells.low.y), cz = cell(z[i], cells.low.z);
    const std::uint32_t block = ((cz >> 3) * static_cast<std::uint32_t>(cells.blocks_y) + (cy >> 3)) *
                                    static_cast<std::uint32_t>(cells.blocks_x) +
                                (cx >> 3);
    keys[i] = block << 9 | (cz & 7) << 6 | (cy & 7) << 3 | (cx & 7);
  }
}

void FindCellCoordinates(float low, float per_cell, const float* HWY_RESTRICT values, std::size_t count,
                         std::int32_t* HWY_RESTRICT cells) {
  const IntTag di;
  const std::size_t lanes = hn::Lanes(di);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) hn::StoreU(cells_of(values + i, low, per_cell), di, cells + i);
  for (; i < count; ++i) cells[i] = static_cast<std::int32_t>((values[i] - low) * per_cell);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(FindPieceBoxes);
HWY_EXPORT(FindDenseKeys);
HWY_EXPORT(FindCellCoordinates);

void find_piece_boxes(const float* x, const float* y, const float* z, std::size_t count, Bounds* boxes) {
  HWY_DYNAMIC_DISPATCH(FindPieceBoxes)(x, y, z, count, boxes);
}

void find_dense_keys(const BandCells& cells, const float* x, const float* y, const float* z, std::size_t count,
                     std::uint32_t* keys) {
  HWY_DYNAMIC_DISPATCH(FindDenseKeys)(cells, x, y, z, count, keys);
}

void find_cell_coordinates(float low, float per_cell, const float* values, std::size_t count, std::int32_t* cells) {
  HWY_DYNAMIC_DISPATCH(FindCellCoordinates)(low, per_cell, values, count, cells);
}

}  // namespace meniscus
#endif
