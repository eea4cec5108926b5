/// How a body is placed, in the parts that a simulation needs: a rigid placement of a shape that is scaled.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include "meniscus/sim.h"

namespace meniscus {

struct Mesh;
struct PlacedSolid;

/// matrix = pose * scale, where the matrix turns, moves and scales along the body's own axes.
struct BodyPlacement {
  Pose pose;
  glm::mat3 shape{1.0f};  ///< what is left of the matrix: the scale; all of its linear part if that shears or mirrors
  bool scales = true;     ///< shape is a scale
  vec3 scale() const { return {shape[0][0], shape[1][1], shape[2][2]}; }
};
/// @param matrix  affine, invertible
BodyPlacement placement_of(const glm::mat4& matrix);

/// World from body of a pose.
glm::mat4 matrix_of(const Pose& pose);

/// The body's shape as an obstacle meets the water: box, sphere and cylinder as they are where the scale lets them,
/// else their triangles, welded.
/// @param solid  its mesh
/// @param name   "box", "sphere" or "cylinder"; else it is a mesh
ObstacleShape obstacle_shape_of(const Mesh& mesh, const std::string& name, const BodyPlacement& placement);

/// Box around the corners of a placed body's box, m.
Bounds bounds_of(const PlacedSolid& body);

}  // namespace meniscus
