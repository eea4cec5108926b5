#include "sim/simulation_check.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr float kFar = 1e6f;  ///< m

[[noreturn]] void refuse(std::string problem, std::string expected, std::string found, std::string advice = {}) {
  throw Error(ErrorCode::invalid_argument,
              {std::move(problem), std::move(expected), std::move(found), {}, {}, {}, std::move(advice)});
}

std::string text(vec3 v) { return fmt::format("({:g}, {:g}, {:g})", v.x, v.y, v.z); }

void check_place(vec3 place, const char* what) {
  if (!(glm::length(place) <= kFar))
    refuse(fmt::format("{} is out of range", what), "within 1e6 m of the origin", text(place));
}

void check_axis(vec3 axis, const char* what) {
  const float length = glm::length(axis);
  if (!(length > 1e-6f && length < kFar))
    refuse(fmt::format("{} has no direction", what), "a vector longer than 0", text(axis));
}

void check_times(double from, double until, const char* what) {
  if (std::isfinite(from) && std::isfinite(until) && from <= until) return;
  refuse(fmt::format("{} does not end after it begins", what), "from <= until, seconds",
         fmt::format("from {} until {}", from, until));
}

}  // namespace

void check_tank(const SimulationOptions& options) {
  check_place(options.tank.low, "the tank's lower corner");
  check_place(options.tank.high, "the tank's upper corner");
  const vec3 extent = options.tank.high - options.tank.low;
  for (int i = 0; i < 3; ++i)
    if (!(extent[i] >= options.fluid.spacing))
      refuse("the tank has no room",
             fmt::format("at least one spacing of {:g} m along each axis", options.fluid.spacing),
             fmt::format("{:g} m along {}", extent[i], name_of(static_cast<Axis>(i))),
             "give the tank its inside from low to high");
  if (options.most_particles == 0 || options.most_particles > 1'000'000'000)
    refuse("the largest number of particles is out of range", "1 to 1,000,000,000",
           fmt::format("{}", options.most_particles));
}

void check_block(const Bounds& block, const Bounds& tank, Axis up) {
  check_place(block.low, "the lower corner of a block of water");
  check_place(block.high, "the upper corner of a block of water");
  for (int i = 0; i < 3; ++i) {
    if (!(block.low[i] <= block.high[i]))
      refuse("a block of water is turned over", "low <= high", text(block.low) + " to " + text(block.high));
    const float slack = 1e-4f * (tank.high[i] - tank.low[i]);
    const bool open = i == static_cast<int>(up);
    if (block.low[i] < tank.low[i] - slack || (!open && block.high[i] > tank.high[i] + slack))
      refuse("a block of water reaches out of the tank",
             fmt::format("{} from {:g}{}", name_of(static_cast<Axis>(i)), tank.low[i],
                         open ? std::string(" up") : fmt::format(" to {:g} m", tank.high[i])),
             fmt::format("{:g} to {:g} m", block.low[i], block.high[i]), "make the block smaller or the tank larger");
  }
}

void check_water(const SimulationOptions& options, std::size_t particles) {
  if (particles > 0 || options.blocks.empty() || !options.pours.empty()) return;
  const float spacing = options.fluid.spacing;
  const auto thin = [&](const Bounds& block) {
    const vec3 extent = block.extent();
    return !(std::min({extent.x, extent.y, extent.z}) >= 0.999f * spacing);
  };
  const bool all_thin = std::all_of(options.blocks.begin(), options.blocks.end(), thin);
  refuse("the blocks of water hold no particle", "water that fills a cube of one spacing at least",
         all_thin ? fmt::format("blocks thinner than a spacing of {:g} m", spacing)
                  : std::string("blocks that are taken by obstacles or thinner than a spacing"),
         "make the blocks larger or the spacing smaller, move the obstacles, or let a jet pour water");
}

void check_pour(const Pour& pour, const Bounds& tank, Axis up) {
  check_times(pour.from, pour.until, "a jet");
  check_place(pour.at, "the mouth of a jet");
  for (int i = 0; i < 3; ++i)
    if (!(pour.at[i] >= tank.low[i] && (i == static_cast<int>(up) || pour.at[i] <= tank.high[i])))
      refuse("the mouth of a jet is outside of the tank", text(tank.low) + " to " + text(tank.high), text(pour.at));
  const float speed = glm::length(pour.velocity);
  if (!(speed >= 1e-3f && speed <= 1e3f))
    refuse("the speed of a jet is out of range", "0.001 to 1000 m/s", text(pour.velocity));
  if (!(pour.radius > 0 && pour.radius <= kFar))
    refuse("the radius of a jet is out of range", "above 0 m", fmt::format("{}", pour.radius));
}

void check_stir(const Stir& stir) {
  check_times(stir.from, stir.until, "stirring");
  check_place(stir.centre, "the centre of stirring");
  check_axis(stir.axis, "the axis of stirring");
  if (!(stir.radius > 0 && stir.radius <= kFar))
    refuse("the radius of stirring is out of range", "above 0 m", fmt::format("{}", stir.radius));
  if (!(std::abs(stir.speed) <= 1e3f))
    refuse("the speed of stirring is out of range", "-1000 to 1000 m/s", fmt::format("{}", stir.speed));
}

void check_tilt(const Tilt& tilt) {
  check_times(tilt.from, tilt.until, "a tilt");
  check_axis(tilt.axis, "the axis of a tilt");
  if (!(std::abs(tilt.angle) <= 3.1416f))
    refuse("the angle of a tilt is out of range", "-3.1416 to 3.1416", fmt::format("{}", tilt.angle));
}

void check_drag(const Drag& drag, std::size_t obstacles) {
  check_times(drag.from, drag.until, "a drag");
  check_place(drag.to, "the end of a drag");
  check_obstacle_index(drag.obstacle, obstacles);
}

void check_obstacle_index(std::size_t index, std::size_t obstacles) {
  if (index >= obstacles)
    refuse("there is no such obstacle",
           obstacles == 0 ? "none, for there are no obstacles" : fmt::format("0 to {}", obstacles - 1),
           fmt::format("{}", index));
}

}  // namespace meniscus
