#include "sim/interaction.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "sim/simulation_room.h"

namespace meniscus {
namespace {

constexpr float kMouthApart_rel = 0.7f;  ///< of a spacing: nearer than this the mouth is blocked
constexpr float kStirTime = 0.1f;        ///< s, in which stirred water gets two thirds of the way to its speed
constexpr std::size_t kGrain = 4096;

}  // namespace

Jet::Jet(const Pour& pour, float spacing)
    : pour_(pour), spacing_(spacing), direction_(glm::normalize(pour.velocity)), speed_(glm::length(pour.velocity)) {
  // The places of a square lattice that are nearest to the centre, as many as the disc's area needs.
  const double area = std::numbers::pi * static_cast<double>(pour.radius) * static_cast<double>(pour.radius);
  const double square = static_cast<double>(spacing) * static_cast<double>(spacing);
  const auto count = static_cast<std::size_t>(std::max(std::ceil(area / square - 1e-6), 1.0));
  const int edge = static_cast<int>(std::ceil(pour.radius / spacing)) + 1;
  std::vector<glm::ivec2> places;
  for (int j = -edge; j <= edge; ++j)
    for (int i = -edge; i <= edge; ++i) places.push_back({i, j});
  std::stable_sort(places.begin(), places.end(),
                   [](glm::ivec2 a, glm::ivec2 b) { return a.x * a.x + a.y * a.y < b.x * b.x + b.y * b.y; });
  const vec3 other = std::abs(direction_.x) < 0.6f ? vec3(1, 0, 0) : vec3(0, 0, 1);
  const vec3 right = glm::normalize(glm::cross(direction_, other)), up = glm::cross(right, direction_);
  for (std::size_t i = 0; i < count && i < places.size(); ++i)
    layer_.push_back((right * static_cast<float>(places[i].x) + up * static_cast<float>(places[i].y)) * spacing);
  gap_ = static_cast<double>(layer_.size()) * square * static_cast<double>(spacing) / area;
}

void Jet::emit(Fluid& fluid, double time, double dt, const Obstacles& obstacles, std::size_t most) const {
  // Layer n leaves in the middle of its share of the time, at from + (n + 1/2) gap / speed.
  const double begin = std::max((time - pour_.from) * speed_ / gap_ - 0.5, 0.0);
  const double end = (std::min(time + dt, pour_.until) - pour_.from) * speed_ / gap_ - 0.5;
  double layer = std::ceil(begin);
  if (!(layer < end)) return;
  const auto reach = static_cast<float>(speed_ * dt);
  Bounds mouth;
  mouth.add(pour_.at);
  mouth.add(pour_.at + direction_ * reach);
  Room room(mouth.grown(pour_.radius + 2 * spacing_), kMouthApart_rel * spacing_, fluid);
  const Bounds& tank = obstacles.tank();
  for (; layer < end; layer += 1) {
    const auto way = static_cast<float>((time + dt - pour_.from) * speed_ - (layer + 0.5) * gap_);
    for (const vec3 place : layer_) {
      const vec3 point = pour_.at + place + direction_ * way;
      bool inside = true;
      for (int i = 0; i < 3; ++i)
        inside =
            inside && point[i] >= tank.low[i] && (i == static_cast<int>(obstacles.up()) || point[i] <= tank.high[i]);
      if (!inside || fluid.size() >= most || !room.free(point)) continue;
      if (obstacles.clearance(point, spacing_) < 0.4f * spacing_) continue;
      room.take(point);
      fluid.add(point, pour_.velocity);
    }
  }
}

vec3 tilted(vec3 gravity, std::span<const Tilt> tilts, double time) {
  for (const Tilt& tilt : tilts) {
    if (!(time > tilt.from && time < tilt.until)) continue;
    const double sine = std::sin(std::numbers::pi * (time - tilt.from) / (tilt.until - tilt.from));
    const auto angle = static_cast<float>(static_cast<double>(tilt.angle) * sine * sine);
    gravity = glm::angleAxis(-angle, glm::normalize(tilt.axis)) * gravity;
  }
  return gravity;
}

void stir_water(const Fluid& fluid, const Stir& stir, std::span<vec3> forces) {
  const vec3 axis = glm::normalize(stir.axis);
  parallel_for(fluid.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      vec3 arm = vec3(fluid.x[i], fluid.y[i], fluid.z[i]) - stir.centre;
      arm -= axis * glm::dot(arm, axis);
      const float distance = glm::length(arm);
      if (!(distance > 0 && distance < stir.radius)) continue;
      const vec3 around = glm::cross(axis, arm) / distance;
      const float speed = glm::dot(around, vec3(fluid.vx[i], fluid.vy[i], fluid.vz[i]));
      forces[i] += around * ((stir.speed * distance / stir.radius - speed) / kStirTime);
    }
  });
}

}  // namespace meniscus
