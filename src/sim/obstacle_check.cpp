#include "sim/obstacle_check.h"

#include <fmt/format.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace meniscus {
namespace {

[[noreturn]] void refuse(std::string problem, std::string expected, std::string found, std::string advice = {}) {
  throw Error(ErrorCode::invalid_argument,
              {std::move(problem), std::move(expected), std::move(found), {}, {}, {}, std::move(advice)});
}

}  // namespace

void check_pose(const Pose& pose) {
  const vec3 p = pose.position;
  if (!(glm::length(p) <= 1e6f))
    refuse("an obstacle's place is out of range", "within 1e6 m of the origin",
           fmt::format("({}, {}, {})", p.x, p.y, p.z));
  const float length = glm::length(pose.rotation);
  if (!(std::abs(length - 1) <= 1e-2f))
    refuse("an obstacle's rotation is not a unit quaternion", "length 1", fmt::format("length {}", length));
}

void check_obstacle(const ObstacleOptions& options) {
  check_pose(options.pose);
  for (std::size_t i = 0; i < options.path.size(); ++i) {
    check_pose(options.path[i].pose);
    const double time = options.path[i].time;
    if (!std::isfinite(time))
      refuse("a time on an obstacle's path is not a number", "seconds", fmt::format("{}", time));
    if (i > 0 && !(time > options.path[i - 1].time))
      refuse("times on an obstacle's path do not rise", fmt::format("more than {} s", options.path[i - 1].time),
             fmt::format("{} s", time), "sort the path by time and let no two keys have the same");
  }
  if (!std::isfinite(options.appears))
    refuse("the time when an obstacle appears is not a number", "seconds", fmt::format("{}", options.appears));
  if (!options.dynamic) return;
  if (!(options.density >= 1 && options.density <= 1e5f))
    refuse("the density of a dynamic obstacle is out of range", "1 to 100000 kg/m^3",
           fmt::format("{}", options.density));
  if (!options.path.empty())
    refuse("a dynamic obstacle cannot follow a path", "dynamic or a path", "both", "use a drag to move it for a while");
  if (options.shape.kind == ObstacleShape::Kind::mesh)
    refuse("a mesh cannot be dynamic", "a box, sphere or cylinder", "a mesh",
           "let it stand or follow a path, or use a simple shape in its place");
}

}  // namespace meniscus
