/// A simulation with bodies that have roles in it: which body is which obstacle, and what time it is in which frame.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/render.h"
#include "render/body_placement.h"
#include "render/simulated_bodies.h"
#include "sim/fluid.h"

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

/// The step that was asked for; else the default, but no more than a frame, s.
float step_of(const SimulatedWater& water) {
  const FluidOptions& fluid = water.simulation.fluid;
  const double frame = 1 / water.frames_per_second;
  const float step = with_defaults(fluid).step;
  if (static_cast<double>(step) <= frame * 1.0001) return fluid.step;
  if (fluid.step == 0) return static_cast<float>(frame);
  throw Error(ErrorCode::invalid_argument,
              {"a step of the simulation is longer than a frame",
               fmt::format("at most {:.4g} s, a frame at {:g} a second", frame, water.frames_per_second),
               fmt::format("a step of {:.4g} s", step),
               {},
               {},
               {},
               "set a smaller step, or none, or fewer frames a second"});
}

/// Frames that would not come to an end.
void check_pace(const SimulatedWater& water, const FluidOptions& fluid) {
  constexpr double kMostSteps = 10000;
  const FluidOptions filled = with_defaults(fluid);
  const double parts = std::ceil(static_cast<double>(filled.step / longest_stable_step(filled)) * 0.999);
  double steps = std::round(1 / (water.frames_per_second * static_cast<double>(filled.step)));
  if (water.most_steps > 0) steps = std::min(steps, static_cast<double>(water.most_steps));
  steps *= std::max(parts, 1.0);
  if (steps <= kMostSteps) return;
  throw Error(ErrorCode::invalid_argument,
              {"a frame of the simulation takes too many steps",
               fmt::format("at most {:.0f}", kMostSteps),
               fmt::format("{:.0f} steps a frame, at {:g} frames a second", steps, water.frames_per_second),
               {},
               {},
               {},
               "take a longer step, a larger spacing, less stiffness, viscosity or surface tension, or more frames a "
               "second"});
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
  options.fluid.step = step_of(water);
  check_pace(water, options.fluid);
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
  FrameSequence sequence;
  sequence.frames.resize(frames());
  sequence.foreseen = foreseen();
  return survey_frames(sequence);
}

Foreseen SimulatedScene::foreseen() const {
  const SimulationOptions& options = parts_->water.simulation;
  return {parts_->at_start,    options.tank, options.fluid.spacing, options.up,
          fastest_of(options), {"velocity"}, "of the simulation"};
}

Simulation& SimulatedScene::simulation() { return parts_->simulation; }

}  // namespace meniscus
