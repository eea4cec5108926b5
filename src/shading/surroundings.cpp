// The light around a place, as maps of direction.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "shading/surroundings_parts.h"

namespace meniscus {
namespace {

/// Nothing in a picture needs to be brighter; it keeps a lamp's image in a drop from deciding a whole neighbourhood.
constexpr float kBrightestGlare = 60.0f;

bool finite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// The six pictures of a cube view, interpolated between pixel centres, held half a pixel from a face's edges.
vec3 on_cube(const View& view, const Image<vec3>& faces, vec3 direction) {
  const vec3 p = view.project(view.eye + direction);
  const int size = view.height;
  const int face = std::clamp(static_cast<int>(p.x) / size, 0, 5);
  const float last = static_cast<float>(size - 1);
  const float x = std::clamp(p.x - static_cast<float>(face * size) - 0.5f, 0.0f, last);
  const float y = std::clamp(p.y - 0.5f, 0.0f, last);
  const int i = std::min(static_cast<int>(x), std::max(size - 2, 0)),
            j = std::min(static_cast<int>(y), std::max(size - 2, 0));
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  const int right = std::min(i + 1, size - 1) + face * size, low = std::min(j + 1, size - 1);
  const int left = i + face * size;
  return (1.0f - t) * ((1.0f - s) * faces(left, j) + s * faces(right, j)) +
         t * ((1.0f - s) * faces(left, low) + s * faces(right, low));
}

/// Mean over the sphere.
vec3 mean_of(const DirectionMap& map) {
  constexpr int kEdge = 48;
  vec3 sum{0.0f};
  float weights = 0;
  for (int j = 0; j < kEdge; ++j)
    for (int i = 0; i < kEdge; ++i) {
      const vec3 p = on_octahedron((static_cast<float>(i) + 0.5f) * (2.0f / kEdge) - 1.0f,
                                   (static_cast<float>(j) + 0.5f) * (2.0f / kEdge) - 1.0f);
      const float r = glm::length(p), weight = 1.0f / (r * r * r);
      sum += weight * map.at(p);
      weights += weight;
    }
  return sum / weights;
}

/// A light of irradiance one as a Gaussian over the sphere, as Environment::sun_glare.
float spread(vec3 direction, vec3 towards, float variance) {
  const vec3 chord = direction - towards;
  const float above = 0.5f * glm::dot(chord, chord);
  if (!(above < 30.0f * variance)) return 0;
  const float backwards = variance > 0.05f ? std::exp(-2.0f / variance) : 0.0f;
  return std::exp(-above / variance) / (2.0f * std::numbers::pi_v<float> * variance * (1.0f - backwards));
}

}  // namespace

Surroundings::Surroundings(const Scene& scene, vec3 centre, int size, StageTimes* times) {
  if (!finite(centre)) throw Error(ErrorCode::invalid_argument, "the surroundings' centre is not a finite place");
  if (size < 2 || size > 1024)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("surroundings of {} pixels a face are not from 2 to 1024", size));
  const StageTimer timer(times, "surroundings");
  const auto parts = std::make_shared<Parts>();
  const View view = cube_view(centre, size);
  Image<vec3> faces = scene.see(view).radiance;
  for (vec3& radiance : faces)
    if (!finite(radiance)) radiance = vec3{0.0f};
  parts->levels[0] = DirectionMap(2 * size, [&](vec3 direction) { return on_cube(view, faces, direction); });
  // Each blur starts from the one before: variances add up.
  for (std::size_t k = 1; k < Parts::kLevels; ++k) {
    const float before = Parts::kBlurs[k - 1], sigma = std::sqrt(Parts::kBlurs[k] * Parts::kBlurs[k] - before * before);
    parts->levels[k] = blurred(parts->levels[k - 1], sigma, k == 1 ? 48 : k == 2 ? 24 : 12);
  }
  parts->mean = mean_of(parts->levels[1]);
  parts->sun_direction = scene.environment().sun_direction();
  if (!scene.shadowed(centre, parts->sun_direction)) parts->sun_irradiance = scene.environment().sun_irradiance();
  parts->lamps = scene.lamps();
  parts_ = parts;
}

vec3 Surroundings::radiance(vec3 direction, float cone) const { return parts_->radiance(direction, cone); }
vec3 Surroundings::mean() const { return parts_->mean; }

vec3 Surroundings::glare(vec3 point, vec3 direction, float variance) const {
  constexpr float kDisc = 5e-6f;  // rad^2, of the sun's own disc
  const float s = std::max(variance, 0.0f) + kDisc;
  vec3 sum = parts_->sun_irradiance * spread(direction, parts_->sun_direction, s);
  for (const PointLight& lamp : parts_->lamps) {
    const vec3 way = lamp.position - point;
    const float squared = std::max(glm::dot(way, way), 1e-4f);
    sum += lamp.intensity * (spread(direction, way / std::sqrt(squared), s) / squared);
  }
  const float peak = std::max(sum.x, std::max(sum.y, sum.z));
  return peak > 0 ? sum * (kBrightestGlare / (kBrightestGlare + peak)) : vec3{0.0f};
}

}  // namespace meniscus
