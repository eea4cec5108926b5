#include "surface/spheres_crossings.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Where a ray is in a ball, m along the ray.
struct Stretch {
  float in = kInfinity, out = kInfinity;
  std::size_t ball = 0;
  bool found() const { return in < kInfinity; }
};

class BallRay {
 public:
  BallRay(const BandGrid& grid, float radius, const MarchCells& cells, const Ray& ray)
      : grid_(grid),
        radius_(radius),
        cells_(cells),
        shift_(shift_of(grid, ray)),
        ray_{ray.origin + shift_ * ray.direction, ray.direction} {}

  Crossing into(float given_from, float given_limit) const {
    float from = given_from - shift_;
    const float limit = given_limit - shift_;
    Crossing crossing;
    Stretch here = around(from);
    if (here.found()) {  // in a ball, against what was said
      here = last_of_chain(here);
      if (here.out - from > soon()) return {given_from, facing(here, from, -1.0f)};
      from = here.out;
    }
    const Stretch next = first_after(from, limit);
    if (next.found()) crossing = {next.in + shift_, facing(next, next.in, -1.0f)};
    return crossing;
  }

  Crossing out_of(float given_from, float given_limit) const {
    const float from = given_from - shift_, limit = given_limit - shift_;
    Stretch here = around(from);
    if (!here.found()) {  // between the balls, against what was said
      here = first_after(from, std::min(limit, from + soon()));
      if (!here.found()) return {given_from, ray_.direction};
    }
    here = last_of_chain(here);
    if (here.out > limit) return {};
    return {here.out + shift_, facing(here, here.out, 1.0f)};
  }

 private:
  /// A ray that begins far away is taken to begin beside the middle of the balls, where its places can be told apart.
  static float shift_of(const BandGrid& grid, const Ray& ray) {
    if (grid.size() == 0) return 0.0f;
    const float to_middle = glm::dot(grid.bounds().centre() - ray.origin, ray.direction);
    return std::abs(to_middle) > glm::length(grid.bounds().extent()) ? to_middle : 0.0f;
  }

  float soon() const { return 2.0f * radius_; }
  vec3 at(float t) const { return ray_.origin + t * ray_.direction; }

  vec3 facing(const Stretch& stretch, float t, float along) const {
    const vec3 off = at(t) - grid_.position(stretch.ball);
    return glm::length(off) > 0.0f ? glm::normalize(off) : along * ray_.direction;
  }

  /// Calls visit(stretch) for the balls that reach into the box around the ray from t to u, and that it meets.
  template <class Visit>
  void for_each_ball(float t, float u, Visit visit) const {
    const float reach = 1.01f * radius_;
    grid_.for_each_run(glm::min(at(t), at(u)) - reach, glm::max(at(t), at(u)) + reach,
                       [&](std::size_t begin, std::size_t end) {
                         for (std::size_t j = begin; j < end; ++j) {
                           const vec3 offset = grid_.position(j) - ray_.origin;
                           const float middle = glm::dot(offset, ray_.direction);
                           const vec3 across = offset - middle * ray_.direction;
                           const float half2 = radius_ * radius_ - glm::dot(across, across);
                           if (!(half2 > 0.0f)) continue;
                           const float half = std::sqrt(half2);
                           visit(Stretch{middle - half, middle + half, j});
                         }
                       });
  }

  /// Of the balls that hold the place t, the one that is left last.
  Stretch around(float t) const {
    Stretch best;
    for_each_ball(t, t, [&](const Stretch& stretch) {
      if (stretch.in <= t && stretch.out > t && (!best.found() || stretch.out > best.out)) best = stretch;
    });
    return best;
  }

  /// From ball to ball while they overlap along the ray.
  Stretch last_of_chain(Stretch here) const {
    for (Stretch next = around(here.out); next.found(); next = around(here.out)) here = next;
    return here;
  }

  /// The ball that is entered first, not before `from`.
  Stretch first_after(float from, float limit) const {
    for (float t = from;;) {
      t = cells_.leave(ray_, t, limit, MarchCells::outside);
      if (!(t <= limit && t < kInfinity)) return {};
      const float next = t + 2.0f * radius_;
      if (!(next > t)) return {};  // far beyond the balls
      Stretch best;
      for_each_ball(t, next, [&](const Stretch& stretch) {
        if (stretch.in >= from && stretch.in <= next && stretch.in < best.in) best = stretch;
      });
      if (best.found()) return best.in <= limit ? best : Stretch{};
      t = next;
    }
  }

  const BandGrid& grid_;
  float radius_;
  const MarchCells& cells_;
  float shift_;  ///< m, from the given ray's beginning
  Ray ray_;
};

}  // namespace

MarchCells ball_cells(const BandGrid& grid, float radius) {
  RaycastOptions options;
  options.spacing = 2.0f * radius;
  options.smoothing_length = 2.0f * radius;
  RaycastField field;
  field.options = options;
  field.least_spacing = options.spacing;
  field.grid = grid;
  field.entry_radius.assign(grid.size(), radius);
  return MarchCells(field, MarchCells::Find::outside_only);
}

void ball_crossings(const BandGrid& grid, float radius, const MarchCells& cells, std::span<const Ray> rays,
                    std::span<const float> from, std::span<const float> limit, std::span<const std::uint8_t> inside,
                    std::span<Crossing> found) {
  if (from.size() != rays.size() || limit.size() != rays.size() || inside.size() != rays.size() ||
      found.size() != rays.size())
    throw Error(ErrorCode::invalid_argument, "the lists of rays to follow have different lengths");
  parallel_for(rays.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const BallRay ray(grid, radius, cells, rays[i]);
      if (!(from[i] <= limit[i]))
        found[i] = {};
      else
        found[i] = inside[i] ? ray.out_of(from[i], limit[i]) : ray.into(from[i], limit[i]);
    }
  });
}

}  // namespace meniscus
