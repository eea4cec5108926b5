/// Bodies as obstacles of a simulation, and back as what is drawn.
#pragma once

#include <glm/ext/matrix_double4x4.hpp>
#include <optional>
#include <vector>

#include "meniscus/render.h"

namespace meniscus {

class SimulatedBodies {
 public:
  /// @throws Error  as read_mesh(); invalid_argument: a body with a role that is one file a frame, or that moves by
  ///                frames of its own; dynamic ones that are no box, sphere or cylinder; two of one name
  explicit SimulatedBodies(std::vector<BodyOptions> bodies);
  /// Those with a role, in the order of the bodies.
  const std::vector<ObstacleOptions>& obstacles() const { return obstacles_; }
  /// Index of the obstacle that is the body of this name. @throws Error not_found, with the nearest name
  std::size_t obstacle_called(const std::string& name) const;
  /// As BodyOptions::frames, one a body; none where a body has not appeared. Bodies without a role stay as they are.
  std::vector<std::optional<glm::mat4>> transforms(const Simulation& simulation) const;

 private:
  struct Link {
    std::optional<std::size_t> obstacle;
    glm::dmat4 world_from_body{1.0};
    Pose start;
  };
  std::vector<BodyOptions> bodies_;
  std::vector<Link> links_;  ///< one a body
  std::vector<ObstacleOptions> obstacles_;
};

}  // namespace meniscus
