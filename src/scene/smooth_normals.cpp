#include "scene/smooth_normals.h"

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <numeric>
#include <unordered_map>

namespace meniscus {
namespace {

/// Points with more faces than this around them take the mean of all: comparing all pairs would take too long.
constexpr std::size_t kMostFaces = 512;

/// A number for every place, the same for points at the same place.
std::vector<std::uint32_t> places(const std::vector<vec3>& positions, std::uint32_t& count) {
  std::vector<std::uint32_t> order(positions.size()), place(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const vec3 p = positions[a], q = positions[b];
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z != q.z ? p.z < q.z : a < b;
  });
  count = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && positions[order[i]] != positions[order[i - 1]]) ++count;
    place[order[i]] = count;
  }
  ++count;
  return place;
}

struct Corner {
  std::uint32_t place;
  vec3 normal;
  vec2 texture_point;
  bool operator==(const Corner&) const = default;
};

struct HashCorner {
  std::size_t operator()(const Corner& corner) const {
    std::uint32_t words[6];
    std::memcpy(words, &corner, sizeof words);
    std::size_t hash = 0xCBF29CE484222325u;
    for (const std::uint32_t word : words) hash = (hash ^ word) * 0x100000001B3u;
    return hash ^ (hash >> 29);
  }
};

}  // namespace

void smooth_normals(Mesh& mesh, float cos_crease) {
  std::uint32_t place_count = 0;
  const std::vector<std::uint32_t> place = places(mesh.positions, place_count);
  const std::size_t triangles = mesh.corners.size() / 3;

  // The faces, and which of them are around every place.
  std::vector<vec3> across(triangles);  // as long as twice the area
  std::vector<std::size_t> first(place_count + 1, 0);
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::uint32_t* corner = mesh.corners.data() + 3 * t;
    const vec3 a = mesh.positions[corner[0]];
    across[t] = glm::cross(mesh.positions[corner[1]] - a, mesh.positions[corner[2]] - a);
    for (int k = 0; k < 3; ++k) ++first[place[corner[k]] + 1];
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> around(mesh.corners.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t c = 0; c < mesh.corners.size(); ++c)
    around[next[place[mesh.corners[c]]]++] = static_cast<std::uint32_t>(c / 3);

  Mesh joined;
  std::unordered_map<Corner, std::uint32_t, HashCorner> known;
  known.reserve(mesh.positions.size());
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    const std::uint32_t point = mesh.corners[c];
    Corner corner{place[point], mesh.normals[point], vec2{0.0f}};
    if (!mesh.texture_points.empty()) corner.texture_point = mesh.texture_points[point];
    if (corner.normal == vec3{0.0f}) {
      const vec3 own = glm::normalize(across[c / 3]);
      const std::size_t begin = first[corner.place], end = first[corner.place + 1];
      vec3 sum{0.0f};
      for (std::size_t i = begin; i < end; ++i) {
        const vec3 other = across[around[i]];
        if (end - begin > kMostFaces || glm::dot(own, other) >= cos_crease * glm::length(other)) sum += other;
      }
      const float length = glm::length(sum);
      corner.normal = length > 0 ? sum / length : own;
    }
    const auto [entry, is_new] = known.try_emplace(corner, static_cast<std::uint32_t>(joined.positions.size()));
    if (is_new) {
      joined.positions.push_back(mesh.positions[point]);
      joined.normals.push_back(corner.normal);
      if (!mesh.texture_points.empty()) joined.texture_points.push_back(corner.texture_point);
    }
    mesh.corners[c] = entry->second;
  }
  mesh.positions = std::move(joined.positions);
  mesh.normals = std::move(joined.normals);
  mesh.texture_points = std::move(joined.texture_points);
}

}  // namespace meniscus
