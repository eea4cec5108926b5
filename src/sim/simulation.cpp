#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "sim/fluid.h"
#include "sim/interaction.h"
#include "sim/obstacle_check.h"
#include "sim/obstacles.h"
#include "sim/simulation_check.h"
#include "sim/simulation_room.h"

namespace meniscus {
namespace {

// Obstacles that are fast take several smaller steps, each of no more than this many spacings ...
constexpr float kWay_rel = 0.5f;
// ... and what would need more of them than these is set there anew.
constexpr int kMostParts = 16;
// A surface grows so many spacings a step within water that was there before it.
constexpr float kGrowth_rel = 0.1f;
// The water meets walls that go no more spacings than this in a whole step.
constexpr float kWallWay_rel = 2;

// Solvers count the solid at a wall as a half space, which is too much beside the edges of a box and around a ball: a
// body would displace more than itself. With this part of a spacing taken off, a box eight spacings wide is lifted by
// what its volume displaces within 2 % under water and 7 % half in it; without, by 8 to 24 % too much.
constexpr float kSkin_rel = 0.2f;

/// Default gravity follows the up axis.
vec3 gravity_of(const FluidOptions& fluid, Axis up) {
  return fluid.gravity == FluidOptions{}.gravity ? -9.81f * direction_of(up) : fluid.gravity;
}

/// kg
double particle_mass(const FluidOptions& fluid) {
  return static_cast<double>(fluid.rest_density) * std::pow(static_cast<double>(fluid.spacing), 3);
}

struct RunningDrag {
  Drag drag;
  std::optional<PoseKey> start;  ///< once it has begun
};

}  // namespace

struct Simulation::Parts {
  FluidOptions fluid_options;
  Obstacles obstacles;
  std::size_t most;
  std::unique_ptr<FluidSolver> solver;
  Fluid fluid;
  std::vector<Jet> jets;
  std::vector<Stir> stirs;
  std::vector<Tilt> tilts;
  std::vector<RunningDrag> drags;
  std::size_t steps = 0;

  Parts(const SimulationOptions& options, const FluidOptions& fluid)
      : fluid_options(fluid),
        obstacles(options.tank, options.up, fluid.smoothing_length),
        most(options.most_particles) {
    solver = fluid.solver == Solver::sph ? make_sph_solver(fluid) : make_pbf_solver(fluid);
    obstacles.set_skin(kSkin_rel * fluid.spacing);
    obstacles.limit_speed(kWallWay_rel * fluid.spacing / fluid.step);
  }

  double time() const { return static_cast<double>(steps) * static_cast<double>(fluid_options.step); }

  /// Water that is within them already is pushed out of those that appear little by little.
  void appear() {
    for (const std::size_t i : obstacles.appear(time())) make_way(i);
  }
  void make_way(std::size_t obstacle) {
    const float depth = depth_inside(fluid, obstacles, obstacle);
    const float spacing = fluid_options.spacing;
    if (depth > 0) obstacles.grow(obstacle, depth + spacing / 2, kGrowth_rel * spacing / fluid_options.step);
  }

  void lead_drags() {
    const double now = time(), end = now + static_cast<double>(fluid_options.step);
    for (RunningDrag& running : drags) {
      const Drag& drag = running.drag;
      if (!(end > drag.from)) continue;
      if (!running.start) running.start = {std::max(drag.from, now), obstacles[drag.obstacle].body.pose};
      const double length = drag.until - running.start->time;
      const double part = length > 0 ? smooth_step((end - running.start->time) / length) : 1.0;
      Pose pose = running.start->pose;
      pose.position += (drag.to - pose.position) * static_cast<float>(part);
      if (end >= drag.until) pose.position = drag.to;
      obstacles.lead(drag.obstacle, pose);
    }
    std::erase_if(drags, [&](const RunningDrag& running) { return end >= running.drag.until; });
  }

  /// In how many parts this step is taken, so that nothing jumps over the water.
  int parts_of_step() {
    const float most_way = kWay_rel * fluid_options.spacing;
    float way = 0;
    for (std::size_t i = 0; i < obstacles.bodies(); ++i) {
      if (!obstacles[i].present) continue;
      const float own = obstacles.way_of(i, time(), fluid_options.step);
      if (own <= most_way * kMostParts) {
        way = std::max(way, own);
      } else if (obstacles[i].target || !obstacles[i].path.empty()) {
        obstacles.put(i, obstacles.pose_at(i, time() + static_cast<double>(fluid_options.step)));
        make_way(i);
      } else {
        way = most_way * kMostParts;
      }
    }
    return std::clamp(static_cast<int>(std::ceil(way / most_way)), 1, kMostParts);
  }

  std::vector<vec3> forces() const {
    std::vector<vec3> sum;
    const double middle = time() + static_cast<double>(fluid_options.step) / 2;
    for (const Stir& stir : stirs) {
      if (!(middle > stir.from && middle < stir.until)) continue;
      sum.resize(fluid.size(), vec3(0.0f));
      stir_water(fluid, stir, sum);
    }
    return sum;
  }

  void step(StageTimes* times) {
    const float dt = fluid_options.step;
    std::optional<StageTimer> timer(std::in_place, times, "obstacles");
    appear();
    lead_drags();
    const int parts = parts_of_step();
    const std::vector<vec3> driven = forces();
    std::vector<Impulse> impulses(obstacles.bodies());
    for (int part = 0; part < parts; ++part) {
      const double now = time() + static_cast<double>(dt) * part / parts;
      const float left = dt * static_cast<float>(parts - part) / static_cast<float>(parts);
      const float length = part + 1 == parts ? left : dt / static_cast<float>(parts);
      const vec3 gravity = tilted(fluid_options.gravity, tilts, now + static_cast<double>(length) / 2);
      if (!timer) timer.emplace(times, "obstacles");
      obstacles.advance(now, length, left, gravity);
      timer.reset();
      std::fill(impulses.begin(), impulses.end(), Impulse{});
      solver->step(fluid, obstacles, gravity, driven, length, impulses, times);
      obstacles.take(impulses);
    }
    for (const Jet& jet : jets) jet.emit(fluid, time(), static_cast<double>(dt), obstacles, most);
    ++steps;
    // What is over is forgotten.
    std::erase_if(jets, [&](const Jet& jet) { return jet.pour().until <= time(); });
    std::erase_if(stirs, [&](const Stir& stir) { return stir.until <= time(); });
    std::erase_if(tilts, [&](const Tilt& tilt) { return tilt.until <= time(); });
  }
};

Simulation::Simulation(SimulationOptions options) {
  options.fluid.gravity = gravity_of(options.fluid, options.up);
  const FluidOptions fluid = with_defaults(options.fluid);
  check_tank(options);
  for (const Bounds& block : options.blocks) check_block(block, options.tank, options.up);
  parts_ = std::make_unique<Parts>(options, fluid);
  for (const ObstacleOptions& obstacle : options.obstacles) parts_->obstacles.add(obstacle, 0);
  parts_->obstacles.appear(0);
  for (const Bounds& block : options.blocks) add_water(block);
  check_water(options, size());
  for (const Pour& event : options.pours) pour(event);
  for (const Stir& event : options.stirs) stir(event);
  for (const Tilt& event : options.tilts) tilt(event);
  for (const Drag& event : options.drags) drag(event);
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

void Simulation::step(StageTimes* times) { parts_->step(times); }

void Simulation::advance(double seconds, int most_steps, StageTimes* times) {
  if (!(seconds >= 0 && seconds <= 1e9))
    throw Error(ErrorCode::invalid_argument,
                {"a simulation cannot go on by this time", "0 to 1e9 s", std::to_string(seconds), {}, {}, {}, {}});
  double steps = std::round(seconds / static_cast<double>(step_size()));
  if (most_steps > 0) steps = std::min(steps, static_cast<double>(most_steps));
  for (double i = 0; i < steps; i += 1) step(times);
}

double Simulation::time() const { return parts_->time(); }
float Simulation::step_size() const { return parts_->fluid_options.step; }
std::size_t Simulation::steps() const { return parts_->steps; }
std::size_t Simulation::size() const { return parts_->fluid.size(); }

Particles Simulation::particles() const {
  const Fluid& fluid = parts_->fluid;
  Particles particles;
  particles.x = fluid.x;
  particles.y = fluid.y;
  particles.z = fluid.z;
  Attribute velocity{"velocity", 3, {}};
  velocity.values.reserve(3 * fluid.size());
  for (std::size_t i = 0; i < fluid.size(); ++i)
    for (const float v : {fluid.vx[i], fluid.vy[i], fluid.vz[i]}) velocity.values.push_back(v);
  particles.attributes.push_back(std::move(velocity));
  particles.time = time();
  particles.up = parts_->obstacles.up();
  particles.spacing = parts_->fluid_options.spacing;
  return particles;
}

std::size_t Simulation::obstacles() const { return parts_->obstacles.bodies(); }
Pose Simulation::pose(std::size_t obstacle) const {
  check_obstacle_index(obstacle, obstacles());
  return parts_->obstacles[obstacle].body.pose;
}
bool Simulation::present(std::size_t obstacle) const {
  check_obstacle_index(obstacle, obstacles());
  return parts_->obstacles[obstacle].present;
}
float Simulation::mean_neighbours() const { return parts_->solver->mean_neighbours(); }

double Simulation::kinetic_energy() const {
  const Fluid& fluid = parts_->fluid;
  double sum = 0;
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const glm::dvec3 v(fluid.vx[i], fluid.vy[i], fluid.vz[i]);
    sum += glm::dot(v, v);
  }
  return 0.5 * particle_mass(parts_->fluid_options) * sum;
}

double Simulation::potential_energy() const {
  const Fluid& fluid = parts_->fluid;
  const glm::dvec3 gravity(parts_->fluid_options.gravity), low(parts_->obstacles.tank().low);
  double sum = 0;
  for (std::size_t i = 0; i < fluid.size(); ++i)
    sum -= glm::dot(gravity, glm::dvec3(fluid.x[i], fluid.y[i], fluid.z[i]) - low);
  return particle_mass(parts_->fluid_options) * sum;
}

void Simulation::pour(const Pour& pour) {
  check_pour(pour, parts_->obstacles.tank(), parts_->obstacles.up());
  // A disc that no water could fill: its layer is not even made.
  const double across = static_cast<double>(pour.radius) / static_cast<double>(parts_->fluid_options.spacing);
  if (!(4 * across * across <= static_cast<double>(parts_->most)))
    throw Error(ErrorCode::limit_exceeded, {"one layer of a jet has more particles than are allowed",
                                            std::to_string(parts_->most) + " particles",
                                            std::to_string(4 * across * across),
                                            {},
                                            {},
                                            {},
                                            "take a larger spacing or a narrower jet"});
  parts_->jets.emplace_back(pour, parts_->fluid_options.spacing);
}
void Simulation::stir(const Stir& stir) {
  check_stir(stir);
  parts_->stirs.push_back(stir);
}
void Simulation::tilt(const Tilt& tilt) {
  check_tilt(tilt);
  parts_->tilts.push_back(tilt);
}
void Simulation::drag(const Drag& drag) {
  check_drag(drag, obstacles());
  if (drag.until > time()) parts_->drags.push_back({drag, {}});
}

void Simulation::move(std::size_t obstacle, const Pose& pose) {
  check_obstacle_index(obstacle, obstacles());
  check_pose(pose);
  parts_->obstacles.lead(obstacle, pose);
}

std::size_t Simulation::add(const ObstacleOptions& obstacle) {
  const std::size_t index = parts_->obstacles.add(obstacle, time());
  parts_->appear();
  return index;
}

void Simulation::add_water(const Bounds& block) {
  check_block(block, parts_->obstacles.tank(), parts_->obstacles.up());
  add_block(parts_->fluid, block, parts_->fluid_options.spacing, parts_->obstacles, parts_->most);
}

}  // namespace meniscus
