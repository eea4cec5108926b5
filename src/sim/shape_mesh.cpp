#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sim/shape.h"
#include "sim/signed_distance.h"

namespace meniscus {
namespace {

constexpr int kCells = 32;                 ///< of the grid along the longest edge: at most 37^3 floats
constexpr std::size_t kTouchPoints = 256;  ///< corners that touch other bodies

/// Distances at the nodes of a grid bound those of all points: they change by no more than the way between two points.
/// Most points are settled so; the others ask the mesh within the bound, so that every answer is exact.
class MeshShape final : public Shape {
 public:
  explicit MeshShape(const ObstacleShape& shape) : distance_(close_mesh(shape.positions, shape.corners)) {
    const ClosedMesh& mesh = distance_.mesh();
    std::vector<bool> used(mesh.positions.size(), false);
    for (const ClosedMesh::Triangle& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle.corners) used[corner] = true;
    std::vector<vec3> corners;
    for (std::size_t i = 0; i < used.size(); ++i)
      if (used[i]) corners.push_back(mesh.positions[i]);
    for (const vec3 corner : corners) {
      bounds_.add(corner);
      radius_ = std::max(radius_, glm::length(corner));
    }
    const std::size_t every = (corners.size() + kTouchPoints - 1) / kTouchPoints;
    for (std::size_t i = 0; i < corners.size(); i += every) touch_points_.push_back(corners[i]);
    volume_ = static_cast<float>(mesh.volume);
    const vec3 extent = bounds_.extent();
    cell_ = std::max({extent.x, extent.y, extent.z}) / kCells;
    low_ = bounds_.low - 2.0f * cell_;
    for (int i = 0; i < 3; ++i) nodes_[i] = static_cast<int>(std::ceil(extent[i] / cell_)) + 5;
    fill();
  }

  NearestSurface nearest(vec3 point) const override {
    float node = 0, way = 0;
    NearestSurface found;
    if (look_up(point, node, way)) {
      if (ask(point, std::abs(node) + way, found)) return found;
    }
    ask(point, std::numeric_limits<float>::infinity(), found);
    return found;
  }

  bool nearest_within(vec3 point, float reach, NearestSurface& found) const override {
    float node = 0, way = 0;
    if (look_up(point, node, way)) {
      if (node - way > reach) return false;
      found = nearest(point);
      return found.distance <= reach;
    }
    const vec3 out = glm::max(glm::max(bounds_.low - point, point - bounds_.high), vec3(0.0f));
    return !(glm::dot(out, out) > reach * reach) && ask(point, reach, found);
  }

 private:
  /// The distance at the node nearest to the point, and the way there; nothing for points off the grid.
  bool look_up(vec3 point, float& node, float& way) const {
    const vec3 at = glm::floor((point - low_) / cell_ + 0.5f);
    if (!(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < static_cast<float>(nodes_.x) &&
          at.y < static_cast<float>(nodes_.y) && at.z < static_cast<float>(nodes_.z)))
      return false;
    way = glm::distance(point, low_ + at * cell_) * 1.0001f + 1e-5f * cell_;
    node = values_[index(glm::ivec3(at))];
    return true;
  }

  std::size_t index(glm::ivec3 i) const {
    return (static_cast<std::size_t>(i.z) * static_cast<std::size_t>(nodes_.y) + static_cast<std::size_t>(i.y)) *
               static_cast<std::size_t>(nodes_.x) +
           static_cast<std::size_t>(i.x);
  }

  bool ask(vec3 point, float limit, NearestSurface& found) const {
    // The search is for what is nearer than its limit.
    return distance_.nearest(point, std::nextafter(limit, std::numeric_limits<float>::infinity()), found);
  }

  void fill() {
    values_.assign(
        static_cast<std::size_t>(nodes_.x) * static_cast<std::size_t>(nodes_.y) * static_cast<std::size_t>(nodes_.z),
        0.0f);
    const auto rows = static_cast<std::size_t>(nodes_.y) * static_cast<std::size_t>(nodes_.z);
    parallel_for(rows, 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        const int y = static_cast<int>(row % static_cast<std::size_t>(nodes_.y));
        const int z = static_cast<int>(row / static_cast<std::size_t>(nodes_.y));
        float limit = std::numeric_limits<float>::infinity();
        for (int x = 0; x < nodes_.x; ++x) {
          const vec3 point = low_ + vec3(x, y, z) * cell_;
          NearestSurface found;
          if (!ask(point, limit, found)) ask(point, std::numeric_limits<float>::infinity(), found);
          values_[index({x, y, z})] = found.distance;
          limit = std::abs(found.distance) + cell_ * 1.01f;
        }
      }
    });
  }

  MeshDistance distance_;
  float cell_ = 0;
  vec3 low_{0.0f};
  glm::ivec3 nodes_{0};
  std::vector<float> values_;  ///< m, at low_ + index * cell_; x fastest
};

}  // namespace

std::unique_ptr<const Shape> make_mesh_shape(const ObstacleShape& shape) { return std::make_unique<MeshShape>(shape); }

}  // namespace meniscus
