#include "shading/water_object_shape.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace meniscus {
namespace {

/// A turned box must be this much smaller than the upright one.
constexpr float kWorthTurning = 0.8f;

float cross(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }

float distance_to_edge(vec2 point, vec2 a, vec2 b) {
  const vec2 side = b - a;
  const float square = glm::dot(side, side);
  const float t = square > 0 ? std::clamp(glm::dot(point - a, side) / square, 0.0f, 1.0f) : 0.0f;
  return glm::length(point - a - t * side);
}

/// Whether a line along an edge of `one` separates both.
bool separated(std::span<const vec2> one, std::span<const vec2> other) {
  for (std::size_t i = 0; i < one.size(); ++i) {
    const vec2 a = one[i], side = one[(i + 1) % one.size()] - a;
    if (std::all_of(other.begin(), other.end(), [&](vec2 p) { return cross(side, p - a) < 0; })) return true;
  }
  return false;
}

OrientedBox box_along(std::span<const vec3> points, const std::array<vec3, 3>& axes) {
  vec3 low{std::numeric_limits<float>::infinity()}, high = -low;
  for (const vec3 p : points) {
    const vec3 at{glm::dot(p, axes[0]), glm::dot(p, axes[1]), glm::dot(p, axes[2])};
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  OrientedBox box;
  const vec3 middle = 0.5f * (low + high), half = 0.5f * (high - low);
  for (int k = 0; k < 3; ++k) {
    box.centre += middle[k] * axes[static_cast<std::size_t>(k)];
    box.half_axes[static_cast<std::size_t>(k)] = half[k] * axes[static_cast<std::size_t>(k)];
  }
  return box;
}

float volume(const OrientedBox& box) {
  // Flat boxes are compared by their larger faces.
  float product = 1, longest = 0;
  for (const vec3& half : box.half_axes) longest = std::max(longest, glm::length(half));
  for (const vec3& half : box.half_axes) product *= std::max(glm::length(half), 1e-3f * longest);
  return product;
}

/// Principal axes of the triangles' area.
std::array<vec3, 3> principal_axes(std::span<const vec3> triangles) {
  glm::dvec3 sum{0.0};
  double area = 0;
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const glm::dvec3 a(triangles[i]), b(triangles[i + 1]), c(triangles[i + 2]);
    const double size = glm::length(glm::cross(b - a, c - a));
    sum += size / 3 * (a + b + c);
    area += size;
  }
  if (!(area > 0)) return {vec3{1, 0, 0}, vec3{0, 1, 0}, vec3{0, 0, 1}};
  const glm::dvec3 mean = sum / area;
  // The mean of x x^T over a triangle is that over its corners and three times its middle, over twelve of each.
  glm::dmat3 spread(0.0);
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const glm::dvec3 a = glm::dvec3(triangles[i]) - mean, b = glm::dvec3(triangles[i + 1]) - mean,
                     c = glm::dvec3(triangles[i + 2]) - mean, s = a + b + c;
    const double size = glm::length(glm::cross(b - a, c - a)) / 12;
    spread +=
        size * (glm::outerProduct(a, a) + glm::outerProduct(b, b) + glm::outerProduct(c, c) + glm::outerProduct(s, s));
  }
  // Jacobi's rotations.
  glm::dmat3 axes(1.0);
  for (int sweep = 0; sweep < 24; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (std::abs(spread[p][q]) < 1e-300) continue;
        const double theta = 0.5 * std::atan2(2 * spread[p][q], spread[q][q] - spread[p][p]);
        glm::dmat3 turn(1.0);
        turn[p][p] = turn[q][q] = std::cos(theta);
        turn[p][q] = -std::sin(theta);
        turn[q][p] = std::sin(theta);
        spread = glm::transpose(turn) * spread * turn;
        axes = axes * turn;
      }
  return {vec3(glm::normalize(axes[0])), vec3(glm::normalize(axes[1])), vec3(glm::normalize(axes[2]))};
}

}  // namespace

std::vector<vec3> world_triangles(const PlacedSolid& placed) {
  const Mesh& mesh = placed.solid->mesh();
  std::vector<vec3> points;
  points.reserve(mesh.corners.size());
  for (const std::uint32_t corner : mesh.corners)
    points.emplace_back(placed.world_from_solid * glm::vec4(mesh.positions[corner], 1.0f));
  return points;
}

vec2 horizontal(vec3 point, Axis up) {
  return up == Axis::x ? vec2{point.y, point.z} : up == Axis::y ? vec2{point.x, point.z} : vec2{point.x, point.y};
}

vec3 raised(vec2 place, float level, Axis up) {
  return up == Axis::x   ? vec3{level, place.x, place.y}
         : up == Axis::y ? vec3{place.x, level, place.y}
                         : vec3{place.x, place.y, level};
}

std::vector<vec2> convex_hull(std::vector<vec2> points) {
  std::sort(points.begin(), points.end(), [](vec2 a, vec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<vec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = hull.size();
    for (const vec2 p : points) {
      while (hull.size() >= start + 2 && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

float distance_between(std::span<const vec2> one, std::span<const vec2> other) {
  float nearest = std::numeric_limits<float>::infinity();
  for (int turn = 0; turn < 2; ++turn) {
    for (const vec2 p : one)
      for (std::size_t i = 0; i < other.size(); ++i)
        nearest = std::min(nearest, distance_to_edge(p, other[i], other[(i + 1) % other.size()]));
    std::swap(one, other);
  }
  if (one.size() < 3 || other.size() < 3) return nearest;
  return separated(one, other) || separated(other, one) ? nearest : 0.0f;
}

std::vector<vec2> grown_outline(std::span<const vec2> outline, float margin) {
  vec2 centre{0.0f};
  for (const vec2 p : outline) centre += p / static_cast<float>(outline.size());
  std::vector<vec2> grown;
  for (const vec2 p : outline) {
    const float length = glm::length(p - centre);
    grown.push_back(length > 0 ? p + margin / length * (p - centre) : p);
  }
  return grown;
}

std::vector<vec2> slab_places(std::span<const vec3> triangles, Axis up, float low, float high) {
  const vec3 upwards = direction_of(up);
  std::vector<vec2> places;
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3 a = triangles[i + k], b = triangles[i + (k + 1) % 3];
      const float at_a = glm::dot(a, upwards), at_b = glm::dot(b, upwards);
      if (at_a >= low && at_a <= high) places.push_back(horizontal(a, up));
      for (const float level : {low, high})
        if ((at_a - level) * (at_b - level) < 0)
          places.push_back(horizontal(glm::mix(a, b, (level - at_a) / (at_b - at_a)), up));
    }
  return places;
}

OrientedBox oriented_box(std::span<const vec3> triangles, vec3 up) {
  const std::array<vec3, 3> world{vec3{1, 0, 0}, vec3{0, 1, 0}, vec3{0, 0, 1}};
  OrientedBox box = box_along(triangles, world);
  const OrientedBox turned = box_along(triangles, principal_axes(triangles));
  if (volume(turned) < kWorthTurning * volume(box)) box = turned;
  const auto height = [&](const vec3& half) { return std::abs(glm::dot(half, up)); };
  std::sort(box.half_axes.begin(), box.half_axes.end(),
            [&](const vec3& a, const vec3& b) { return height(a) > height(b); });
  return box;
}

}  // namespace meniscus
