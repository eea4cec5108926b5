#include "shading/image_space.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Neighbouring pixels belong to one surface up to this change of depth, in pixel sizes: seen at 83 degrees or less.
constexpr float kSteepest = 8.0f;
/// Where the map shows nothing the next point is this much farther.
constexpr float kStride = 2.0f;

/// A point of the ray, and what the map shows there.
struct Probe {
  float t = 0;    ///< m along the ray
  float gap = 0;  ///< m along the view's ray from the point to the scene; negative: the point lies behind it
  vec3 point{0.0f};
  vec2 picture{0.0f};
  vec3 look{0.0f};  ///< direction of the view's ray through the point
  float pixel = 0;  ///< size of a pixel there, m
  bool seen = false;
};

class Iteration {
 public:
  Iteration(const GeometryMap& map, const Ray& ray, float threshold) : map_(map), ray_(ray), threshold_(threshold) {}

  Probe probe(float t) const {
    const vec3 at = map_.view.project(ray_.origin + t * ray_.direction);
    if (map_.view.projection != Projection::orthographic && !(at.z > 0)) return missed(t);
    return probe(t, {at.x, at.y});
  }

  Probe probe(float t, vec2 picture) const {
    const View& view = map_.view;
    Probe result = missed(t);
    if (!(std::abs(picture.x) < 1e9f && std::abs(picture.y) < 1e9f)) return result;
    const bool flat = view.projection == Projection::orthographic;
    const vec3 offset = result.point - view.eye;
    const float away = flat ? glm::dot(offset, view.forward) : glm::length(offset);
    result.picture = picture;
    result.look = flat ? view.forward : away > 0 ? offset / away : ray_.direction;
    result.gap = depth_at(map_, picture) - away;
    result.pixel = view.pixel_size(std::max(away, 1e-20f));
    result.seen = true;
    return result;
  }

  bool met(const Probe& probe) const {
    return probe.seen && std::abs(probe.gap) < (threshold_ > 0 ? threshold_ : probe.pixel);
  }

 private:
  Probe missed(float t) const {
    Probe result;
    result.t = t;
    result.point = ray_.origin + t * ray_.direction;
    return result;
  }

  const GeometryMap& map_;
  const Ray& ray_;
  float threshold_;
};

ImageSpaceHit hit_of(const GeometryMap& map, const Probe& probe, bool met, int iterations) {
  const vec2 p = probe.picture;
  const bool inside =
      p.x >= 0 && p.y >= 0 && p.x < static_cast<float>(map.view.width) && p.y < static_cast<float>(map.view.height);
  return {probe.t, probe.point, p, met, probe.seen && inside, iterations};
}

}  // namespace

float depth_at(const GeometryMap& map, vec2 picture_point) {
  const Image<float>& depth = *map.depth;
  const int width = depth.width(), height = depth.height();
  const float x = std::clamp(picture_point.x, 0.0f, static_cast<float>(width));
  const float y = std::clamp(picture_point.y, 0.0f, static_cast<float>(height));
  const float nearest = depth(std::min(static_cast<int>(x), width - 1), std::min(static_cast<int>(y), height - 1));
  if (!(nearest < kInfinity) || map.view.projection == Projection::cube) return nearest;

  // The four pixel centres around the point, if they show one surface.
  const float u = std::clamp(x - 0.5f, 0.0f, static_cast<float>(width - 1));
  const float v = std::clamp(y - 0.5f, 0.0f, static_cast<float>(height - 1));
  const int x0 = static_cast<int>(u), y0 = static_cast<int>(v);
  const int x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
  const float a = depth(x0, y0), b = depth(x1, y0), c = depth(x0, y1), d = depth(x1, y1);
  const float low = std::min({a, b, c, d}), high = std::max({a, b, c, d});
  if (!(low > 0) || !(high - low <= kSteepest * map.view.pixel_size(low))) return nearest;
  const float fu = u - static_cast<float>(x0), fv = v - static_cast<float>(y0);
  const auto mixed = [&](float p, float q, float r, float s) {
    return (1 - fv) * ((1 - fu) * p + fu * q) + fv * ((1 - fu) * r + fu * s);
  };
  // On a plane in perspective it is the inverse of the depth that is linear in the picture.
  if (map.view.projection == Projection::orthographic) return mixed(a, b, c, d);
  return 1.0f / mixed(1 / a, 1 / b, 1 / c, 1 / d);
}

ImageSpaceHit image_space_hit(const GeometryMap& map, const Ray& ray, vec2 start, float threshold, int iterations) {
  const Iteration iteration(map, ray, threshold);
  Probe here = iteration.probe(0.0f, start), before = here;
  if (iteration.met(here)) return hit_of(map, here, true, 0);
  if (!here.seen) return hit_of(map, here, false, 0);

  float front = 0, behind = kInfinity;  // m along the ray: the scene lies between them
  for (int n = 1; n <= iterations; ++n) {
    if (here.seen && here.gap < 0)
      behind = here.t;
    else
      front = here.t;
    const bool bracketed = behind < kInfinity;

    // P3 projected onto the ray; where the map shows nothing, farther on.
    float next = here.t;
    if (!here.seen || !(here.gap < kInfinity))
      next = bracketed ? 0.5f * (front + behind) : std::max(kStride * here.t, 16.0f * here.pixel);
    else {
      next += here.gap * glm::dot(here.look, ray.direction);
      const float rise = here.gap - before.gap, run = here.t - before.t;
      if (n > 1 && before.seen && before.gap < kInfinity && rise * run < 0) next = here.t - here.gap * run / rise;
    }
    if (bracketed && !(next > front && next < behind)) next = 0.5f * (front + behind);
    next = std::max(next, 0.0f);
    if (!(next < kInfinity) || next == here.t) return hit_of(map, here, false, n);

    const Probe probe = iteration.probe(next);
    if (!probe.seen && !bracketed) return hit_of(map, here, false, n);  // behind the eye
    before = here;
    here = probe;
    if (iteration.met(here)) return hit_of(map, here, true, n);
  }
  return hit_of(map, here, false, iterations);
}

}  // namespace meniscus
