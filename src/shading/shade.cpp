#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "meniscus/shading.h"
#include "shading/normal_variance.h"
#include "shading/refraction.h"
#include "shading/shade_blocks.h"
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
    const ShadeInputs inputs{view_, points_, water_, scene_, material_, optics_, variance_, behind_, beam_};
    if (takes_blocks(inputs)) {
      parallel_for(picture_.size(), 4 * kGrain, [&](std::size_t begin, std::size_t end) {
        shade_pixels(inputs, begin, end, picture_.data());
        for (std::size_t i = begin; glass_ && i < end; ++i) behind_glass(i);
      });
      return std::move(picture_);
    }
    const bool traced = optics_.options.refraction == RefractionMethod::ray_traced;
    std::vector<std::uint32_t> order;
    if (traced && points_.empty()) order = by_tiles(view_.width, view_.height);
    parallel_for(picture_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      // Taken out: this thread may begin another piece while it waits within this one.
      thread_local Scratch memory;
      Scratch scratch = std::move(memory);
      scratch.pixels.clear();
      std::vector<std::size_t>& pixels = scratch.pixels;
      std::vector<Wet>& wet = scratch.wet;
      for (std::size_t k = begin; k < end; ++k) pixels.push_back(order.empty() ? k : order[k]);
      backgrounds(scratch);
      if (traced)
        trace(wet);
      else if (optics_.options.refraction == RefractionMethod::virtual_eye && material_.transparent)
        look(scratch);
      else
        for (const Wet& pixel : wet) mix_in(pixel, seen_of(pixel, material_of(pixel)));
      if (glass_)
        for (const std::size_t i : pixels) behind_glass(i);
      memory = std::move(scratch);
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

  /// What is held for a piece of the picture; kept by a thread for its next piece.
  struct Scratch {
    std::vector<std::size_t> pixels, dry;
    std::vector<Wet> wet;
    std::vector<Ray> rays, asked;
    std::vector<float> distances;
    std::vector<vec3> radiance;
    std::vector<Sample> samples;
    std::vector<Material> materials;
  };

  vec2 point_of(std::size_t i) const {
    if (!points_.empty()) return points_[i];
    const std::size_t width = static_cast<std::size_t>(view_.width);
    return {static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f};
  }

  /// Puts what is seen beside the water into the picture; those with water go to `wet`.
  void backgrounds(Scratch& scratch) {
    std::vector<Wet>& wet = scratch.wet;
    std::vector<Ray>& rays = scratch.rays;
    std::vector<std::size_t>& dry = scratch.dry;
    wet.clear();
    rays.clear();
    dry.clear();
    for (const std::size_t i : scratch.pixels) {
      Wet pixel;
      pixel.index = i;
      Sample& sample = pixel.sample;
      sample.ray = view_.ray(point_of(i));
      sample.depth = water_.depth[i];
      pixel.coverage = std::clamp(water_.coverage[i], 0.0f, 1.0f);
      if (pixel.coverage > 0 && sample.depth >= 0 && sample.depth < kInfinity) {
        sample.normal = water_.normal[i];
        flatten_at_walls(scene_.tank(), spacing_, sample.ray, sample.depth, sample.normal);
        wet.push_back(pixel);
      } else {
        rays.push_back(sample.ray);
        dry.push_back(i);
      }
    }

    // A solid before the water hides it; an eye in the water has its own order.
    std::vector<float>& distances = scratch.distances;
    if (!water_.eye_in_water && !behind_ && !wet.empty()) {
      std::vector<Ray>& asked = scratch.asked;
      asked.clear();
      for (const Wet& pixel : wet) asked.push_back(pixel.sample.ray);
      distances.resize(asked.size());
      scene_.distances(asked, distances);
    }
    std::size_t left = 0;
    for (std::size_t k = 0; k < wet.size(); ++k) {
      Wet& pixel = wet[k];
      const std::size_t i = pixel.index;
      Sample& sample = pixel.sample;
      if (!water_.eye_in_water) {
        if ((behind_ ? behind_->depth[i] : distances[k]) < sample.depth) pixel.coverage = 0;
      } else {
        // Water that ends just before a solid stands against it: there is no surface between them.
        const SolidHit solid = scene_.hit(sample.ray, beam_);
        const float gap = solid.distance - sample.depth;
        if (solid.found() && gap * -glm::dot(sample.ray.direction, solid.face_normal) < kAgainst * spacing_)
          pixel.coverage = 0;
      }
      if (pixel.coverage < 1.0f) {
        rays.push_back(sample.ray);
        dry.push_back(i);
      }
      if (!(pixel.coverage > 0)) continue;
      // From inside the surface looks away from the eye.
      sample.normal = facing(water_.eye_in_water ? -sample.normal : sample.normal, sample.ray.direction);
      const float thickness = water_.thickness[i];
      sample.thickness = thickness > 0 && thickness < kInfinity ? thickness : 0.0f;
      sample.beam = beam_;
      sample.normal_variance = variance_.at(i);
      sample.fresnel = optics_.options.fresnel;
      wet[left++] = pixel;
    }
    wet.resize(left);
    paint_dry(scratch);
  }

  void paint_dry(Scratch& scratch) {
    const std::vector<Ray>& rays = scratch.rays;
    const std::vector<std::size_t>& dry = scratch.dry;
    if (water_.eye_in_water) {
      for (std::size_t k = 0; k < dry.size(); ++k) picture_[dry[k]] = deep_radiance(rays[k], beam_, scene_, material_);
      return;
    }
    std::vector<vec3>& radiance = scratch.radiance;
    std::vector<float>& distances = scratch.distances;
    if (!behind_) {
      radiance.resize(rays.size());
      distances.resize(rays.size());
      scene_.radiance(rays, beam_, radiance, distances);
    }
    for (std::size_t k = 0; k < dry.size(); ++k) {
      const std::size_t i = dry[k];
      picture_[i] = behind_ ? behind_->radiance[i] : radiance[k];
      if (!((behind_ ? behind_->depth[i] : distances[k]) < kInfinity)) picture_[i] += sun_disc(rays[k], beam_, scene_);
    }
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
    if (water_.eye_in_water) return window_radiance(pixel.sample, scene_, material);
    if (optics_.options.refraction == RefractionMethod::image_space)
      return image_space_radiance(pixel.sample, point_of(pixel.index), {view_, &optics_.behind->depth},
                                  optics_.behind->radiance, optics_.options, scene_, material);
    return transparent_radiance(pixel.sample, scene_, material);
  }

  /// By virtual eyes.
  void look(Scratch& scratch) {
    const std::vector<Wet>& wet = scratch.wet;
    std::vector<Sample>& samples = scratch.samples;
    std::vector<Material>& materials = scratch.materials;
    std::vector<vec3>& seen = scratch.radiance;
    samples.clear();
    materials.clear();
    for (const Wet& pixel : wet) samples.push_back(pixel.sample);
    if (water_.colour.empty())
      materials.push_back(material_);
    else
      for (const Wet& pixel : wet) materials.push_back(material_of(pixel));
    seen.assign(wet.size(), vec3{0.0f});
    if (!dispersive_) virtual_eye_radiance(samples, materials, *optics_.eyes, scene_, water_.eye_in_water, seen);
    for (int channel = 0; dispersive_ && channel < 3; ++channel) {
      std::vector<Material> channels;
      for (const Material& material : materials) channels.push_back(of_channel(material, channel));
      std::vector<vec3> one(wet.size());
      virtual_eye_radiance(samples, channels, *optics_.eyes, scene_, water_.eye_in_water, one);
      for (std::size_t k = 0; k < wet.size(); ++k) seen[k][channel] = one[k][channel];
    }
    for (std::size_t k = 0; k < wet.size(); ++k) mix_in(wet[k], seen[k]);
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
