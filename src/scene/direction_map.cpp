#include "scene/direction_map.h"

#include <array>
#include <glm/geometric.hpp>
#include <numbers>

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

vec3 UpFrame::local(vec3 world) const { return {glm::dot(world, east), glm::dot(world, north), glm::dot(world, up)}; }
vec3 UpFrame::world(vec3 local) const { return local.x * east + local.y * north + local.z * up; }

UpFrame up_frame(vec3 up) {
  UpFrame frame;
  frame.up = glm::normalize(up);
  const vec3 hint = std::abs(frame.up.x) < 0.9f ? vec3{1, 0, 0} : vec3{0, 1, 0};
  frame.east = glm::normalize(hint - glm::dot(hint, frame.up) * frame.up);
  frame.north = glm::cross(frame.up, frame.east);
  return frame;
}

vec3 on_octahedron(float x, float y) {
  const float z = 1.0f - std::abs(x) - std::abs(y);
  if (z >= 0) return {x, y, z};
  return {(1.0f - std::abs(y)) * (x < 0 ? -1.0f : 1.0f), (1.0f - std::abs(x)) * (y < 0 ? -1.0f : 1.0f), z};
}

DirectionMap::DirectionMap(int cells, FunctionRef<vec3(vec3)> function) : cells_(cells), nodes_(cells + 1, cells + 2) {
  const float step = 2.0f / static_cast<float>(cells);
  parallel_for(static_cast<std::size_t>(cells) + 1, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j)
      for (int i = 0; i <= cells; ++i)
        nodes_(i, static_cast<int>(j)) = function(
            glm::normalize(on_octahedron(static_cast<float>(i) * step - 1.0f, static_cast<float>(j) * step - 1.0f)));
  });
}

DirectionMap blurred(const DirectionMap& map, float sigma, int cells) {
  // A spiral of points that are equally likely under the Gaussian.
  constexpr int kPoints = 40;
  std::array<vec3, kPoints> spiral;
  for (int k = 0; k < kPoints; ++k) {
    const float u = (static_cast<float>(k) + 0.5f) / kPoints;
    const float angle = std::min(sigma * std::sqrt(-2.0f * std::log(1.0f - u)), kPi);
    const float turn = 2.39996323f * static_cast<float>(k);
    spiral[static_cast<std::size_t>(k)] = {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                                           std::cos(angle)};
  }
  return DirectionMap(cells, [&](vec3 direction) {
    const UpFrame frame = up_frame(direction);
    vec3 sum{0.0f};
    for (const vec3& p : spiral) sum += map.at(frame.world(p));
    return sum / static_cast<float>(kPoints);
  });
}

DirectionMap convolved_with_cosine(const DirectionMap& map, int cells) {
  struct Light {
    vec3 direction;
    float solid_angle;
    vec3 radiance;
  };
  constexpr int kEdge = 48;
  std::vector<Light> lights;
  for (int j = 0; j < kEdge; ++j)
    for (int i = 0; i < kEdge; ++i) {
      const vec3 p = on_octahedron((static_cast<float>(i) + 0.5f) * (2.0f / kEdge) - 1.0f,
                                   (static_cast<float>(j) + 0.5f) * (2.0f / kEdge) - 1.0f);
      const float r = glm::length(p);
      lights.push_back({p / r, 1.0f / (r * r * r), map.at(p)});
    }
  return DirectionMap(cells, [&](vec3 normal) {
    // Dividing by the sum of the weights makes uniform radiance L exactly pi L.
    vec3 sum{0.0f};
    float weights = 0;
    for (const Light& light : lights) {
      const float weight = std::max(0.0f, glm::dot(normal, light.direction)) * light.solid_angle;
      sum += weight * light.radiance;
      weights += weight;
    }
    return sum * (kPi / weights);
  });
}

}  // namespace meniscus
