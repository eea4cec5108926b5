/// A closed surface of triangles with the normals of its faces, edges and corners.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

/// Corners of one place are one vertex, triangles without a third corner are gone, normals point outwards.
struct ClosedMesh {
  struct Triangle {
    std::array<std::uint32_t, 3> corners;
    std::array<std::uint32_t, 3> edges;  ///< edge i goes from corner i to the next
    vec3 normal;                         ///< unit; zero for a triangle without area
  };
  std::vector<vec3> positions;
  std::vector<Triangle> triangles;
  /// Sums over the triangles that meet there, of corners weighted by their angles: whether a point whose nearest
  /// surface point is this edge or corner is inside, is told by its side of this normal.  [Baerentzen2005]
  std::vector<vec3> corner_normals, edge_normals;
  double volume = 0;  ///< m^3, > 0
};

/// @throws Error  invalid_argument: no triangles, indices out of range, coordinates that are not finite; open edges or
///                triangles turned against their neighbours, with the place of the first; no volume
ClosedMesh close_mesh(std::span<const vec3> positions, std::span<const std::uint32_t> corners);

}  // namespace meniscus
