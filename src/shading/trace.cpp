#include "shading/trace.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shading/refraction.h"
#include "shading/schlick.h"

namespace meniscus {
namespace {

using formulas::Interface;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Paths of less weight are not followed beyond their second interface.
constexpr float kLeastWeight = 0.03f;
/// An endless way through a channel that neither absorbs nor scatters shows what is behind.
constexpr float kEndless = 1e30f;
/// Spacings between the water and a solid behind it: less, and the water stands against it; more, and there is air.
constexpr float kTouching = 1.0f, kApart = 2.0f;
/// Water without particles has no spacing, but stands on floors and against walls exactly: what rounding makes of that,
/// of its longest side.
constexpr float kRounding = 1e-5f;

float longest_side(const Bounds& bounds) {
  const vec3 extent = bounds.extent();
  return std::max({extent.x, extent.y, extent.z});
}

float maximum(vec3 v) { return std::max(v.x, std::max(v.y, v.z)); }

/// A ray that begins at an interface.
struct Path {
  Ray ray;
  Beam beam;          ///< at the ray's origin
  vec3 weight{1.0f};  ///< of what it brings to the sample
  std::uint32_t sample = 0;
  int interfaces = 0;    ///< met so far
  float last_water = 0;  ///< m in water up to the last interface
  float roughness = 0;   ///< of the environment at its end
  std::uint8_t inside = 0;
};

class Tracer {
 public:
  Tracer(std::span<const Sample> samples, std::span<const Material> materials, const TraceInputs& inputs)
      : samples_(samples),
        materials_(materials),
        inputs_(inputs),
        scene_(*inputs.scene),
        spacing_(inputs.surface->spacing()),
        apart_(spacing_ > 0 ? spacing_ : kRounding * std::min(longest_side(inputs.surface->bounds()), 1e4f)),
        glass_(scene_.tank().style == TankStyle::glass),
        result_(samples.size(), vec3{0.0f}) {
    for (const Sample& sample : samples) light_.push_back(diffuse_light(scene_.environment(), sample.normal, 0.5f));
  }

  std::vector<vec3> run() {
    for (std::size_t i = 0; i < samples_.size(); ++i) start(static_cast<std::uint32_t>(i));
    while (!paths_.empty()) step();
    return std::move(result_);
  }

 private:
  /// The first interface is what the picture shows of the surface.
  void start(std::uint32_t i) {
    const Sample& sample = samples_[i];
    const Material& material = materials_[i];
    Path path;
    path.ray = sample.ray;
    path.beam = sample.beam;
    path.sample = i;
    path.inside = inputs_.eye_in_water;
    if (path.inside) {
      if (scene_.distance(sample.ray) <= sample.depth) {
        result_[i] = deep_radiance(sample.ray, sample.beam, scene_, material);
        return;
      }
    } else if (const Contact contact = contact_of(sample, scene_); contact.weight > 0) {
      const Refraction refraction = refraction_of(sample, material);
      const vec3 through = path.weight * contact.weight * (1.0f - refraction.reflectance);
      result_[i] += through * floor_radiance(sample, contact, scene_, material);
      cross(path, sample.depth, sample.normal, 1.0f - contact.weight);
      return;
    }
    cross(path, sample.depth, sample.normal, 1.0f);
  }

  /// One interface more for all paths.
  void step() {
    const std::size_t count = paths_.size();
    rays_.resize(count);
    limits_.resize(count);
    from_.assign(count, 0.0f);
    inside_.resize(count);
    found_.assign(count, Crossing{});
    for (std::size_t i = 0; i < count; ++i) {
      rays_[i] = paths_[i].ray;
      inside_[i] = paths_[i].inside;
      limits_[i] = scene_.distance(rays_[i]);
    }
    inputs_.surface->crossings(rays_, from_, limits_, inside_, found_);
    std::vector<Path> here;
    here.swap(paths_);
    for (std::size_t i = 0; i < count; ++i) go_on(here[i], limits_[i], found_[i]);
  }

  void go_on(Path& path, float to_solid, const Crossing& crossing) {
    if (!(crossing.distance < kInfinity)) return end(path, to_solid, to_solid);
    float distance = crossing.distance;
    vec3 normal = crossing.normal;
    // A wall that the ray just came through is not where it crosses next: pulled back onto it, a path would stay there.
    float flat_distance = distance;
    vec3 flat_normal = normal;
    flatten_at_walls(scene_.tank(), spacing_, path.ray, flat_distance, flat_normal);
    if (glm::dot(flat_normal, path.ray.direction) * (path.inside ? 1.0f : -1.0f) > 0) {
      distance = flat_distance;
      normal = flat_normal;
    }
    if (path.inside && apart_ > 0 && to_solid < kInfinity) {
      // Water that stands on a solid has no far side there.
      const float gap = (to_solid - distance) / apart_;
      const float touching = 1.0f - glm::smoothstep(kTouching, kApart, gap);
      if (touching >= 1.0f) return end(path, to_solid, to_solid);
      if (touching > 0.0f) {
        Path part = path;
        part.weight *= touching;
        end(part, to_solid, to_solid);
        path.weight *= 1.0f - touching;
      }
    }
    cross(path, distance, facing(path.inside ? -normal : normal, path.ray.direction), 1.0f);
  }

  /// What the path brings from a solid or from the environment.
  /// @param water  m in water on the way, if it is inside
  void end(const Path& path, float to_solid, float water) {
    vec3 seen = scene_.radiance(path.ray, path.beam, path.roughness);
    if (!(to_solid < kInfinity)) {
      const float half = 0.5f * path.beam.spread;
      seen += glare(scene_.environment(), path.ray.direction, half * half);
    }
    if (path.inside)
      seen = through_medium(seen, std::min(water, kEndless), materials_[path.sample], light_[path.sample]);
    else if (glass_) {
      const GlassPane pane = scene_.glass(path.ray, to_solid);
      seen = seen * pane.transmittance + pane.added;
    }
    result_[path.sample] += path.weight * seen;
  }

  /// Splits the path at an interface.
  /// @param normal   unit, against the ray
  /// @param through  part of the refracted light that goes on
  void cross(const Path& path, float distance, vec3 normal, float through) {
    const Sample& sample = samples_[path.sample];
    const Material& material = materials_[path.sample];
    const vec3 direction = path.ray.direction;
    Path next = path;
    next.ray.origin = path.ray.origin + distance * direction;
    next.beam.width += path.beam.spread * distance;
    next.interfaces = path.interfaces + 1;
    next.last_water = path.inside ? distance : 0.0f;
    if (path.inside) {
      const vec3 light = light_[path.sample];
      result_[path.sample] += path.weight * through_medium(vec3{0.0f}, distance, material, light);
      next.weight *= through_medium(vec3{1.0f}, distance, material, vec3{0.0f});
    }
    const float eta = path.inside ? 1.0f / material.ior : material.ior;
    const Interface interface = interface_of(-glm::dot(direction, normal), eta, sample.fresnel);
    const float reflectance = interface.cos_t > 0 ? std::min(1.0f, interface.reflectance * material.specular) : 1.0f;
    const float slopes = std::sqrt(sample.normal_variance);

    if (reflectance > 0) {
      Path mirrored = next;
      mirrored.weight *= reflectance;
      if (path.interfaces == 0 && !path.inside) {
        const Mirror mirror = mirror_of(sample, material);
        mirrored.ray = mirror.ray;
        mirrored.beam = mirror.beam;
        mirrored.roughness = mirror.roughness;
      } else {
        mirrored.ray.direction = glm::normalize(formulas::mirrored(direction, normal));
        mirrored.beam.spread += 2.0f * slopes;
      }
      queue(mirrored);
    }
    if (reflectance < 1.0f && through > 0) {
      Path refracted = next;
      refracted.weight *= (1.0f - reflectance) * through;
      refracted.inside = path.inside ? 0 : 1;
      refracted.ray.direction = formulas::refracted(direction, normal, eta, interface.cos_t);
      refracted.beam.spread += std::abs(1.0f - 1.0f / eta) * slopes;
      queue(refracted);
    }
  }

  /// Follows the path, or ends it where it is not worth it.
  void queue(const Path& path) {
    if (!(maximum(path.weight) > 0)) return;
    // How long its way in water is must be known of a path that has just come into it.
    const bool entered = path.inside && !(path.last_water > 0);
    const float least = path.interfaces == 1 ? 0.0f : entered ? 0.1f * kLeastWeight : kLeastWeight;
    if (path.interfaces < inputs_.bounces && maximum(path.weight) >= least) {
      paths_.push_back(path);
      return;
    }
    const float to_solid = scene_.distance(path.ray);
    float water = to_solid;
    if (path.inside && path.interfaces == 1 && !inputs_.eye_in_water)
      water = refraction_of(samples_[path.sample], materials_[path.sample]).water_path(samples_[path.sample], to_solid);
    else if (path.inside && !inputs_.eye_in_water)
      water = std::min(to_solid, path.last_water);  // as far as from the interface before
    end(path, to_solid, water);
  }

  std::span<const Sample> samples_;
  std::span<const Material> materials_;
  const TraceInputs& inputs_;
  const Scene& scene_;
  float spacing_;
  float apart_;  ///< m; what kTouching and kApart count
  bool glass_;
  std::vector<vec3> result_, light_;
  std::vector<Path> paths_;
  std::vector<Ray> rays_;
  std::vector<float> from_, limits_;
  std::vector<std::uint8_t> inside_;
  std::vector<Crossing> found_;
};

}  // namespace

std::vector<vec3> traced_radiance(std::span<const Sample> samples, std::span<const Material> materials,
                                  const TraceInputs& inputs) {
  return Tracer(samples, materials, inputs).run();
}

}  // namespace meniscus
