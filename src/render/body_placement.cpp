#include "render/body_placement.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>

#include "meniscus/scene.h"

namespace meniscus {
namespace {

/// Of lengths and cosines, below which two axes are alike or at right angles.
constexpr float kAlike = 1e-4f;

bool alike(float a, float b) { return std::abs(a - b) <= kAlike * std::max(std::abs(a), std::abs(b)); }

/// The triangles after the linear part of the placement; points that files split for their normals are one again.
ObstacleShape mesh_shape(const Mesh& mesh, const glm::mat3& linear) {
  ObstacleShape shape;
  shape.kind = ObstacleShape::Kind::mesh;
  std::map<std::array<float, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> welded;
  welded.reserve(mesh.positions.size());
  for (const vec3 point : mesh.positions) {
    const auto [place, is_new] = known.try_emplace({point.x + 0.0f, point.y + 0.0f, point.z + 0.0f},
                                                   static_cast<std::uint32_t>(shape.positions.size()));
    if (is_new) shape.positions.push_back(linear * point);
    welded.push_back(place->second);
  }
  const bool mirrored = glm::determinant(linear) < 0;
  for (std::size_t i = 0; i + 2 < mesh.corners.size(); i += 3) {
    std::array<std::uint32_t, 3> corner{welded[mesh.corners[i]], welded[mesh.corners[i + 1]],
                                        welded[mesh.corners[i + 2]]};
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
    if (mirrored) std::swap(corner[1], corner[2]);
    shape.corners.insert(shape.corners.end(), corner.begin(), corner.end());
  }
  return shape;
}

}  // namespace

BodyPlacement placement_of(const glm::mat4& matrix) {
  BodyPlacement placement;
  placement.pose.position = vec3(matrix[3]);
  const glm::mat3 linear(matrix);
  vec3 scale{glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])};
  const glm::mat3 axes(linear[0] / scale.x, linear[1] / scale.y, linear[2] / scale.z);
  const bool straight = std::abs(glm::dot(axes[0], axes[1])) < kAlike &&
                        std::abs(glm::dot(axes[1], axes[2])) < kAlike && std::abs(glm::dot(axes[2], axes[0])) < kAlike;
  if (!straight || !(glm::determinant(axes) > 0)) {
    placement.shape = linear;
    placement.scales = false;
    return placement;
  }
  placement.pose.rotation = glm::normalize(glm::quat_cast(axes));
  placement.shape = glm::mat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z);
  return placement;
}

glm::mat4 matrix_of(const Pose& pose) {
  glm::mat4 matrix = glm::mat4_cast(pose.rotation);
  matrix[3] = glm::vec4(pose.position, 1.0f);
  return matrix;
}

ObstacleShape obstacle_shape_of(const Mesh& mesh, const std::string& name, const BodyPlacement& placement) {
  ObstacleShape shape;
  const vec3 scale = placement.scale();
  if (placement.scales && name == "box") {
    shape.size = scale;
    return shape;
  }
  if (placement.scales && name == "sphere" && alike(scale.x, scale.y) && alike(scale.y, scale.z)) {
    shape.kind = ObstacleShape::Kind::sphere;
    shape.size = vec3(scale.x);
    return shape;
  }
  if (placement.scales && name == "cylinder" && alike(scale.x, scale.z)) {
    shape.kind = ObstacleShape::Kind::cylinder;
    shape.size = {scale.x, scale.y, scale.x};
    return shape;
  }
  return mesh_shape(mesh, placement.shape);
}

Bounds bounds_of(const PlacedSolid& body) {
  const Bounds box = body.solid->bounds();
  Bounds placed;
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 point{corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                     corner & 4 ? box.high.z : box.low.z};
    placed.add(vec3(body.world_from_solid * glm::vec4(point, 1.0f)));
  }
  return placed;
}

}  // namespace meniscus
