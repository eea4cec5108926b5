#include "shading/refraction.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "shading/virtual_eye.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Pixels of the picture show the same thing as a point up to this difference in depth, in pixel sizes.
constexpr float kSameDepth = 8.0f;
/// The mean over a beam takes this many samples along each axis at most, and is this many pixels wide at most.
constexpr int kMostTaps = 4;
constexpr float kWidestMean = 12.0f;

void require_option(bool holds, const char* name, double value, const char* range) {
  if (!holds)
    throw Error(ErrorCode::invalid_argument,
                {fmt::format("{} is out of range", name), range, fmt::format("{}", value), {}, {}, {}, {}});
}

}  // namespace

RefractionMethod refraction_method_of(std::string_view name) {
  if (name == "thickness") return RefractionMethod::thickness;
  if (name == "image_space") return RefractionMethod::image_space;
  if (name == "ray_traced") return RefractionMethod::ray_traced;
  if (name == "virtual_eye") return RefractionMethod::virtual_eye;
  throw Error(ErrorCode::invalid_argument, {"there is no such way of refraction",
                                            "thickness, image_space, ray_traced or virtual_eye",
                                            std::string(name),
                                            {},
                                            {},
                                            {},
                                            {}});
}

FresnelFormula fresnel_formula_of(std::string_view name) {
  if (name == "exact") return FresnelFormula::exact;
  if (name == "schlick") return FresnelFormula::schlick;
  throw Error(ErrorCode::invalid_argument,
              {"there is no such formula of reflection", "exact or schlick", std::string(name), {}, {}, {}, {}});
}

void require_optics(const View& view, const OpticsInputs& optics) {
  const OpticsOptions& options = optics.options;
  require_option(options.iterations >= 1 && options.iterations <= 256, "number of iterations", options.iterations,
                 "1 to 256");
  require_option(options.threshold >= 0 && options.threshold < kInfinity, "threshold", options.threshold,
                 "0 m or more");
  require_option(options.bounces >= 1 && options.bounces <= 64, "number of bounces", options.bounces, "1 to 64");
  if (options.refraction == RefractionMethod::image_space) {
    if (!optics.behind)
      throw Error(ErrorCode::invalid_argument,
                  "refraction in image space needs the picture of the scene without water");
    const SceneBuffers& behind = *optics.behind;
    if (behind.depth.width() != view.width || behind.depth.height() != view.height ||
        behind.radiance.width() != view.width || behind.radiance.height() != view.height)
      throw Error(ErrorCode::invalid_argument,
                  {"the picture of the scene without water does not have the size of the view",
                   fmt::format("{} x {}", view.width, view.height),
                   fmt::format("{} x {}", behind.depth.width(), behind.depth.height()),
                   {},
                   {},
                   {},
                   {}});
  }
  require_eyes(options.eyes);
  if (options.refraction == RefractionMethod::virtual_eye && !optics.eyes)
    throw Error(ErrorCode::invalid_argument, "refraction by virtual eyes needs the maps of make_virtual_eyes()");
  if (options.refraction == RefractionMethod::ray_traced && (!optics.surface || !optics.surface->can_march()))
    throw Error(ErrorCode::invalid_argument, {"this surface cannot be followed by rays",
                                              {},
                                              {},
                                              {},
                                              {},
                                              {},
                                              "choose refraction by thickness or in image space"});
}

vec3 radiance_at(const GeometryMap& map, const Image<vec3>& radiance, const ImageSpaceHit& hit) {
  const int width = radiance.width(), height = radiance.height();
  const float x = std::clamp(hit.picture.x, 0.0f, static_cast<float>(width)),
              y = std::clamp(hit.picture.y, 0.0f, static_cast<float>(height));
  const vec3 nearest = radiance(std::min(static_cast<int>(x), width - 1), std::min(static_cast<int>(y), height - 1));
  if (map.view.projection == Projection::cube) return nearest;
  const vec3 offset = hit.point - map.view.eye;
  const float away =
      map.view.projection == Projection::orthographic ? glm::dot(offset, map.view.forward) : glm::length(offset);
  const float tolerance = kSameDepth * map.view.pixel_size(away);
  const int x0 = static_cast<int>(std::floor(x - 0.5f)), y0 = static_cast<int>(std::floor(y - 0.5f));
  const float fu = x - 0.5f - static_cast<float>(x0), fv = y - 0.5f - static_cast<float>(y0);
  vec3 sum{0.0f};
  float weights = 0;
  for (int k = 0; k < 4; ++k) {
    const int px = std::clamp(x0 + (k & 1), 0, width - 1), py = std::clamp(y0 + (k >> 1), 0, height - 1);
    if (!(std::abs((*map.depth)(px, py) - away) <= tolerance)) continue;
    const float weight = (k & 1 ? fu : 1 - fu) * (k >> 1 ? fv : 1 - fv);
    sum += weight * radiance(px, py);
    weights += weight;
  }
  return weights > 1e-3f ? sum / weights : nearest;
}

vec3 mean_radiance(const GeometryMap& map, const Image<vec3>& radiance, const ImageSpaceHit& hit, float width) {
  const float pixels = width / map.view.pixel_size(glm::length(hit.point - map.view.eye));
  const int taps = std::clamp(static_cast<int>(std::ceil(pixels - 0.5f)), 1, kMostTaps);
  if (taps == 1) return radiance_at(map, radiance, hit);
  const float step = std::min(pixels, kWidestMean) / static_cast<float>(taps);
  vec3 sum{0.0f};
  for (int k = 0; k < taps * taps; ++k) {
    ImageSpaceHit tap = hit;
    tap.picture += step * (vec2{k % taps, k / taps} - 0.5f * static_cast<float>(taps - 1));
    sum += radiance_at(map, radiance, tap);
  }
  return sum / static_cast<float>(taps * taps);
}

vec3 image_space_radiance(const Sample& sample, vec2 picture_point, const GeometryMap& map, const Image<vec3>& picture,
                          const OpticsOptions& options, const Scene& scene, const Material& material) {
  const Refraction refraction = refraction_of(sample, material);
  const auto look = [&](const Ray& ray, Beam beam, float& distance, vec3& seen) {
    const ImageSpaceHit hit = image_space_hit(map, ray, picture_point, options.threshold, options.iterations);
    if (!hit.met || !hit.in_picture) return false;
    distance = hit.distance;
    seen = mean_radiance(map, picture, hit, beam.width + beam.spread * hit.distance);
    return true;
  };

  vec3 transmitted{0.0f};
  const Contact contact = contact_of(sample, scene);
  if (contact.weight < 1.0f) {
    const Ray ray{refraction.point, refraction.direction};
    float to_solid = 0;
    if (!look(ray, refraction.beam(sample, 0.0f), to_solid, transmitted)) {
      to_solid = scene.distance(ray);
      transmitted = scene.radiance(ray, refraction.beam(sample, 0.0f));
    }
    const float path = refraction.water_path(sample, std::min(to_solid, 1e30f));
    transmitted = through_medium(transmitted, path, material, diffuse_light(scene.environment(), sample.normal, 0.5f));
  }
  if (contact.weight > 0.0f)
    transmitted = glm::mix(transmitted, floor_radiance(sample, contact, scene, material), contact.weight);
  if (refraction.reflectance <= 0) return transmitted;

  // A rough mirror shows more than a point of the picture.
  const Mirror mirror = mirror_of(sample, material);
  vec3 image;
  float distance = 0;
  if (material.roughness > 0 || !look(mirror.ray, mirror.beam, distance, image))
    image = scene.radiance(mirror.ray, mirror.beam, mirror.roughness);
  image += mirrored_sun(sample, mirror, scene);
  return glm::mix(transmitted, image, refraction.reflectance);
}

void flatten_at_walls(const Tank& tank, float spacing, const Ray& ray, float& distance, vec3& outwards) {
  if (tank.style == TankStyle::none || !(spacing > 0) || tank.inside.empty()) return;
  const vec3 point = ray.origin + distance * ray.direction;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(tank.up[k]) > 0.5f) continue;
    const float side = outwards[k] > 0 ? 1.0f : -1.0f;
    const float wall = side > 0 ? tank.inside.high[k] : tank.inside.low[k];
    const float gap = std::abs(point[k] - wall) / spacing;
    const float weight = (1.0f - glm::smoothstep(0.8f, 1.6f, gap)) * glm::smoothstep(0.5f, 0.85f, side * outwards[k]);
    if (!(weight > 0)) continue;
    // From within the tank only a face along the wall is drawn onto it: from the rounded edge of the water's level the
    // way to the wall leads through the air.
    const bool within = side * (wall - point[k]) > 0;
    const float pull = within ? weight * glm::smoothstep(0.78f, 0.93f, side * outwards[k]) : weight;
    vec3 normal{0.0f};
    normal[k] = side;
    outwards = glm::normalize(glm::mix(outwards, normal, weight));
    const float along = ray.direction[k];
    if (!(std::abs(along) > 0.05f)) continue;
    const float at_wall = (wall - ray.origin[k]) / along;
    if (at_wall >= 0 && std::abs(at_wall - distance) < 4.0f * spacing) distance = glm::mix(distance, at_wall, pull);
  }
}

}  // namespace meniscus
