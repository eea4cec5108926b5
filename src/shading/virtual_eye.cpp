#include "shading/virtual_eye.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr int kLeastSize = 16, kMostSize = 8192;
/// Faces are no larger than this unless it is asked for.
constexpr int kDefaultMostSize = 1536;
/// Pixels of the picture between points at which light on planes is held.
constexpr float kLightPixels = 3.0f;
/// And steps along the water at least.
constexpr float kLeastSteps = 192;

void require(bool holds, const char* name, double value, const char* range) {
  if (!holds)
    throw Error(
        ErrorCode::invalid_argument,
        {fmt::format("{} of the virtual eyes is out of range", name), range, fmt::format("{}", value), {}, {}, {}, {}});
}

/// Mean height and normal of all of the water, and how far the heights are from it at most.
ApproximatingPlane plane_of(const HeightField& field, float& slack) {
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(field.height.size()) / 16384)));
  double sum = 0;
  int count = 0;
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (int j = 0; j < field.height.height(); j += stride)
    for (int i = 0; i < field.height.width(); i += stride) {
      const float height = field.height(i, j);
      if (!std::isfinite(height)) continue;
      sum += static_cast<double>(height);
      low = std::min(low, height);
      high = std::max(high, height);
      ++count;
    }
  if (count == 0) throw Error(ErrorCode::invalid_argument, "there is no water to be seen by virtual eyes");
  const float mean = static_cast<float>(sum / count);
  slack = std::max(high - mean, mean - low);
  const vec3 up = direction_of(field.up), centre = field.bounds().centre();
  return {centre + (mean - glm::dot(centre, up)) * up, up};
}

}  // namespace

void require_eyes(const VirtualEyeOptions& options) {
  require(options.map_size == 0 || (options.map_size >= kLeastSize && options.map_size <= kMostSize), "the maps' size",
          options.map_size, "0 or 16 to 8192 px");
  const auto length = [](float value) { return value >= 0 && std::isfinite(value); };
  require(length(options.trapezium_a), "the trapezium's half width a", options.trapezium_a, "0 m or more");
  require(length(options.trapezium_b), "the trapezium's half width b", options.trapezium_b, "0 m or more");
  require(length(options.adaptation_width), "the width of the adaptation", options.adaptation_width, "0 m or more");
  require(std::isfinite(options.combine_distance), "the distance of objects that are combined",
          options.combine_distance, "a length; negative for the default");
}

std::shared_ptr<const VirtualEyes> make_virtual_eyes(const View& view, const HeightField& field, const Scene& scene,
                                                     std::span<const WaterObject> objects, const Material& material,
                                                     const VirtualEyeOptions& options, StageTimes* times) {
  const StageTimer timer(times, "eyes");
  require_eyes(options);
  if (view.projection != Projection::perspective)
    throw Error(ErrorCode::unsupported, {"virtual eyes need a view from one eye",
                                         "a perspective view",
                                         "another projection",
                                         {},
                                         {},
                                         {},
                                         "choose another way of refraction"});
  if (field.empty()) throw Error(ErrorCode::invalid_argument, "there is no water to be seen by virtual eyes");
  if (!(material.ior > 1.0f && material.ior < 100.0f))
    throw Error(ErrorCode::invalid_argument, fmt::format("an index of refraction of {} is not above 1", material.ior));
  for (const WaterObject& object : objects)
    for (const std::size_t solid : object.solids)
      if (solid >= scene.solids().size())
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("an object in the water is made of solid {} of {}", solid, scene.solids().size()));

  EyeSide::Inputs inputs{view, field, scene, objects, options, {}, 0, true, 1, 0};
  inputs.plane = plane_of(field, inputs.slack);
  // Over the field its own height under the eye decides on which side that is, elsewhere the mean height.
  const vec2 place = field.grid_point(view.eye);
  const HeightField::Sample below = field.at(place.x, place.y);
  const vec3 up = direction_of(field.up);
  const float eye_level = glm::dot(view.eye, up);
  inputs.eye_above = below.water() ? eye_level > below.height : inputs.plane.height(view.eye) > 0;
  if (!inputs.eye_above) inputs.plane.normal = -inputs.plane.normal;
  inputs.ratio = inputs.eye_above ? 1.0f / material.ior : material.ior;
  const float by_picture = std::ceil(static_cast<float>(view.height) / std::max(view.half_height, 1e-3f));
  inputs.size = options.map_size > 0 ? options.map_size
                                     : static_cast<int>(std::clamp(by_picture, static_cast<float>(kLeastSize),
                                                                   static_cast<float>(kDefaultMostSize)));
  // Light on the ground under and around the water, as finely as the picture can show it.
  Bounds region = field.bounds();
  const vec3 extent = region.extent();
  for (int k = 0; k < 3; ++k) {
    const float margin = 0.1f * std::max({extent.x, extent.y, extent.z}) + 1.2f * std::abs(glm::dot(extent, up));
    if (up[k] == 0) {
      region.low[k] -= margin;
      region.high[k] += margin;
    }
  }
  const float away = glm::length(view.eye - field.bounds().centre());
  const float longest = std::max({extent.x, extent.y, extent.z});
  const float step = std::clamp(kLightPixels * view.pixel_size(away), 1e-6f, std::max(longest / kLeastSteps, 1e-6f));
  return std::make_shared<const VirtualEyes>(inputs, region, step);
}

}  // namespace meniscus
