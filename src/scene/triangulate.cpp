#include "scene/triangulate.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

/// Longer polygons are taken as convex: looking for ears takes the square of the number of corners at least.
constexpr std::size_t kLongest = 2000;

/// Twice the area of a triangle, signed.
float turn(vec2 a, vec2 b, vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

bool inside(vec2 a, vec2 b, vec2 c, vec2 p) { return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0; }

}  // namespace

void triangulate(std::span<const vec3> points, std::span<const std::uint32_t> polygon,
                 std::vector<std::uint32_t>& corners) {
  const std::size_t count = polygon.size();
  if (count < 3) return;
  const auto fan = [&](std::span<const std::uint32_t> rest) {
    for (std::size_t k = 1; k + 1 < rest.size(); ++k) corners.insert(corners.end(), {rest[0], rest[k], rest[k + 1]});
  };
  if (count == 3 || count > kLongest) return fan(polygon);

  // Newell's normal of the polygon, and the polygon without its longest axis, counter-clockwise.
  vec3 normal{0.0f};
  const vec3 origin = points[polygon[0]];
  for (std::size_t k = 0; k < count; ++k)
    normal += glm::cross(points[polygon[k]] - origin, points[polygon[(k + 1) % count]] - origin);
  const vec3 size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int s = (axis + 1) % 3, t = (axis + 2) % 3;
  std::vector<vec2> flat(count);
  for (std::size_t k = 0; k < count; ++k) {
    const vec3 p = points[polygon[k]] - origin;
    flat[k] = normal[axis] < 0 ? vec2{p[t], p[s]} : vec2{p[s], p[t]};
  }

  std::vector<std::size_t> left(count);
  for (std::size_t k = 0; k < count; ++k) left[k] = k;
  std::size_t at = 0, tried = 0;
  while (left.size() > 3) {
    const std::size_t n = left.size(), before = (at + n - 1) % n, after = (at + 1) % n;
    const vec2 a = flat[left[before]], b = flat[left[at]], c = flat[left[after]];
    bool ear = turn(a, b, c) > 0;
    for (std::size_t k = 0; ear && k < n; ++k) {
      const vec2 p = flat[left[k]];
      if (k != before && k != at && k != after && p != a && p != b && p != c) ear = !inside(a, b, c, p);
    }
    // Where no corner is an ear, the polygon crosses itself or is flat, and any corner is as good.
    if (ear || tried >= n) {
      corners.insert(corners.end(), {polygon[left[before]], polygon[left[at]], polygon[left[after]]});
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
      at %= left.size();
      tried = 0;
    } else {
      at = after;
      ++tried;
    }
  }
  corners.insert(corners.end(), {polygon[left[0]], polygon[left[1]], polygon[left[2]]});
}

}  // namespace meniscus
