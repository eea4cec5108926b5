#include "surface/thickness_water.h"

#include <glm/geometric.hpp>

#include "surface/thickness_canvas.h"

namespace meniscus {
namespace {

/// A particle or eighth of a cell that is at most so many samples wide is a point.
constexpr float kWidestPoint = 3.0f;
/// Spacings that the water of spheres falls off over where it ends: boxes beside them have to begin so.
constexpr float kEdge = 1.5f;
constexpr std::size_t kMostPieces = 16;
constexpr double kPieceCost = 20000, kBlockCost = 100;  ///< in particles

/// Cells of a block that count.
BandBits cells_of(const WaterShare& share, glm::ivec3 corner) {
  BandBits bits{};
  const int first = std::clamp(share.first - corner[share.axis], 0, BandGrid::kSide);
  const int end = std::clamp(share.end - corner[share.axis], 0, BandGrid::kSide);
  for (int slice = 0; slice < BandGrid::kSide; ++slice)
    for (int cell = 0; cell < 64; ++cell) {
      const int place = share.axis == 0 ? cell % 8 : share.axis == 1 ? cell / 8 : slice;
      if (place >= first && place < end) bits[static_cast<std::size_t>(slice)] |= std::uint64_t{1} << cell;
    }
  return bits;
}

/// Whether all rays through the box run nearly along an axis' plane: the sum of boxes then ends in steps that single
/// rays would place to half a sample (18 % of the water in lines along the walls). Told for the whole picture, so that
/// boxes beside each other stay without a seam; views that see a wall edge on in one column alone do not pay for it.
bool sees_sides(const Bounds& box, const SplatCamera& camera) {
  constexpr float kSteep = 0.2f;  // sine of the angle
  if (!camera.perspective)
    return glm::min(glm::min(std::abs(camera.forward.x), std::abs(camera.forward.y)), std::abs(camera.forward.z)) <
           kSteep;
  for (int axis = 0; axis < 3; ++axis) {
    float low = 1, high = -1;
    for (int corner = 0; corner < 8; ++corner) {
      const vec3 at{(corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                    (corner & 4) != 0 ? box.high.z : box.low.z};
      const vec3 offset = at - camera.eye;
      const float length = glm::length(offset), sine = length > 0.0f ? offset[axis] / length : 0.0f;
      low = std::min(low, sine);
      high = std::max(high, sine);
    }
    if (low > -kSteep && high < kSteep) return true;
  }
  return false;
}

/// Blocks that are added to one canvas after another.
class Water {
 public:
  Water(const CountedCells& counted, float spacing, const SplatCamera& camera, const WaterShare& share)
      : grid_(counted.grid()),
        spacing_(spacing),
        camera_(camera),
        volume_(spacing * spacing * spacing),
        share_(share),
        edge_(sees_sides(grid_.bounds(), camera) ? kEdge * spacing : 0.0f),
        counted_(counted) {}

  SplatBox box(int block) const {
    const float half = 0.5f * grid_.cell_size() * BandGrid::kSide;
    return {grid_.low(block) + half, vec3{half}};
  }

  /// Samples that the block's water may be added to.
  SampleRect samples(int block) const {
    SplatBox around = box(block);
    around.half += kThicknessRadius * spacing_;
    SampleRect rect = samples_of(camera_, around);
    if (rect.empty()) return rect;
    // Points touch the sample beside theirs.
    rect.x0 = static_cast<std::uint16_t>(std::max(rect.x0 - 1, 0));
    rect.y0 = static_cast<std::uint16_t>(std::max(rect.y0 - 1, 0));
    rect.x1 = static_cast<std::uint16_t>(std::min(rect.x1 + 1, camera_.width - 1));
    rect.y1 = static_cast<std::uint16_t>(std::min(rect.y1 + 1, camera_.height - 1));
    return rect;
  }

  void add(int block, ThicknessCanvas& canvas) const {
    const SampleRect rect = samples(block);
    if (rect.empty()) return;
    const SplatBox whole = box(block);
    const float depth = glm::dot(whole.middle - camera_.eye, camera_.forward);
    const float half = glm::dot(glm::abs(camera_.forward), whole.half) + kThicknessRadius * spacing_;
    // Samples that a spacing is wide where it is widest; what lies around the eye's plane has to be cut by it.
    const float near = depth - half;
    const float spacing_samples = !(near > 0.0f)        ? 2.0f * kWidestPoint
                                  : camera_.perspective ? spacing_ / (near * camera_.du)
                                                        : spacing_ / camera_.du;
    const bool all_spheres = share_.all <= kAllSpheres;
    const int place = grid_.corner(block)[share_.axis];
    const bool is_cut = share_.first > place || share_.end < place + BandGrid::kSide;
    BandBits cells = counted_.cells(block), skipped = cells;
    std::uint64_t all = ~std::uint64_t{0}, any = 0;
    const BandBits own = is_cut ? cells_of(share_, grid_.corner(block)) : BandBits{};
    for (std::size_t slice = 0; slice < cells.size(); ++slice) {
      if (is_cut) {
        cells[slice] &= own[slice];
        skipped[slice] |= ~own[slice];
      }
      all &= cells[slice];
      any |= cells[slice];
    }
    if (all == ~std::uint64_t{0}) {
      add_cells_as_box(block, {0, 0, 0}, BandGrid::kSide, canvas);
      return;
    }
    const bool as_boxes = all_spheres || 0.5f * spacing_samples * grid_.cell_size() > kWidestPoint * spacing_;
    const bool as_spheres = all_spheres || spacing_samples > kWidestPoint;
    thread_local PointCanvas points;
    if (!as_boxes || !as_spheres) points.start(rect);
    if (any != 0) add_cells(block, cells, as_boxes, canvas, points);
    if (as_spheres)
      add_spheres(block, skipped, canvas);
    else
      for_each_run_but(block, skipped, [&](const BandGrid::Run& run) {
        add_points(camera_, grid_.x() + run.begin, grid_.y() + run.begin, grid_.z() + run.begin, nullptr,
                   run.end - run.begin, volume_, points);
      });
    if (!as_boxes || !as_spheres) add_sums(points, canvas);
  }

 private:
  /// CountedCells::corner(), but for planes that bound the share: the cells beyond are told by other particles, and
  /// water would be missed or met twice between them.
  vec3 corner(int block, glm::ivec3 cell) const {
    vec3 at = counted_.corner(block, cell);
    const int axis = share_.axis, place = grid_.corner(block)[axis] + cell[axis];
    if (place == share_.first || place == share_.end)
      at[axis] = grid_.low(block)[axis] + grid_.cell_size() * static_cast<float>(cell[axis]);
    return at;
  }

  /// A cube of `side` counted cells.
  void add_cells_as_box(int block, glm::ivec3 first, int side, ThicknessCanvas& canvas) const {
    const vec3 low = corner(block, first), high = corner(block, first + side);
    add_box(camera_, {0.5f * (low + high), 0.5f * (high - low)}, counted_.density(block), edge_, canvas);
  }

  /// The cells that are set: cubes of 4 and of 2 cells a side as boxes, the others one by one.
  void add_cells(int block, const BandBits& cells, bool as_boxes, ThicknessCanvas& canvas, PointCanvas& points) const {
    BandBits rest = cells;
    for (const int side : {4, 2}) add_cubes(block, side, rest, canvas);
    if (as_boxes)
      add_cubes(block, 1, rest, canvas);
    else
      add_cells_as_points(block, rest, points);
  }

  /// Cubes of `side` cells, at multiples of it, all of whose cells are set in `rest`; clears them there.
  void add_cubes(int block, int side, BandBits& rest, ThicknessCanvas& canvas) const {
    for (int z = 0; z < BandGrid::kSide; z += side) {
      std::uint64_t full = ~std::uint64_t{0};
      for (int k = z; k < z + side; ++k) full &= rest[static_cast<std::size_t>(k)];
      if (full == 0) continue;
      for (int y = 0; y < BandGrid::kSide; y += side)
        for (int x = 0; x < BandGrid::kSide; x += side) {
          std::uint64_t cube = 0;
          for (int j = y; j < y + side; ++j) cube |= ((std::uint64_t{1} << side) - 1) << (8 * j + x);
          if ((full & cube) != cube) continue;
          for (int k = z; k < z + side; ++k) rest[static_cast<std::size_t>(k)] &= ~cube;
          add_cells_as_box(block, {x, y, z}, side, canvas);
        }
    }
  }

  /// Eight points a cell: one would show the rows of cells in views along an axis.
  void add_cells_as_points(int block, const BandBits& cells, PointCanvas& canvas) const {
    constexpr std::size_t kPoints = 8 * 64;
    float x[kPoints + 16], y[kPoints + 16], z[kPoints + 16], volumes[kPoints + 16];  // whole vectors are read
    for (int slice = 0; slice < BandGrid::kSide; ++slice) {
      std::size_t number = 0;
      for (std::uint64_t word = cells[static_cast<std::size_t>(slice)]; word != 0; word &= word - 1) {
        const int in_slice = __builtin_ctzll(word);
        const glm::ivec3 cell{in_slice % 8, in_slice / 8, slice};
        const vec3 low = corner(block, cell), size = corner(block, cell + 1) - low;
        for (int k = 0; k < 8; ++k) {
          x[number] = low.x + size.x * ((k & 1) != 0 ? 0.75f : 0.25f);
          y[number] = low.y + size.y * ((k & 2) != 0 ? 0.75f : 0.25f);
          z[number] = low.z + size.z * ((k & 4) != 0 ? 0.75f : 0.25f);
          volumes[number++] = size.x * size.y * size.z;
        }
      }
      if (number > 0) add_points(camera_, x, y, z, volumes, number, counted_.density(block) / 8.0f, canvas);
    }
  }

  /// Calls visit(run) for the particles of those of the block's cells that are not set.
  template <class Visit>
  void for_each_run_but(int block, const BandBits& but, Visit visit) const {
    for (int slice = 0; slice < BandGrid::kSide; ++slice) {
      const std::uint64_t word = but[static_cast<std::size_t>(slice)];
      for (int cell = 0; cell < 64;) {
        const std::uint64_t rest = word >> cell;
        if ((rest & 1) != 0) {
          cell += rest == ~std::uint64_t{0} ? 64 : __builtin_ctzll(~rest);
          continue;
        }
        const int last = rest == 0 ? 63 : cell + __builtin_ctzll(rest) - 1;
        const BandGrid::Run run = grid_.run(block, slice * 64 + cell, slice * 64 + last);
        cell = last + 1;
        if (run.begin < run.end) visit(run);
      }
    }
  }

  void add_spheres(int block, const BandBits& but, ThicknessCanvas& canvas) const {
    const float radius = kThicknessRadius * spacing_;
    const float weight = volume_ / (4.0f / 3.0f * 3.14159265f * radius * radius * radius);
    for_each_run_but(block, but, [&](const BandGrid::Run& run) {
      for (std::size_t i = run.begin; i < run.end; ++i) add_sphere(camera_, grid_.position(i), radius, weight, canvas);
    });
  }

  const BandGrid& grid_;
  float spacing_;
  const SplatCamera& camera_;
  float volume_;  ///< m^3, of a particle
  WaterShare share_;
  float edge_;  ///< m, that the boxes' sides fall off over; 0 where they are not seen along
  const CountedCells& counted_;
};

/// Ends of pieces of the blocks that cost about the same, whatever the number of threads.
std::vector<int> pieces_of(const BandGrid& grid) {
  const int blocks = grid.blocks();
  const double cost = static_cast<double>(grid.size()) + kBlockCost * blocks;
  const auto pieces = std::clamp<std::size_t>(static_cast<std::size_t>(cost / kPieceCost), 1, kMostPieces);
  std::vector<int> ends;
  for (int block = 0; block < blocks; ++block) {
    const double done = static_cast<double>(grid.run(block).end) + kBlockCost * (block + 1);
    if (done * static_cast<double>(pieces) >= cost * static_cast<double>(ends.size() + 1)) ends.push_back(block + 1);
  }
  if (ends.empty() || ends.back() != blocks) ends.push_back(blocks);
  return ends;
}

}  // namespace

Image<float> summed_water(const CountedCells& counted, float spacing, const SplatCamera& camera,
                          const WaterShare& share) {
  const BandGrid& grid = counted.grid();
  Image<float> sums(camera.width, camera.height, 0.0f);
  if (grid.blocks() == 0) return sums;
  const Water water(counted, spacing, camera, share);
  const std::vector<int> ends = pieces_of(grid);
  std::vector<ThicknessCanvas> canvases(ends.size());
  parallel_for(ends.size(), 1, [&](std::size_t piece, std::size_t) {
    const int begin = piece == 0 ? 0 : ends[piece - 1], end = ends[piece];
    SampleRect all;
    for (int block = begin; block < end; ++block) {
      const SampleRect rect = water.samples(block);
      if (rect.empty()) continue;
      if (all.empty()) all = rect;
      all = {std::min(all.x0, rect.x0), std::max(all.x1, rect.x1), std::min(all.y0, rect.y0),
             std::max(all.y1, rect.y1)};
    }
    canvases[piece].start(all);
    if (all.empty()) return;
    for (int block = begin; block < end; ++block) water.add(block, canvases[piece]);
  });
  parallel_for(static_cast<std::size_t>(camera.height), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (const ThicknessCanvas& canvas : canvases) {
        const SampleRect& rect = canvas.rect;
        if (rect.empty() || y < rect.y0 || y > rect.y1) continue;
        const float* from = canvas.row(y - rect.y0);
        float* to = sums.row(y) + rect.x0;
        for (int x = 0; x < canvas.width(); ++x) to[x] += from[x];
      }
  });
  return sums;
}

}  // namespace meniscus
