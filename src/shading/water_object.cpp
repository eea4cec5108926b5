// Objects in the water: planes that approximate the surface around them, outlines, main axes.  [Cords2008] 2.2, 2.3
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

#include "shading/virtual_eye.h"
#include "shading/water_object_shape.h"

namespace meniscus {
namespace {

/// A body whose outline covers more than this part of the water holds the water: it is no object in it.
constexpr float kBasin = 0.5f;
/// Objects share an eye when they are nearer than this part of the smaller one's width.
constexpr float kClose = 0.25f;
/// Width of the ring around an outline in which the water's height and normal are averaged, of the outline's size.
constexpr float kRing = 0.5f;
constexpr int kRingPoints = 16;
/// Extent of the plane and of the surface's way back to itself around objects looked up by direction, of their depth.
constexpr float kByDirectionPlane = 0.7f, kByDirectionWidth = 0.6f;

struct Mean {
  vec3 point{0.0f}, normal{0.0f};
  float low = std::numeric_limits<float>::infinity(), high = -low;
  int count = 0;
  void add(vec3 at, vec3 outwards, float height) {
    point += at;
    normal += outwards;
    low = std::min(low, height);
    high = std::max(high, height);
    ++count;
  }
};

Mean mean_of_all(const HeightField& field) {
  // A few thousand of the points are enough for a mean.
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(field.height.size()) / 4096)));
  Mean mean;
  for (int j = 0; j < field.height.height(); j += stride)
    for (int i = 0; i < field.height.width(); i += stride) {
      const float height = field.height(i, j);
      if (std::isfinite(height))
        mean.add(field.point(static_cast<float>(i), static_cast<float>(j), height), field.normal(i, j), height);
    }
  return mean;
}

float size_of(std::span<const vec2> outline) {
  vec2 low{std::numeric_limits<float>::infinity()}, high = -low;
  for (const vec2 p : outline) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return outline.empty() ? 0.0f : std::max(high.x - low.x, high.y - low.y);
}

float area_of(std::span<const vec2> outline) {
  float twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const vec2 a = outline[i], b = outline[(i + 1) % outline.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5f * std::abs(twice);
}

/// The water in a ring around an outline: along its sides, in three distances.
Mean mean_around(const HeightField& field, std::span<const vec2> outline) {
  const float least = 1.5f * std::max(field.step.x, field.step.y), ring = std::max(kRing * size_of(outline), least);
  Mean mean;
  for (int k = 0; k < 3; ++k) {
    const std::vector<vec2> around = grown_outline(outline, least + 0.5f * static_cast<float>(k) * ring);
    for (std::size_t i = 0; i < around.size(); ++i)
      for (int s = 0; s < kRingPoints; ++s) {
        const vec2 place = glm::mix(around[i], around[(i + 1) % around.size()], static_cast<float>(s) / kRingPoints);
        const vec2 at = field.grid_point(raised(place, 0, field.up));
        const HeightField::Sample sample = field.at(at.x, at.y);
        if (sample.water()) mean.add(raised(place, sample.height, field.up), sample.normal, sample.height);
      }
  }
  return mean;
}

/// Everything of one object but its solids.
WaterObject described(const HeightField& field, const Mean& all, std::span<const vec3> triangles) {
  const Axis up = field.up;
  const vec3 upwards = direction_of(up);
  WaterObject object;
  for (const vec3 p : triangles) object.bounds.add(p);
  const OrientedBox box = oriented_box(triangles, upwards);
  object.box_centre = box.centre;
  object.half_axes = box.half_axes;
  const float sign = glm::dot(box.half_axes[0], upwards) < 0 ? -1.0f : 1.0f;
  object.axis_top = box.centre + sign * box.half_axes[0];
  object.axis_end = box.centre - sign * box.half_axes[0];

  std::vector<vec2> places;
  for (const vec3 p : triangles) places.push_back(horizontal(p, up));
  object.outline = convex_hull(std::move(places));

  // The ring around the whole object tells the level, the outline at that level the ring that counts.
  const float count = static_cast<float>(all.count);
  object.plane_point = all.point / count;
  object.plane_normal = glm::normalize(all.normal);
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const vec3 p : triangles) {
    low = std::min(low, glm::dot(p, upwards));
    high = std::max(high, glm::dot(p, upwards));
  }
  for (int pass = 0; pass < 2; ++pass) {
    const Mean around = mean_around(field, object.outline);
    if (around.count > 0) {
      object.plane_point = around.point / static_cast<float>(around.count);
      object.plane_normal = glm::normalize(around.normal);
    }
    const float level = glm::dot(object.plane_point, upwards);
    object.under = low < level;
    object.pierces = low < level && high > level;
    if (!object.pierces || pass > 0) break;
    const float swing = around.count > 0 ? 0.5f * (around.high - around.low) : 0.0f;
    const float half = std::max(swing, 0.02f * (high - low));
    std::vector<vec2> at_level = convex_hull(slab_places(triangles, up, level - half, level + half));
    if (at_level.size() >= 3) object.outline = std::move(at_level);
  }
  // The plane's point under the outline's middle.
  vec2 middle{0.0f};
  for (const vec2 p : object.outline) middle += p / static_cast<float>(object.outline.size());
  const float along = glm::dot(object.plane_normal, upwards);
  const vec3 at = raised(middle, glm::dot(object.plane_point, upwards), up);
  if (along > 0.1f) object.plane_point = at + glm::dot(object.plane_point - at, object.plane_normal) / along * upwards;
  return object;
}

}  // namespace

std::vector<WaterObject> water_objects(const HeightField& field, const Scene& scene, const VirtualEyeOptions& options) {
  require_eyes(options);
  std::vector<WaterObject> objects;
  if (field.empty() || scene.solids().empty()) return objects;
  const Mean all = mean_of_all(field);
  if (all.count == 0) return objects;
  const float width = static_cast<float>(field.height.width() - 1) * field.step.x,
              depth = static_cast<float>(field.height.height() - 1) * field.step.y;

  // Whole outlines decide which are close.
  std::vector<std::vector<vec3>> triangles;
  std::vector<std::vector<vec2>> outlines;
  std::vector<std::size_t> solids;
  for (std::size_t i = 0; i < scene.solids().size(); ++i) {
    std::vector<vec3> corners = world_triangles(scene.solids()[i]);
    if (corners.empty()) continue;
    WaterObject object = described(field, all, corners);
    if (area_of(object.outline) > kBasin * width * depth) continue;
    solids.push_back(i);
    outlines.push_back(object.outline);
    triangles.push_back(std::move(corners));
    objects.push_back(std::move(object));
  }
  std::vector<std::size_t> group(solids.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t i = 0; i < solids.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const float close = options.combine_distance >= 0 ? options.combine_distance
                                                        : kClose * std::min(size_of(outlines[i]), size_of(outlines[j]));
      if (group[i] == group[j] || !(distance_between(outlines[i], outlines[j]) < close)) continue;
      const std::size_t from = std::max(group[i], group[j]), to = std::min(group[i], group[j]);
      std::replace(group.begin(), group.end(), from, to);
    }

  std::vector<WaterObject> combined;
  for (std::size_t g = 0; g < solids.size(); ++g) {
    std::vector<std::size_t> members;
    std::vector<vec3> corners;
    for (std::size_t i = 0; i < solids.size(); ++i)
      if (group[i] == g) {
        members.push_back(solids[i]);
        corners.insert(corners.end(), triangles[i].begin(), triangles[i].end());
      }
    if (members.empty()) continue;
    WaterObject object = members.size() == 1 ? std::move(objects[g]) : described(field, all, corners);
    object.solids = std::move(members);
    combined.push_back(std::move(object));
  }
  return combined;
}

std::vector<PlaneAdaptation> adaptations(std::span<const WaterObject> objects, const VirtualEyeOptions& options) {
  require_eyes(options);
  std::vector<PlaneAdaptation> planes;
  if (!options.adaptation) return planes;
  for (const WaterObject& object : objects) {
    if (!object.pierces || object.outline.size() < 3) continue;
    const float size = size_of(object.outline);
    if (!(size > 0)) continue;
    // A little of the plane itself all around, so that what is seen next to the object is seen through it. By direction
    // alone waves tear the object's picture, which reaches about as far as the object is deep.
    float margin = 0.15f * size, width = 0.75f * size;
    if (!options.object_position) {
      const vec3 deepest = object.axis_end - object.plane_point;
      const float depth = std::max(0.0f, -glm::dot(deepest, object.plane_normal));
      margin = std::max(margin, kByDirectionPlane * depth);
      width = std::max(width, kByDirectionWidth * depth);
    }
    planes.push_back({object.plane_point, object.plane_normal, grown_outline(object.outline, margin),
                      options.adaptation_width > 0 ? options.adaptation_width : width});
  }
  return planes;
}

}  // namespace meniscus
