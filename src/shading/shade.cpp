#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "meniscus/shading.h"
#include "shading/normal_variance.h"
#include "shading/refraction.h"
#include "shading/trace.h"
#include "shading/virtual_eye.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Spacings between water and a solid that it stands against.
constexpr float kAgainst = 1.5f;
constexpr std::size_t kGrain = 1024;
constexpr int kTile = 32, kBlock = 4;  ///< px; kTile^2 = kGrain

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
  for (int k = 0; k < 3; ++k)
    if (!(material.ior + material.dispersion[k] > 1.0f && material.ior + material.dispersion[k] < 100.0f))
      throw Error(ErrorCode::invalid_argument, fmt::format("an index of refraction of {} by dispersion is not above 1",
                                                           material.ior + material.dispersion[k]));
  if (!valid(material.extinction) || !valid(material.scattering) || !valid(material.body) ||
      !(material.roughness >= 0 && material.roughness <= 1) ||
      !(material.specular >= 0 && material.specular < kInfinity))
    throw Error(ErrorCode::invalid_argument,
                "a material's extinction, scattering, body or specular factor is negative or not finite, or its "
                "roughness not in [0, 1]");
}

/// The sun's disc, at least a pixel wide.
vec3 sun_disc(const Ray& ray, Beam beam, const Scene& scene) {
  const Environment& environment = scene.environment();
  if (!environment.sun_visible()) return vec3{0.0f};
  return glm::min(environment.sun_glare(ray.direction, beam.spread * beam.spread), vec3{200.0f});
}

/// What is seen beside the water.
vec3 background(const Ray& ray, Beam beam, const Scene& scene) {
  vec3 radiance = scene.radiance(ray, beam);
  const vec3 disc = sun_disc(ray, beam, scene);
  if (disc != vec3{0.0f} && !(scene.distance(ray) < kInfinity)) radiance += disc;
  return radiance;
}

/// Indices of the pixels by tiles, and within them by blocks: what comes one after another lies close together.
std::vector<std::uint32_t> by_tiles(int width, int height) {
  std::vector<std::uint32_t> order;
  order.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int ty = 0; ty < height; ty += kTile)
    for (int tx = 0; tx < width; tx += kTile)
      for (int block = 0; block < (kTile / kBlock) * (kTile / kBlock); ++block)
        for (int pixel = 0; pixel < kBlock * kBlock; ++pixel) {
          const int x = tx + block % (kTile / kBlock) * kBlock + pixel % kBlock;
          const int y = ty + block / (kTile / kBlock) * kBlock + pixel / kBlock;
          if (x < width && y < height)
            order.push_back(static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width) +
                            static_cast<std::uint32_t>(x));
        }
  return order;
}

/// One picture being shaded.
class Shading {
 public:
  Shading(const View& view, std::span<const vec2> points, const SurfaceBuffers& water, const Scene& scene,
          const Material& material, const OpticsInputs& optics)
      : view_(view),
        points_(points),
        water_(water),
        scene_(scene),
        material_(material),
        optics_(optics),
        variance_(view, points, water.normal),
        picture_(points.empty() ? view.width : static_cast<int>(points.size()), points.empty() ? view.height : 1) {
    beam_ = view.projection == Projection::perspective ? Beam{0.0f, view.pixel_size(1.0f)}
                                                       : Beam{view.pixel_size(1.0f), 0.0f};
    spacing_ = optics.surface ? optics.surface->spacing() : 0.0f;
    glass_ = scene.tank().style == TankStyle::glass;
    if (optics.behind && points.empty() && optics.behind->depth.width() == view.width &&
        optics.behind->depth.height() == view.height && optics.behind->radiance.width() == view.width &&
        optics.behind->radiance.height() == view.height)
      behind_ = optics.behind;
    dispersive_ = optics.options.dispersion && material.dispersion != vec3{0.0f};
  }

  Image<vec3> run() {
    const bool traced = optics_.options.refraction == RefractionMethod::ray_traced;
    std::vector<std::uint32_t> order;
    if (traced && points_.empty()) order = by_tiles(view_.width, view_.height);
    parallel_for(picture_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<Wet> wet;
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t i = order.empty() ? k : order[k];
        if (const Wet pixel = background_of(i); pixel.coverage > 0) wet.push_back(pixel);
      }
      if (traced)
        trace(wet);
      else
        for (const Wet& pixel : wet) mix_in(pixel, seen_of(pixel, material_of(pixel)));
      if (glass_)
        for (std::size_t k = begin; k < end; ++k) behind_glass(order.empty() ? k : order[k]);
    });
    return std::move(picture_);
  }

 private:
  /// A pixel with water.
  struct Wet {
    std::size_t index = 0;
    float coverage = 0;
    Sample sample;
  };

  vec2 point_of(std::size_t i) const {
    if (!points_.empty()) return points_[i];
    const std::size_t width = static_cast<std::size_t>(view_.width);
    return {static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f};
  }

  /// Puts what is seen beside the water into the picture.
  Wet background_of(std::size_t i) {
    Wet pixel;
    pixel.index = i;
    const Ray ray = view_.ray(point_of(i));
    float depth = water_.depth[i];
    float coverage = std::clamp(water_.coverage[i], 0.0f, 1.0f);
    if (!(coverage > 0) || !(depth >= 0 && depth < kInfinity)) coverage = 0;
    vec3 normal = water_.normal[i];
    if (coverage > 0) flatten_at_walls(scene_.tank(), spacing_, ray, depth, normal);

    // A solid before the water hides it; an eye in the water has its own order.
    if (!water_.eye_in_water && coverage > 0 && solid_distance(i, ray) < depth) coverage = 0;
    if (water_.eye_in_water && coverage > 0) {
      // Water that ends just before a solid stands against it: there is no surface between them.
      const SolidHit solid = scene_.hit(ray, beam_);
      const float gap = solid.distance - depth;
      if (solid.found() && gap * -glm::dot(ray.direction, solid.face_normal) < kAgainst * spacing_) coverage = 0;
    }
    if (coverage < 1.0f)
      picture_[i] = water_.eye_in_water ? deep_radiance(ray, beam_, scene_, material_) : background_at(i, ray);
    pixel.coverage = coverage;
    if (!(coverage > 0)) return pixel;
    Sample& sample = pixel.sample;
    sample.ray = ray;
    sample.depth = depth;
    // From inside the surface looks away from the eye.
    sample.normal = facing(water_.eye_in_water ? -normal : normal, ray.direction);
    const float thickness = water_.thickness[i];
    sample.thickness = thickness > 0 && thickness < kInfinity ? thickness : 0.0f;
    sample.beam = beam_;
    sample.normal_variance = variance_.at(i);
    sample.fresnel = optics_.options.fresnel;
    return pixel;
  }

  /// Distance to the first solid, from the picture of the scene where that was handed over.
  float solid_distance(std::size_t i, const Ray& ray) const {
    return behind_ ? behind_->depth[i] : scene_.distance(ray);
  }

  vec3 background_at(std::size_t i, const Ray& ray) const {
    if (!behind_) return background(ray, beam_, scene_);
    vec3 radiance = behind_->radiance[i];
    if (!(behind_->depth[i] < kInfinity)) radiance += sun_disc(ray, beam_, scene_);
    return radiance;
  }

  Material material_of(const Wet& pixel) const {
    return water_.colour.empty() ? material_ : tinted(material_, water_.colour[pixel.index]);
  }

  /// Each channel by its own index of refraction, where that is wanted.
  vec3 seen_of(const Wet& pixel, const Material& material) const {
    if (!dispersive_ || !material.transparent) return seen_at_once(pixel, material);
    vec3 seen;
    for (int channel = 0; channel < 3; ++channel)
      seen[channel] = seen_at_once(pixel, of_channel(material, channel))[channel];
    return seen;
  }

  static Material of_channel(Material material, int channel) {
    material.ior += material.dispersion[channel];
    return material;
  }

  vec3 seen_at_once(const Wet& pixel, const Material& material) const {
    if (!material.transparent) return opaque_radiance(pixel.sample, scene_, material);
    if (optics_.options.refraction == RefractionMethod::virtual_eye)
      return virtual_eye_radiance(pixel.sample, *optics_.eyes, scene_, material, water_.eye_in_water);
    if (water_.eye_in_water) return window_radiance(pixel.sample, scene_, material);
    if (optics_.options.refraction == RefractionMethod::image_space)
      return image_space_radiance(pixel.sample, point_of(pixel.index), {view_, &optics_.behind->depth},
                                  optics_.behind->radiance, optics_.options, scene_, material);
    return transparent_radiance(pixel.sample, scene_, material);
  }

  void trace(std::span<const Wet> wet) {
    if (!material_.transparent) {
      for (const Wet& pixel : wet) mix_in(pixel, seen_of(pixel, material_of(pixel)));
      return;
    }
    std::vector<Sample> samples;
    std::vector<Material> materials;
    for (const Wet& pixel : wet) {
      samples.push_back(pixel.sample);
      materials.push_back(material_of(pixel));
    }
    const TraceInputs inputs{optics_.surface, &scene_, optics_.options.bounces, water_.eye_in_water};
    std::vector<vec3> seen;
    if (!dispersive_) seen = traced_radiance(samples, materials, inputs);
    for (int channel = 0; dispersive_ && channel < 3; ++channel) {
      std::vector<Material> channels;
      for (const Material& material : materials) channels.push_back(of_channel(material, channel));
      const std::vector<vec3> one = traced_radiance(samples, channels, inputs);
      seen.resize(one.size());
      for (std::size_t k = 0; k < one.size(); ++k) seen[k][channel] = one[k][channel];
    }
    for (std::size_t k = 0; k < wet.size(); ++k) mix_in(wet[k], seen[k]);
  }

  void mix_in(const Wet& pixel, vec3 seen) {
    picture_[pixel.index] = glm::mix(picture_[pixel.index], seen, pixel.coverage);
  }

  /// The panes of a glass tank before what is seen.
  void behind_glass(std::size_t i) {
    const Ray ray = view_.ray(point_of(i));
    float distance = scene_.distance(ray);
    if (water_.coverage[i] > 0.5f && water_.depth[i] >= 0) distance = std::min(distance, water_.depth[i]);
    const GlassPane pane = scene_.glass(ray, distance);
    picture_[i] = picture_[i] * pane.transmittance + pane.added;
  }

  const View& view_;
  std::span<const vec2> points_;
  const SurfaceBuffers& water_;
  const Scene& scene_;
  const Material& material_;
  const OpticsInputs& optics_;
  NormalVariance variance_;
  Image<vec3> picture_;
  Beam beam_;
  float spacing_ = 0;
  const SceneBuffers* behind_ = nullptr;  ///< of the same pixels; null: rays
  bool glass_ = false, dispersive_ = false;
};

}  // namespace

Image<vec3> shade(const View& view, std::span<const vec2> points, const SurfaceBuffers& water, const Scene& scene,
                  const Material& material, const OpticsInputs& optics, StageTimes* times) {
  const StageTimer timer(times, "shade");
  require_material(material);
  require_optics(view, optics);
  const int width = points.empty() ? view.width : static_cast<int>(points.size());
  const int height = points.empty() ? view.height : 1;
  require_size("depths", water.depth.width(), water.depth.height(), width, height);
  require_size("normals", water.normal.width(), water.normal.height(), width, height);
  require_size("thicknesses", water.thickness.width(), water.thickness.height(), width, height);
  require_size("coverages", water.coverage.width(), water.coverage.height(), width, height);
  const bool coloured = !water.colour.empty();
  if (coloured) require_size("colours", water.colour.width(), water.colour.height(), width, height);

  return Shading(view, points, water, scene, material, optics).run();
}

}  // namespace meniscus
