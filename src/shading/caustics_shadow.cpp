// Solids in the way of light to and from the mean level of the water.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "shading/caustics_plane.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Points along a side of the blocks in which the sun is looked for at the corners alone; blocks whose corners differ
/// and those near the shadow of a small body are looked at point by point.
constexpr int kBlock = 4;
/// A body whose shadow's box covers more of the field than this is not small.
constexpr float kLarge = 0.25f;
/// Rays along the light at most.
constexpr int kMostRays = 1 << 14;

struct Rectangle {
  vec2 low{kInfinity}, high{-kInfinity};
};

Bounds world_bounds(const PlacedSolid& placed) {
  const Bounds box = placed.solid->bounds();
  Bounds result;
  if (box.empty()) return result;
  for (int k = 0; k < 8; ++k) {
    const glm::vec4 corner{k & 1 ? box.high.x : box.low.x, k & 2 ? box.high.y : box.low.y,
                           k & 4 ? box.high.z : box.low.z, 1.0f};
    result.add(vec3(placed.world_from_solid * corner));
  }
  return result;
}

/// What of a horizontal level the light meets that goes through a box.
/// @param slide  m along a and b for each metre up, along the light
/// @param low, high  the part of the box between these levels counts
Rectangle meeting(const Bounds& box, const FieldFrame& frame, float level, vec2 slide, float low, float high) {
  Rectangle result;
  const float bottom = std::max(box.low[frame.up], low), top = std::min(box.high[frame.up], high);
  if (!(bottom <= top)) return result;
  for (const float at : {bottom, top}) {
    const vec2 shift = slide * (level - at);
    result.low = glm::min(result.low, frame.across(box.low) + shift);
    result.high = glm::max(result.high, frame.across(box.high) + shift);
  }
  return result;
}

}  // namespace

Image<float> sunlit(const HeightField& field, const WaterLevel& level, const Scene& scene, vec3 sun) {
  if (scene.solid_bounds().empty() || !level.any()) return {};
  const FieldFrame& frame = level.frame();
  if (!(scene.solid_bounds().high[frame.up] > level.lowest())) return {};
  const vec2 slide = frame.across(sun) / std::max(sun[frame.up], 1e-3f);
  const vec2 extent = frame.high() - frame.low;
  const int across = (frame.width - 1) / kBlock + 1, along = (frame.height - 1) / kBlock + 1;
  Image<std::uint8_t> near(across, along, std::uint8_t{0});
  bool any = false, large = scene.tank().style == TankStyle::tiled;
  for (const PlacedSolid& placed : scene.solids()) {
    Rectangle shadow = meeting(world_bounds(placed), frame, level.mean(), slide, level.lowest(), kInfinity);
    const vec2 margin = glm::abs(slide) * (level.highest() - level.lowest()) + frame.step;
    shadow.low = glm::max(shadow.low - margin, frame.low);
    shadow.high = glm::min(shadow.high + margin, frame.high());
    if (!(shadow.low.x <= shadow.high.x && shadow.low.y <= shadow.high.y)) continue;
    const vec2 part = (shadow.high - shadow.low) / extent;
    if (part.x * part.y > kLarge) {
      large = true;
      continue;
    }
    any = true;
    const vec2 first = (shadow.low - frame.low) / frame.step / static_cast<float>(kBlock);
    const vec2 last = (shadow.high - frame.low) / frame.step / static_cast<float>(kBlock);
    for (int y = static_cast<int>(first.y); y <= std::min(static_cast<int>(last.y), along - 1); ++y)
      for (int x = static_cast<int>(first.x); x <= std::min(static_cast<int>(last.x), across - 1); ++x) near(x, y) = 1;
  }
  if (!any && !large) return {};
  const auto sees_sun = [&](int x, int y) {
    const float height = field.height(x, y) > -kInfinity ? field.height(x, y) : level.mean();
    return scene.shadowed(frame.world(frame.place(x, y), height), sun) ? 0.0f : 1.0f;
  };
  Image<float> corners(across + 1, along + 1, 1.0f);
  if (large)
    parallel_for(static_cast<std::size_t>(along + 1), 2, [&](std::size_t begin, std::size_t end) {
      for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
        for (int x = 0; x <= across; ++x)
          corners(x, y) = sees_sun(std::min(x * kBlock, frame.width - 1), std::min(y * kBlock, frame.height - 1));
    });
  Image<float> lit(frame.width, frame.height, 1.0f);
  parallel_for(static_cast<std::size_t>(along), 1, [&](std::size_t begin, std::size_t end) {
    for (int v = static_cast<int>(begin); v < static_cast<int>(end); ++v)
      for (int u = 0; u < across; ++u) {
        const float corner = corners(u, v);
        const bool even = corner == corners(u + 1, v) && corner == corners(u, v + 1) && corner == corners(u + 1, v + 1);
        for (int y = v * kBlock; y < std::min((v + 1) * kBlock, frame.height); ++y)
          for (int x = u * kBlock; x < std::min((u + 1) * kBlock, frame.width); ++x)
            lit(x, y) = even && !near(u, v) ? corner : sees_sun(x, y);
      }
  });
  return lit;
}

FirstSolids::FirstSolids(const WaterLevel& level, const Scene& scene, vec3 direction) : direction_(direction) {
  const FieldFrame& frame = level.frame();
  const float rise = direction[frame.up];
  if (!level.any() || !(std::abs(rise) > 1e-3f)) return;
  const vec2 slide = frame.across(direction) / rise;
  Rectangle all;
  std::vector<Rectangle> shadows;
  for (const PlacedSolid& placed : scene.solids()) {
    Rectangle shadow = rise < 0 ? meeting(world_bounds(placed), frame, level.mean(), slide, -kInfinity, level.mean())
                                : meeting(world_bounds(placed), frame, level.mean(), slide, level.mean(), kInfinity);
    shadow.low = glm::max(shadow.low, frame.low);
    shadow.high = glm::min(shadow.high, frame.high());
    if (!(shadow.low.x <= shadow.high.x && shadow.low.y <= shadow.high.y)) continue;
    shadows.push_back(shadow);
    all.low = glm::min(all.low, shadow.low);
    all.high = glm::max(all.high, shadow.high);
  }
  if (shadows.empty()) return;
  // As fine as the field, where that is not too many rays.
  const vec2 extent = all.high - all.low;
  step_ =
      std::max({std::min(frame.step.x, frame.step.y), std::sqrt(extent.x * extent.y / static_cast<float>(kMostRays)),
                std::max(extent.x, extent.y) / 4096.0f});
  low_ = all.low - 1.5f * step_;
  const vec2 count = glm::ceil((all.high - low_) / step_) + 2.0f;
  distance_ = Image<float>(static_cast<int>(count.x), static_cast<int>(count.y), kInfinity);
  parallel_for(static_cast<std::size_t>(distance_.height()), 4, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < distance_.width(); ++x) {
        const vec2 place = low_ + step_ * vec2{static_cast<float>(x), static_cast<float>(y)};
        const bool near = std::any_of(shadows.begin(), shadows.end(), [&](const Rectangle& shadow) {
          return place.x >= shadow.low.x - step_ && place.y >= shadow.low.y - step_ &&
                 place.x <= shadow.high.x + step_ && place.y <= shadow.high.y + step_;
        });
        if (near) distance_(x, y) = scene.distance({frame.world(place, level.mean()), direction});
      }
  });
}

float FirstSolids::passes(vec2 place, float length, vec3 normal) const {
  const vec2 at = (place - low_) / step_;
  if (!(at.x >= 0 && at.y >= 0 && at.x < static_cast<float>(distance_.width() - 1) &&
        at.y < static_cast<float>(distance_.height() - 1)))
    return 1;
  // The lit surface itself is farther off beside the point, the more the steeper it stands.
  const float cosine = std::max(-glm::dot(normal, direction_), 0.1f);
  const float bias = step_ * (0.5f + std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)) / cosine);
  const int i = static_cast<int>(at.x), j = static_cast<int>(at.y);
  const float s = at.x - static_cast<float>(i), t = at.y - static_cast<float>(j);
  const auto open = [&](int x, int y) { return length <= distance_(x, y) + bias ? 1.0f : 0.0f; };
  return (1.0f - t) * ((1.0f - s) * open(i, j) + s * open(i + 1, j)) +
         t * ((1.0f - s) * open(i, j + 1) + s * open(i + 1, j + 1));
}

}  // namespace meniscus
