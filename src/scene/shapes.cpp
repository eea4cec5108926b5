#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "meniscus/scene.h"
#include "scene/direction_map.h"

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

int usable_segments(int segments) {
  if (segments < 3 || segments > 4096)
    throw Error(ErrorCode::invalid_argument, "a round shape needs 3 to 4096 segments");
  return segments;
}

void check_radius(float radius) {
  if (!(radius > 0) || !std::isfinite(radius))
    throw Error(ErrorCode::invalid_argument, "the radius of a shape is not above zero");
}

std::uint32_t add(Mesh& mesh, vec3 position, vec3 normal, vec2 texture_point) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.texture_points.push_back(texture_point);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.corners.insert(mesh.corners.end(), {a, b, c, a, c, d});
}

}  // namespace

Mesh box_mesh(vec3 low, vec3 high) {
  if (!(low.x < high.x && low.y < high.y && low.z < high.z))
    throw Error(ErrorCode::invalid_argument, "a box's lower corner is not below its upper corner");
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      const int s = (axis + 1) % 3, t = (axis + 2) % 3;
      vec3 normal{0.0f};
      normal[axis] = upper ? 1.0f : -1.0f;
      const auto corner = [&](bool along_s, bool along_t) {
        vec3 position;
        position[axis] = upper ? high[axis] : low[axis];
        position[s] = along_s ? high[s] : low[s];
        position[t] = along_t ? high[t] : low[t];
        return add(mesh, position, normal, {along_s ? 1.0f : 0.0f, along_t ? 1.0f : 0.0f});
      };
      const std::uint32_t a = corner(false, false), b = corner(true, false), c = corner(true, true),
                          d = corner(false, true);
      if (upper)
        add_quad(mesh, a, b, c, d);
      else
        add_quad(mesh, a, d, c, b);
    }
  return mesh;
}

Mesh sphere_mesh(vec3 centre, float radius, int segments) {
  segments = usable_segments(segments);
  check_radius(radius);
  // Longitude and latitude; y is the axis. The points of each pole are one a segment, for the texture's sake.
  const int rings = std::max(2, segments / 2);
  Mesh mesh;
  for (int j = 0; j <= rings; ++j)
    for (int i = 0; i <= segments; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(segments);
      const float v = static_cast<float>(j) / static_cast<float>(rings);
      // The first and the last meridian are the same to the last bit, and so are all points of a pole.
      const float phi = 2.0f * kPi * static_cast<float>(i % segments) / static_cast<float>(segments);
      const float sin_theta = j == 0 || j == rings ? 0.0f : std::sin(kPi * v);
      const vec3 normal{sin_theta * std::cos(phi), -std::cos(kPi * v), -sin_theta * std::sin(phi)};
      add(mesh, centre + radius * normal, glm::normalize(normal), {u, v});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (segments + 1) + i); };
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < segments; ++i) {
      if (j > 0) mesh.corners.insert(mesh.corners.end(), {at(i, j), at(i + 1, j), at(i, j + 1)});
      if (j + 1 < rings) mesh.corners.insert(mesh.corners.end(), {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

Mesh cylinder_mesh(vec3 bottom, vec3 top, float radius, int segments) {
  segments = usable_segments(segments);
  check_radius(radius);
  if (!(glm::length(top - bottom) > 0) || !std::isfinite(glm::length(top - bottom)))
    throw Error(ErrorCode::invalid_argument, "the ends of a cylinder are the same point, or not finite");
  const UpFrame frame = up_frame(top - bottom);
  Mesh mesh;
  const auto around = [&](int i) {
    const float phi = 2.0f * kPi * static_cast<float>(i % segments) / static_cast<float>(segments);
    return std::cos(phi) * frame.east + std::sin(phi) * frame.north;
  };
  for (int i = 0; i <= segments; ++i) {
    const float u = static_cast<float>(i) / static_cast<float>(segments);
    add(mesh, bottom + radius * around(i), around(i), {u, 0.0f});
    add(mesh, top + radius * around(i), around(i), {u, 1.0f});
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(segments); ++i)
    add_quad(mesh, 2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
  for (const bool upper : {false, true}) {
    const vec3 normal = upper ? frame.up : -frame.up, end = upper ? top : bottom;
    const std::uint32_t middle = add(mesh, end, normal, {0.5f, 0.5f});
    for (int i = 0; i < segments; ++i) {
      const float phi = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(segments);
      add(mesh, end + radius * around(i), normal, {0.5f + 0.5f * std::cos(phi), 0.5f + 0.5f * std::sin(phi)});
    }
    for (int i = 0; i < segments; ++i) {
      const std::uint32_t a = middle + 1 + static_cast<std::uint32_t>(i);
      const std::uint32_t b = middle + 1 + static_cast<std::uint32_t>((i + 1) % segments);
      if (upper)
        mesh.corners.insert(mesh.corners.end(), {middle, a, b});
      else
        mesh.corners.insert(mesh.corners.end(), {middle, b, a});
    }
  }
  return mesh;
}

}  // namespace meniscus
