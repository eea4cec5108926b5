#include "render/simulated_bodies.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "render/body_placement.h"
#include "render/body_shapes.h"
#include "render/nearest_name.h"
#include "render/numbered_path.h"

namespace meniscus {
namespace {

std::string words_for(const BodyOptions& body, std::size_t index) {
  return body.name.empty() ? fmt::format("body {}", index) : fmt::format("the body {}", body.name);
}

[[noreturn]] void refuse(std::string problem, std::string expected, std::string advice = {}) {
  throw Error(ErrorCode::invalid_argument,
              {std::move(problem), std::move(expected), {}, {}, {}, {}, std::move(advice)});
}

void check(const BodyOptions& body, std::size_t index) {
  if (NumberedPath(body.path).is_numbered())
    refuse(words_for(body, index) + " is another mesh in each frame, and cannot be an obstacle", "one file");
  if (!body.frames.empty())
    refuse(words_for(body, index) + " moves by frames, and is moved by a simulation as well", "one of them",
           "give its role a path instead of frames");
}

ObstacleOptions obstacle_of(const BodyOptions& body, std::size_t index, const BodyPlacement& placement) {
  ObstacleOptions obstacle;
  obstacle.shape = obstacle_shape_of(mesh_of(body), body.shape, placement);
  obstacle.pose = placement.pose;
  obstacle.path = body.role->path;
  obstacle.dynamic = body.role->dynamic;
  obstacle.density = body.role->density;
  obstacle.appears = body.role->appears;
  if (obstacle.dynamic && obstacle.shape.kind == ObstacleShape::Kind::mesh)
    refuse(words_for(body, index) + " cannot float freely",
           "a box, a sphere or a cylinder, scaled along its own axes, a sphere and the round of a cylinder evenly");
  return obstacle;
}

glm::dmat4 matrix_in_double(const Pose& pose) {
  const glm::dquat turn(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  glm::dmat4 matrix = glm::mat4_cast(turn);
  matrix[3] = glm::dvec4(pose.position.x, pose.position.y, pose.position.z, 1.0);
  return matrix;
}

bool same(const Pose& a, const Pose& b) { return a.position == b.position && a.rotation == b.rotation; }

}  // namespace

SimulatedBodies::SimulatedBodies(std::vector<BodyOptions> bodies) : bodies_(std::move(bodies)) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const BodyOptions& body = bodies_[i];
    Link& link = links_.emplace_back();
    if (!body.role) continue;
    for (std::size_t j = 0; j < i; ++j)
      if (!body.name.empty() && bodies_[j].name == body.name && bodies_[j].role)
        refuse(fmt::format("two bodies are called {}", body.name), "a name of its own for each");
    check(body, i);
    const BodyPlacement placement = placement_of(body.world_from_body);
    link.obstacle = obstacles_.size();
    link.world_from_body = body.world_from_body;
    link.start = placement.pose;
    obstacles_.push_back(obstacle_of(body, i, placement));
  }
}

std::size_t SimulatedBodies::obstacle_called(const std::string& name) const {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!links_[i].obstacle || bodies_[i].name.empty()) continue;
    if (bodies_[i].name == name) return *links_[i].obstacle;
    known.push_back(bodies_[i].name);
  }
  const std::string nearest = nearest_name(name, known);
  throw Error(ErrorCode::not_found,
              {"no obstacle has the name of a body that is dragged",
               known.empty() ? std::string("a body with a name and a role") : fmt::format("{}", fmt::join(known, ", ")),
               name,
               {},
               {},
               {},
               nearest.empty() ? "" : "did you mean " + nearest + "?"});
}

std::vector<std::optional<glm::mat4>> SimulatedBodies::transforms(const Simulation& simulation) const {
  std::vector<std::optional<glm::mat4>> transforms;
  for (const Link& link : links_) {
    std::optional<glm::mat4>& transform = transforms.emplace_back();
    if (link.obstacle && !simulation.present(*link.obstacle)) continue;
    transform = glm::mat4(1.0f);
    if (!link.obstacle) continue;
    const Pose pose = simulation.pose(*link.obstacle);
    if (same(pose, link.start)) continue;  // exactly where it was placed
    // world * transform = pose * start^-1 * world
    transform = glm::mat4(glm::inverse(link.world_from_body) * matrix_in_double(pose) *
                          glm::inverse(matrix_in_double(link.start)) * link.world_from_body);
  }
  return transforms;
}

}  // namespace meniscus
