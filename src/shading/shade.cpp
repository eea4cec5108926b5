#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "meniscus/shading.h"
#include "shading/normal_variance.h"
#include "shading/sample.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kGrain = 2048;

void require_size(const char* name, int width, int height, int expected_width, int expected_height) {
  if (width == expected_width && height == expected_height) return;
  throw Error(ErrorCode::invalid_argument, {fmt::format("the image of {} does not have the size of the picture", name),
                                            fmt::format("{} x {}", expected_width, expected_height),
                                            fmt::format("{} x {}", width, height),
                                            {},
                                            {},
                                            {},
                                            {}});
}

void require_material(const Material& material) {
  const auto valid = [](vec3 v) { return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x + v.y + v.z < kInfinity; };
  if (!(material.ior > 1.0f && material.ior < 100.0f))
    throw Error(ErrorCode::invalid_argument, fmt::format("an index of refraction of {} is not above 1", material.ior));
  if (!valid(material.extinction) || !valid(material.scattering) || !valid(material.body) ||
      !(material.roughness >= 0 && material.roughness <= 1) ||
      !(material.specular >= 0 && material.specular < kInfinity))
    throw Error(ErrorCode::invalid_argument,
                "a material's extinction, scattering, body or specular factor is negative or not finite, or its "
                "roughness not in [0, 1]");
}

/// What is seen beside the water; the sun's disc is at least a pixel wide.
vec3 background(const Ray& ray, Beam beam, const Scene& scene) {
  vec3 radiance = scene.radiance(ray, beam);
  const Environment& environment = scene.environment();
  if (!environment.sun_visible()) return radiance;
  const vec3 disc = environment.sun_glare(ray.direction, beam.spread * beam.spread);
  if (disc != vec3{0.0f} && !(scene.ground_distance(ray) < kInfinity)) radiance += glm::min(disc, vec3{200.0f});
  return radiance;
}

}  // namespace

Image<vec3> shade(const View& view, std::span<const vec2> points, const SurfaceBuffers& water, const Scene& scene,
                  const Material& material, const OpticsInputs& optics, StageTimes* times) {
  static_cast<void>(optics);
  const StageTimer timer(times, "shade");
  require_material(material);
  const int width = points.empty() ? view.width : static_cast<int>(points.size());
  const int height = points.empty() ? view.height : 1;
  require_size("depths", water.depth.width(), water.depth.height(), width, height);
  require_size("normals", water.normal.width(), water.normal.height(), width, height);
  require_size("thicknesses", water.thickness.width(), water.thickness.height(), width, height);
  require_size("coverages", water.coverage.width(), water.coverage.height(), width, height);
  const bool coloured = !water.colour.empty();
  if (coloured) require_size("colours", water.colour.width(), water.colour.height(), width, height);

  const bool perspective = view.projection == Projection::perspective;
  const Beam beam = perspective ? Beam{0.0f, view.pixel_size(1.0f)} : Beam{view.pixel_size(1.0f), 0.0f};
  const NormalVariance variance(view, points, water.normal);
  Image<vec3> picture(width, height);
  parallel_for(picture.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t row_length = static_cast<std::size_t>(width);
      const Ray ray = view.ray(
          points.empty() ? vec2{static_cast<float>(i % row_length) + 0.5f, static_cast<float>(i / row_length) + 0.5f}
                         : points[i]);
      const float depth = water.depth[i];
      float coverage = std::clamp(water.coverage[i], 0.0f, 1.0f);
      if (!(coverage > 0) || !(depth >= 0 && depth < kInfinity)) coverage = 0;

      // Ground before the water hides it; an eye in the water has its own order.
      if (!water.eye_in_water && coverage > 0 && scene.ground_distance(ray) < depth) coverage = 0;
      vec3 radiance{0.0f};
      if (coverage < 1.0f)
        radiance = water.eye_in_water ? deep_radiance(ray, beam, scene, material) : background(ray, beam, scene);
      if (coverage > 0) {
        Sample sample;
        sample.ray = ray;
        sample.depth = depth;
        // From inside the surface looks away from the eye.
        sample.normal = facing(water.eye_in_water ? -water.normal[i] : water.normal[i], ray.direction);
        const float thickness = water.thickness[i];
        sample.thickness = thickness > 0 && thickness < kInfinity ? thickness : 0.0f;
        sample.beam = beam;
        sample.normal_variance = variance.at(i);
        std::optional<Material> own;
        if (coloured) own = tinted(material, water.colour[i]);
        const Material& here = own ? *own : material;
        const vec3 seen = !here.transparent    ? opaque_radiance(sample, scene, here)
                          : water.eye_in_water ? window_radiance(sample, scene, here)
                                               : transparent_radiance(sample, scene, here);
        radiance = glm::mix(radiance, seen, coverage);
      }
      picture[i] = radiance;
    }
  });
  return picture;
}

}  // namespace meniscus
