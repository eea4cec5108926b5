// Points where the edges of the grid cross the iso-surface, moved onto it [Iwasaki2008] 4.3.
#include "surface/surfel_block.h"

#include <glm/geometric.hpp>

#include "surface/density_tile.h"
#include "surface/march_simd.h"
#include "surface/surfel_sums.h"

namespace meniscus {
namespace {

constexpr int kX = kBlockX + 2, kY = kBlockY + 2, kZ = kBlockZ + 2;  ///< points with their surroundings
constexpr int kBrick = 5;  ///< own points of a brick along each axis: its surfels share their particles
constexpr int kBricksX = (kBlockX + kBrick - 1) / kBrick, kBricksY = (kBlockY + kBrick - 1) / kBrick,
              kBricksZ = (kBlockZ + kBrick - 1) / kBrick, kBricks = kBricksX * kBricksY * kBricksZ;
constexpr int kEvaluations = 6;
/// Spacings: how near the iso-surface a surfel's position is.
constexpr float kTolerance = 2e-4f;

/// A sample of the surface on its way to become a surfel; lengths in steps, places from the tile's first point.
struct Sample {
  vec3 place{0};
  int axis = 0;                ///< of its edge; 3: in the middle of a cell, free to move along the gradient
  float low = 0, high = 1;     ///< ends of the edge that the surface lies between
  float below = 0, above = 0;  ///< density minus iso-value there
  float at = 0;                ///< between them
  float reach = 0;             ///< of its disc
  bool own = false;
};

class Block {
 public:
  Block(const RaycastField& field, const SurfelGrid& grid, int x, int y, int z) : field_(field), grid_(grid) {
    tile_.low = grid.low + grid.step * vec3{x * kBlockX - 1, y * kBlockY - 1, z * kBlockZ - 1};
    tile_.step = vec3{grid.step};
    tile_.nx = kX;
    tile_.ny = kY;
    tile_.nz = kZ;
    tile_.row_pitch = DensityTile::pitch_of(kX);
    tile_.plane_pitch = tile_.row_pitch * kY;
  }

  void run(std::vector<Surfel>& surfels) {
    thread_local AlignedFloats values;
    values.reserve(tile_.plane_pitch * kZ, 0);
    tile_.values = values.data();
    splat_into_tile(field_, tile_);
    if (!find_inside()) return;
    find_crossings();
    visit_cells();
    sort_into_bricks();
    for (std::size_t first = 0; first < order_.size();) {
      std::size_t last = first + 1;
      while (last < order_.size() && last - first < kPacket && brick_of(order_[last]) == brick_of(order_[first]))
        ++last;
      finish(first, last, surfels);
      first = last;
    }
  }

 private:
  float value(int i, int j, int k) const {
    return tile_.values[static_cast<std::size_t>(k) * tile_.plane_pitch +
                        static_cast<std::size_t>(j) * tile_.row_pitch + static_cast<std::size_t>(i)];
  }
  std::uint32_t row(int j, int k) const { return inside_[k * kY + j]; }
  static std::size_t edge(int axis, int i, int j, int k) {
    return static_cast<std::size_t>(((axis * kZ + k) * kY + j) * kX + i);
  }

  /// One bit a point; false when all are on one side.
  bool find_inside() {
    std::uint32_t any = 0, all = ~0u;
    for (int k = 0; k < kZ; ++k)
      for (int j = 0; j < kY; ++j) {
        std::uint32_t bits = 0;
        for (int i = 0; i < kX; ++i) bits |= static_cast<std::uint32_t>(value(i, j, k) >= field_.options.iso) << i;
        inside_[k * kY + j] = bits;
        any |= bits;
        all &= bits;
      }
    return any != 0 && all != ~0u;
  }

  static bool is_own(int i, int j, int k) {
    return i >= 1 && i <= kBlockX && j >= 1 && j <= kBlockY && k >= 1 && k <= kBlockZ;
  }

  /// A sample on every edge whose ends lie on different sides, where the line between their densities crosses.
  void find_crossings() {
    samples_.clear();
    edges_.resize(static_cast<std::size_t>(3 * kX * kY * kZ));
    const float iso = field_.options.iso;
    for (int k = 0; k < kZ; ++k)
      for (int j = 0; j < kY; ++j)
        for (int axis = 0; axis < 3; ++axis) {
          if ((axis == 1 && j + 1 == kY) || (axis == 2 && k + 1 == kZ)) continue;
          const std::uint32_t here = row(j, k);
          std::uint32_t crossing = here ^ (axis == 0 ? here >> 1 : row(j + (axis == 1), k + (axis == 2)));
          if (axis == 0) crossing &= 0x7fffffffu;
          for (; crossing != 0; crossing &= crossing - 1) {
            const int i = __builtin_ctz(crossing);
            Sample sample;
            sample.place = vec3{i, j, k};
            sample.axis = axis;
            sample.below = value(i, j, k) - iso;
            sample.above = value(i + (axis == 0), j + (axis == 1), k + (axis == 2)) - iso;
            sample.at = std::clamp(sample.below / (sample.below - sample.above), 0.0f, 1.0f);
            sample.own = is_own(i, j, k);
            edges_[edge(axis, i, j, k)] = static_cast<std::uint32_t>(samples_.size());
            samples_.push_back(sample);
          }
        }
  }

  static vec3 place_of(const Sample& sample) {
    vec3 place = sample.place;
    if (sample.axis < 3) place[sample.axis] += sample.at;
    return place;
  }

  /// The discs of a cell's samples reach their middle: those of two neighbours cover the triangle between them and the
  /// middle, and so all the discs the polygon that the surface makes in the cell.
  void visit_cells() {
    const float gap = grid_.gap_threshold / grid_.step;
    for (int k = 0; k + 1 < kZ; ++k)
      for (int j = 0; j + 1 < kY; ++j) {
        const std::uint32_t a = row(j, k), b = row(j + 1, k), c = row(j, k + 1), d = row(j + 1, k + 1);
        const std::uint32_t any = a | b | c | d, all = a & b & c & d;
        for (std::uint32_t cells = (any | any >> 1) & ~(all & all >> 1) & 0x7fffffffu; cells != 0; cells &= cells - 1) {
          const int i = __builtin_ctz(cells);
          std::uint32_t found[12];
          int count = 0;
          const auto look = [&](int axis, int x, int y, int z) {
            const std::uint32_t here = row(y, z) >> x,
                                there = row(y + (axis == 1), z + (axis == 2)) >> (x + (axis == 0));
            if ((here ^ there) & 1u) found[count++] = edges_[edge(axis, x, y, z)];
          };
          for (int v = 0; v < 2; ++v)
            for (int u = 0; u < 2; ++u) {
              look(0, i, j + u, k + v);
              look(1, i + u, j, k + v);
              look(2, i + u, j + v, k);
            }
          vec3 middle{0};
          for (int n = 0; n < count; ++n) middle += place_of(samples_[found[n]]);
          middle /= static_cast<float>(count);
          float farthest = 0;
          for (int n = 0; n < count; ++n) {
            Sample& sample = samples_[found[n]];
            const float distance = glm::length(place_of(sample) - middle);
            sample.reach = std::max(sample.reach, distance);
            farthest = std::max(farthest, distance);
          }
          if (2.0f * farthest > gap && is_own(i, j, k)) {
            Sample added;
            added.place = middle;
            added.axis = 3;
            added.reach = 0.75f * farthest;
            added.own = true;
            samples_.push_back(added);
          }
        }
      }
  }

  int brick_of(std::uint32_t index) const {
    const vec3 place = samples_[index].place;
    const auto along = [](float p, int bricks) { return std::min((static_cast<int>(p) - 1) / kBrick, bricks - 1); };
    return (along(place.z, kBricksZ) * kBricksY + along(place.y, kBricksY)) * kBricksX + along(place.x, kBricksX);
  }

  void sort_into_bricks() {
    std::array<std::uint32_t, kBricks + 1> start{};
    for (std::uint32_t i = 0; i < samples_.size(); ++i)
      if (samples_[i].own) ++start[static_cast<std::size_t>(brick_of(i)) + 1];
    for (std::size_t b = 0; b < kBricks; ++b) start[b + 1] += start[b];
    order_.resize(start[kBricks]);
    for (std::uint32_t i = 0; i < samples_.size(); ++i)
      if (samples_[i].own) order_[start[static_cast<std::size_t>(brick_of(i))]++] = i;
  }

  vec3 in_world(vec3 place) const { return tile_.low + grid_.step * place; }

  /// Moves up to sixteen samples onto the iso-surface and appends their surfels.
  void finish(std::size_t first, std::size_t last, std::vector<Surfel>& surfels) {
    thread_local PacketList list;
    Sample* lanes[kPacket];
    vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
    for (std::size_t l = 0; l < kPacket; ++l) {
      Sample& sample = samples_[order_[std::min(first + l, last - 1)]];
      lanes[l] = &sample;
      vec3 from = sample.place, to = sample.place;
      if (sample.axis < 3)
        to[sample.axis] += 1.0f;
      else
        from -= 1.0f, to += 1.0f;
      low = glm::min(low, from);
      high = glm::max(high, to);
    }
    gather_near(field_, in_world(low), in_world(high), list);
    const int count = static_cast<int>(last - first);
    PacketPoints points;
    PacketTangents tangents;
    vec3 normals[kPacket];
    IsoSums sums;
    bool near[kPacket] = {};
    for (int evaluation = 1;; ++evaluation) {
      for (int l = 0; l < kPacket; ++l) {
        const vec3 p = in_world(place_of(*lanes[l]));
        points.x[l] = p.x;
        points.y[l] = p.y;
        points.z[l] = p.z;
      }
      iso_sums(field_, list, points, nullptr, sums);
      bool all_near = true;
      for (int l = 0; l < count; ++l) {
        const vec3 gradient{sums.gx[l], sums.gy[l], sums.gz[l]};
        const float off = sums.density[l] - field_.options.iso;
        near[l] = std::abs(off) <= kTolerance * field_.options.spacing * glm::length(gradient);
        if (near[l] || evaluation == kEvaluations) continue;
        all_near = false;
        move(*lanes[l], off, grid_.step * gradient);
      }
      if (all_near || evaluation == kEvaluations) break;
    }
    for (int l = 0; l < kPacket; ++l) {
      const vec3 gradient{sums.gx[l], sums.gy[l], sums.gz[l]};
      const float size = glm::length(gradient);
      const vec3 normal = size > 0.0f ? -gradient / size : vec3{0, 0, 1};
      normals[l] = normal;
      // Along the surface, first across the axis that the normal has least of.
      const vec3 size3 = glm::abs(normal);
      const vec3 axis = size3.x <= size3.y && size3.x <= size3.z ? vec3{1, 0, 0}
                        : size3.y <= size3.z                     ? vec3{0, 1, 0}
                                                                 : vec3{0, 0, 1};
      const vec3 t = glm::normalize(glm::cross(normal, axis)), u = glm::cross(normal, t);
      tangents.t.x[l] = t.x, tangents.t.y[l] = t.y, tangents.t.z[l] = t.z;
      tangents.u.x[l] = u.x, tangents.u.y[l] = u.y, tangents.u.z[l] = u.z;
    }
    iso_sums(field_, list, points, &tangents, sums);
    for (int l = 0; l < count; ++l) {
      if (lanes[l]->axis == 3 && !near[l]) continue;  // two pieces of surface in one cell: between them is none
      Surfel surfel;
      surfel.position = {points.x[l], points.y[l], points.z[l]};
      surfel.normal = normals[l];
      surfel.radius = grid_.step * (kRadiusMargin * lanes[l]->reach + kLeastRadius);
      bend(sums.tt[l], sums.uu[l], sums.tu[l], {tangents.t.x[l], tangents.t.y[l], tangents.t.z[l]},
           {tangents.u.x[l], tangents.u.y[l], tangents.u.z[l]}, surfel);
      surfels.push_back(surfel);
    }
  }

  /// Mean curvature and bend from the curvatures in the frame of the tangents t and u. The principal ones are kept from
  /// bending the disc too much: ripple of single particles tells nothing of the surface's form.
  static void bend(float tt, float uu, float tu, vec3 t, vec3 u, Surfel& surfel) {
    const float mean = 0.5f * (tt + uu), half = 0.5f * (tt - uu), size = std::sqrt(half * half + tu * tu);
    const float most = kMostBend / surfel.radius;
    const float larger = std::clamp(mean + size, -most, most), smaller = std::clamp(mean - size, -most, most);
    surfel.curvature = 0.5f * (larger + smaller);
    if (!(size > 0.0f)) return;
    // The larger one lies half the angle of (half, tu) from t.
    const float c = std::sqrt(std::max(0.5f + 0.5f * half / size, 0.0f)),
                s = std::copysign(std::sqrt(std::max(0.5f - 0.5f * half / size, 0.0f)), tu);
    surfel.bend = 0.5f * (larger - smaller) * glm::normalize(c * t + s * u);
  }

  /// One step towards the surface: Newton's, along the edge within the ends that bracket it, or along the gradient.
  void move(Sample& sample, float off, vec3 gradient) const {
    if (sample.axis == 3) {
      const vec3 step = gradient * (-off / std::max(glm::dot(gradient, gradient), 1e-12f));
      sample.place += step * std::min(1.0f, 0.5f / std::max(glm::length(step), 1e-12f));
      return;
    }
    if ((off < 0.0f) == (sample.below < 0.0f))
      sample.low = sample.at, sample.below = off;
    else
      sample.high = sample.at, sample.above = off;
    const float slope = gradient[sample.axis];
    const float newton = sample.at - off / slope;
    sample.at = newton > sample.low && newton < sample.high ? newton : 0.5f * (sample.low + sample.high);
  }

  static constexpr float kRadiusMargin = 1.15f, kLeastRadius = 0.12f;  ///< steps; curvature and rounding
  static constexpr float kMostBend = 0.7f;                             ///< principal curvature times radius

  const RaycastField& field_;
  const SurfelGrid& grid_;
  DensityTile tile_;
  std::uint32_t inside_[kY * kZ];  ///< bit i of row (j, k): whether the point is in the water
  std::vector<Sample> samples_;
  std::vector<std::uint32_t> edges_;  ///< sample of each edge that crosses the surface
  std::vector<std::uint32_t> order_;  ///< own samples by brick
};

}  // namespace

void add_block_surfels(const RaycastField& field, const SurfelGrid& grid, int x, int y, int z,
                       std::vector<Surfel>& surfels) {
  static_assert(kX == 32, "a row's points are the bits of a word");
  Block(field, grid, x, y, z).run(surfels);
}

}  // namespace meniscus
