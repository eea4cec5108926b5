/// A simulation with bodies that have roles in it: which body is which obstacle, and what time it is in which frame.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/render.h"
#include "render/body_placement.h"
#include "render/simulated_bodies.h"

namespace meniscus {
namespace {

void check(const SimulatedWater& water) {
  if (water.frames < 1) throw Error(ErrorCode::invalid_argument, "a simulation needs one frame at least");
  if (!(water.frames_per_second > 0 && std::isfinite(water.frames_per_second)))
    throw Error(ErrorCode::invalid_argument, "a simulation needs a number of frames a second above 0");
  if (water.dragged.size() != water.simulation.drags.size())
    throw Error(ErrorCode::invalid_argument,
                fmt::format("{} drags name {} bodies", water.simulation.drags.size(), water.dragged.size()));
}

/// How fast the water may become: falling through the tank, out of a jet, or with what moves it.
float fastest_of(const SimulationOptions& options) {
  const vec3 extent = options.tank.extent();
  float fastest = std::sqrt(2 * glm::length(options.fluid.gravity) * extent[static_cast<int>(options.up)]);
  for (const Pour& pour : options.pours) fastest = std::max(fastest, glm::length(pour.velocity));
  for (const Stir& stir : options.stirs) fastest = std::max(fastest, std::abs(stir.speed));
  return fastest;
}

SimulationOptions simulation_of(const SimulatedWater& water, const SimulatedBodies& bodies) {
  SimulationOptions options = water.simulation;
  options.obstacles = bodies.obstacles();
  for (std::size_t i = 0; i < options.drags.size(); ++i)
    options.drags[i].obstacle = bodies.obstacle_called(water.dragged[i]);
  return options;
}

}  // namespace

struct SimulatedScene::Parts {
  SimulatedWater water;
  SimulatedBodies bodies;
  Simulation simulation;
  std::size_t at = 0;    ///< the frame that the simulation is in
  double due = 0;        ///< s; when that frame should be
  std::size_t at_start;  ///< particles

  Parts(const SimulatedWater& of, std::vector<BodyOptions> with)
      : water((check(of), of)),
        bodies(std::move(with)),
        simulation(simulation_of(water, bodies)),
        at_start(simulation.size()) {}

  /// One frame on. The pictures' times do not drift by rounding to steps; but water that is slowed stays behind.
  void go_on(StageTimes* times) {
    due += 1 / water.frames_per_second;
    simulation.advance(std::max(due - simulation.time(), 0.0), water.most_steps, times);
    if (simulation.time() + simulation.step_size() < due) due = simulation.time();
    ++at;
  }
};

SimulatedScene::SimulatedScene(const SimulatedWater& water, std::vector<BodyOptions> bodies)
    : parts_(std::make_unique<Parts>(water, std::move(bodies))) {}

SimulatedScene::~SimulatedScene() = default;

std::size_t SimulatedScene::frames() const { return parts_->water.frames; }

Particles SimulatedScene::frame(std::size_t index, StageTimes* times) {
  if (index < parts_->at || index >= frames())
    throw Error(ErrorCode::invalid_argument, {fmt::format("frame {} of a simulation cannot be made", index),
                                              fmt::format("{} to {}", parts_->at, frames() - 1),
                                              fmt::to_string(index),
                                              {},
                                              {},
                                              {},
                                              "ask for its frames in rising order"});
  while (parts_->at < index) parts_->go_on(times);
  Particles particles = parts_->simulation.particles();
  particles.format = "simulation";
  return particles;
}

std::vector<std::optional<glm::mat4>> SimulatedScene::transforms() const {
  return parts_->bodies.transforms(parts_->simulation);
}

Survey SimulatedScene::survey() const {
  const Foreseen foreseen = this->foreseen();
  Survey survey;
  survey.frames = frames();
  survey.most_particles = foreseen.particles;
  survey.bounds = foreseen.bounds;
  survey.spacing = {foreseen.spacing, 3, foreseen.reasoning};
  survey.up = {foreseen.up, foreseen.reasoning};
  survey.attributes = foreseen.attributes;
  return survey;
}

Foreseen SimulatedScene::foreseen() const {
  const SimulationOptions& options = parts_->water.simulation;
  return {parts_->at_start,    options.tank, options.fluid.spacing, options.up,
          fastest_of(options), {"velocity"}, "of the simulation"};
}

Simulation& SimulatedScene::simulation() { return parts_->simulation; }

}  // namespace meniscus
