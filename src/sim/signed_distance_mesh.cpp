#include "sim/signed_distance_mesh.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/type_precision.hpp>
#include <numeric>
#include <tuple>

namespace meniscus {
namespace {

using Index = std::uint32_t;
using dvec3 = glm::dvec3;

[[noreturn]] void refuse(std::string problem, std::string expected, std::string found, std::string advice = {}) {
  throw Error(ErrorCode::invalid_argument, {"a mesh cannot be an obstacle: " + problem,
                                            std::move(expected),
                                            std::move(found),
                                            {},
                                            {},
                                            {},
                                            std::move(advice)});
}

std::string place(vec3 p) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z); }

void check(std::span<const vec3> positions, std::span<const Index> corners) {
  if (corners.empty() || corners.size() % 3 != 0)
    refuse("it has no list of triangles", "three corners a triangle", fmt::format("{} corners", corners.size()));
  if (corners.size() / 3 > std::numeric_limits<Index>::max() / 3)
    refuse("it has too many triangles", "fewer than 1.4 billion", fmt::format("{}", corners.size() / 3));
  for (const Index corner : corners)
    if (corner >= positions.size())
      refuse("a corner is not in the list of positions", fmt::format("less than {}", positions.size()),
             fmt::format("{}", corner));
  for (const vec3 p : positions)
    if (!(glm::length(p) <= 1e6f)) refuse("a position is out of range", "within 1e6 m of the origin", place(p));
}

/// For each position, the first of those that have its place.
std::vector<Index> weld(std::span<const vec3> positions) {
  std::vector<Index> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), Index{0});
  const auto key = [&](Index i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z); };
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return std::tuple(key(a), a) < std::tuple(key(b), b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

/// One side of a triangle.
struct Side {
  Index low, high;  ///< corners
  Index triangle;
  std::uint8_t number;
  bool forward;  ///< from low to high
};

/// Gives the triangles their edges; every edge must be walked as often one way as the other.
std::size_t find_edges(ClosedMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(mesh.triangles.size() * 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint8_t i = 0; i < 3; ++i) {
      const Index a = mesh.triangles[t].corners[i], b = mesh.triangles[t].corners[(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<Index>(t), i, a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tuple(a.low, a.high, a.triangle, a.number) < std::tuple(b.low, b.high, b.triangle, b.number);
  });
  std::size_t edges = 0, open = 0, turned = 0;
  const Side* first_open = nullptr;
  const Side* first_turned = nullptr;
  for (std::size_t begin = 0, end; begin < sides.size(); begin = end) {
    std::size_t forward = 0;
    for (end = begin; end < sides.size() && sides[end].low == sides[begin].low && sides[end].high == sides[begin].high;
         ++end) {
      forward += sides[end].forward;
      mesh.triangles[sides[end].triangle].edges[sides[end].number] = static_cast<Index>(edges);
    }
    ++edges;
    if (2 * forward == end - begin) continue;
    if ((end - begin) % 2 == 1) {
      if (open++ == 0) first_open = &sides[begin];
    } else if (turned++ == 0) {
      first_turned = &sides[begin];
    }
  }
  const auto where = [&](const Side& side) {
    return place(mesh.positions[side.low]) + " to " + place(mesh.positions[side.high]);
  };
  if (open > 0)
    refuse("its surface is open", "a closed surface",
           fmt::format("{} open edges, one from {}", open, where(*first_open)),
           "close its holes, or use a box, sphere or cylinder in its place");
  if (turned > 0)
    refuse("neighbouring triangles are not turned alike", "corners counter-clockwise seen from outside",
           fmt::format("{} edges between such, one from {}", turned, where(*first_turned)),
           "make its normals consistent");
  return edges;
}

}  // namespace

ClosedMesh close_mesh(std::span<const vec3> positions, std::span<const Index> corners) {
  check(positions, corners);
  ClosedMesh mesh;
  mesh.positions.assign(positions.begin(), positions.end());
  const std::vector<Index> first = weld(positions);
  double volume = 0;
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    const Index a = first[corners[i]], b = first[corners[i + 1]], c = first[corners[i + 2]];
    if (a == b || b == c || c == a) continue;
    mesh.triangles.push_back({{a, b, c}, {}, {}});
    volume += glm::dot(dvec3(positions[a]), glm::cross(dvec3(positions[b]), dvec3(positions[c]))) / 6;
  }
  if (mesh.triangles.empty()) refuse("none of its triangles has an area", "a closed surface", "points or lines");
  // What is turned inside out as a whole is turned back.
  if (volume < 0)
    for (ClosedMesh::Triangle& triangle : mesh.triangles) std::swap(triangle.corners[1], triangle.corners[2]);
  mesh.volume = std::abs(volume);

  mesh.edge_normals.assign(find_edges(mesh), vec3(0.0f));
  mesh.corner_normals.assign(positions.size(), vec3(0.0f));
  double area = 0;
  for (ClosedMesh::Triangle& triangle : mesh.triangles) {
    std::array<dvec3, 3> p;
    for (int i = 0; i < 3; ++i)
      p[static_cast<std::size_t>(i)] = mesh.positions[triangle.corners[static_cast<std::size_t>(i)]];
    const dvec3 across = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double size = glm::length(across);
    area += size / 2;
    triangle.normal = size > 0 ? vec3(across / size) : vec3(0.0f);
    for (std::size_t i = 0; i < 3; ++i) {
      const dvec3 to_next = glm::normalize(p[(i + 1) % 3] - p[i]), to_last = glm::normalize(p[(i + 2) % 3] - p[i]);
      const double angle = std::acos(glm::clamp(glm::dot(to_next, to_last), -1.0, 1.0));
      mesh.corner_normals[triangle.corners[i]] += triangle.normal * static_cast<float>(angle);
      mesh.edge_normals[triangle.edges[i]] += triangle.normal;
    }
  }
  // A tenth of a millionth of what a ball of this surface holds is flat.
  const double ball = area * std::sqrt(area) / 10.6;
  if (!(mesh.volume > 1e-7 * ball)) refuse("it holds no volume", "a closed surface around a space", "a flat surface");
  return mesh;
}

}  // namespace meniscus
