#include <cmath>

#include "surface/march_cells_build.h"
#include "surface/packet.h"
#include "surface/sized_field.h"

namespace meniscus {
namespace {

/// Above the iso-value by this part of what is left up to one, a corner is well inside.
constexpr float kWellInside = 0.5f;
constexpr int kCorners = kMarchCube + 1;

/// A bit for each corner: row z * 17 + y, bit x.
using CornerRows = std::array<std::uint32_t, kCorners * kCorners>;

struct Range {
  int first, last;  ///< cells of the cube, both included; none if last < first
};

class Cube {
 public:
  Cube(const RaycastField& field, const MarchCubePlace& place) : field_(field), place_(place) {}

  Range cells(float from, float to, int axis) const {
    const double first = march_cell(from, place_.low[axis], place_.size) - place_.first[axis],
                 last = march_cell(to, place_.low[axis], place_.size) - place_.first[axis];
    return {static_cast<int>(std::clamp(first, 0.0, 1.0 * kMarchCube)),
            static_cast<int>(std::clamp(last, -1.0, kMarchCube - 1.0))};
  }

  vec3 corner(int x, int y, int z) const {
    const auto at = [&](int axis, int c) {
      return static_cast<float>(static_cast<double>(place_.low[axis]) +
                                static_cast<double>(place_.first[axis] + c) * static_cast<double>(place_.size));
    };
    return {at(0, x), at(1, y), at(2, z)};
  }

  void mark(vec3 low, vec3 high, MarchRows& rows) const {
    const Range xs = cells(low.x, high.x, 0), ys = cells(low.y, high.y, 1), zs = cells(low.z, high.z, 2);
    if (xs.last < xs.first) return;
    const auto bits = static_cast<std::uint16_t>((2u << xs.last) - (1u << xs.first));
    for (int z = zs.first; z <= zs.last; ++z)
      for (int y = ys.first; y <= ys.last; ++y) rows[static_cast<std::size_t>(z * kMarchCube + y)] |= bits;
  }

  void mark_reached(const RaycastField& level, MarchRows& rows) const {
    const BandGrid& grid = level.grid;
    const vec3 low = corner(0, 0, 0), high = corner(kMarchCube, kMarchCube, kMarchCube);
    mark_closed(grid, low, high, rows);
    const float reach = level.options.smoothing_length;  // no entry sphere is larger
    grid.for_each_run(low - reach, high + reach, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const float r = level.entry_radius[i];
        if (r > 0.0f) mark(grid.position(i) - r, grid.position(i) + r, rows);
      }
    });
  }

  /// Whether the box touches cells only that are full.
  bool is_full(int first_x, int first_y, int first_z, int side) const {
    const BandGrid& grid = field_.grid;
    if (!grid.has_deep() || field_.has_sizes()) return false;
    const vec3 low = corner(first_x, first_y, first_z), high = corner(first_x + side, first_y + side, first_z + side);
    // No two of these places are farther apart than a cell, so that each cell that the box touches holds one.
    const int steps =
        1 + static_cast<int>(std::ceil(1.01f * static_cast<float>(side) * place_.size / grid.cell_size()));
    for (int z = 0; z <= steps; ++z)
      for (int y = 0; y <= steps; ++y)
        for (int x = 0; x <= steps; ++x)
          if (!grid.full_at(glm::mix(low, high, vec3(x, y, z) / static_cast<float>(steps)))) return false;
    return true;
  }

 private:
  /// Cells that are hidden or deep: of their particles not all are kept, or have spheres.
  void mark_closed(const BandGrid& grid, vec3 low, vec3 high, MarchRows& rows) const {
    if (!grid.has_hidden()) return;
    const float width = grid.cell_size();
    const auto first = glm::max(glm::ivec3(glm::floor((low - grid.origin()) / width)) - 1, 0);
    const auto last = glm::min(glm::ivec3(glm::floor((high - grid.origin()) / width)) + 1,
                               BandGrid::kSide * glm::ivec3(grid.blocks_x(), grid.blocks_y(), grid.blocks_z()) - 1);
    for (int bz = first.z / 8; bz <= last.z / 8; ++bz)
      for (int by = first.y / 8; by <= last.y / 8; ++by)
        for (int bx = first.x / 8; bx <= last.x / 8; ++bx) {
          const int block = grid.find(bx, by, bz);
          if (block < 0 || grid.all_open(block)) continue;
          const glm::ivec3 corner = grid.corner(block), from = glm::max(first - corner, 0),
                           to = glm::min(last - corner, BandGrid::kSide - 1);
          for (int z = from.z; z <= to.z; ++z)
            for (int y = from.y; y <= to.y; ++y)
              for (int x = from.x; x <= to.x; ++x) {
                if (grid.kinds(block)[(z * 8 + y) * 8 + x] == BandGrid::open) continue;
                const vec3 at = grid.low(block) + width * vec3(x, y, z);
                mark(at, at + width, rows);
              }
        }
  }

  const RaycastField& field_;
  const MarchCubePlace& place_;
};

/// Cells that are reached and around which all cells of the cube are: at a corner of one that is not, no particle's
/// entry sphere ends, and the density is low.
MarchRows amidst_reached(MarchRows rows) {
  for (std::uint16_t& row : rows)
    row = static_cast<std::uint16_t>(row & (row << 1 | 1) & (row >> 1 | 1 << (kMarchCube - 1)));
  for (const int stride : {1, kMarchCube}) {
    const MarchRows before = rows;
    for (int i = 0; i < kMarchCube * kMarchCube; ++i) {
      const int place = i / stride % kMarchCube;
      if (place > 0) rows[static_cast<std::size_t>(i)] &= before[static_cast<std::size_t>(i - stride)];
      if (place + 1 < kMarchCube) rows[static_cast<std::size_t>(i)] &= before[static_cast<std::size_t>(i + stride)];
    }
  }
  return rows;
}

std::size_t corner_row(int y, int z) { return static_cast<std::size_t>(z * kCorners + y); }

/// Sums the density at corners of one cube, sixteen near ones at once.
class CornerSums {
 public:
  explicit CornerSums(const RaycastField& field, CornerRows& high)
      : field_(field),
        high_(high),
        enough_(field.options.iso + kWellInside * std::max(1.0f - field.options.iso, 0.1f)) {}

  void add(const Cube& cube, int x, int y, int z) {
    const vec3 p = cube.corner(x, y, z);
    points_.x[count_] = p.x;
    points_.y[count_] = p.y;
    points_.z[count_] = p.z;
    row_[count_] = corner_row(y, z);
    bit_[count_++] = 1u << x;
    if (count_ == kPacket) sum();
  }

  /// Of what was added since the last sums: the bits of those that are well inside are set.
  void sum() {
    if (count_ == 0) return;
    for (int l = count_; l < kPacket; ++l) {
      points_.x[l] = points_.x[0];
      points_.y[l] = points_.y[0];
      points_.z[l] = points_.z[0];
    }
    thread_local PacketList list;
    alignas(64) float density[kPacket];
    density_packet(field_, points_, (PacketMask{1} << count_) - 1, false, list, density);
    for (int l = 0; l < count_; ++l)
      if (density[l] >= enough_) high_[row_[l]] |= bit_[l];
    count_ = 0;
  }

 private:
  const RaycastField& field_;
  CornerRows& high_;
  float enough_;
  PacketPoints points_;
  std::size_t row_[kPacket];
  std::uint32_t bit_[kPacket];
  int count_ = 0;
};

}  // namespace

MarchRows reached_cells(const RaycastField& field, const MarchCubePlace& place) {
  MarchRows reached{};
  const Cube cube(field, place);
  for_each_level(field, [&](const RaycastField& level) { cube.mark_reached(level, reached); });
  return reached;
}

bool all_full(const RaycastField& field, const MarchCubePlace& place) {
  return Cube(field, place).is_full(0, 0, 0, kMarchCube);
}

MarchRows inside_cells(const RaycastField& field, const MarchCubePlace& place, const MarchRows& reached) {
  const Cube cube(field, place);
  const MarchRows candidates = amidst_reached(reached);
  CornerRows asked{}, high{};
  std::uint32_t any = 0;
  for (int z = 0; z < kMarchCube; ++z)
    for (int y = 0; y < kMarchCube; ++y) {
      const std::uint32_t row = candidates[static_cast<std::size_t>(z * kMarchCube + y)], corners = row | row << 1;
      any |= row;
      for (int k = 0; k < 4; ++k) asked[corner_row(y + (k & 1), z + (k >> 1))] |= corners;
    }
  if (any == 0) return {};

  // Four cells a side that are full need no sums.
  for (int z = 0; z < kMarchCube; z += 4)
    for (int y = 0; y < kMarchCube; y += 4)
      for (int x = 0; x < kMarchCube; x += 4) {
        std::uint32_t all = 0xfu << x;
        for (int k = 0; k < 16; ++k) all &= candidates[static_cast<std::size_t>((z + k / 4) * kMarchCube + y + k % 4)];
        if (all == 0xfu << x && cube.is_full(x, y, z, 4))
          for (int k = 0; k < 25; ++k) high[corner_row(y + k % 5, z + k / 5)] |= 0x1fu << x;
      }

  CornerSums sums(field, high);
  for (int z0 = 0; z0 < kCorners; z0 += 4)
    for (int y0 = 0; y0 < kCorners; y0 += 4)
      for (int x0 = 0; x0 < kCorners; x0 += 4) {
        for (int z = z0; z < std::min(z0 + 4, kCorners); ++z)
          for (int y = y0; y < std::min(y0 + 4, kCorners); ++y)
            for (std::uint32_t row = asked[corner_row(y, z)] & ~high[corner_row(y, z)] & 0xfu << x0; row != 0;
                 row &= row - 1)
              sums.add(cube, __builtin_ctz(row), y, z);
        sums.sum();
      }

  MarchRows inside = candidates;
  for (int z = 0; z < kMarchCube; ++z)
    for (int y = 0; y < kMarchCube; ++y) {
      const std::uint32_t row = high[corner_row(y, z)] & high[corner_row(y + 1, z)] & high[corner_row(y, z + 1)] &
                                high[corner_row(y + 1, z + 1)];
      inside[static_cast<std::size_t>(z * kMarchCube + y)] &= static_cast<std::uint16_t>(row & row >> 1);
    }
  return inside;
}

}  // namespace meniscus
