// The memory of a ray-cast surface from the number and the box of its particles.
#include <algorithm>
#include <cmath>

#include "meniscus/surface.h"

namespace meniscus {
namespace {

constexpr double kRoughness = 1.3;  ///< area of water with waves and splashes over that of a box
// Bytes, as measured on tanks and crowns of 1 and 5 million particles: what is held lies within 0.7 and 1.2 of it.
constexpr double kBytesKept = 20;       ///< a kept particle: position, mass, radius; its index and colour are not in it
constexpr double kBytesBuilt = 30;      ///< while it is sorted
constexpr double kBytesACell = 13;      ///< start, counts and kind
constexpr double kBytesACellBuilt = 4;  ///< more, while particles are counted
constexpr double kBytesSplatted = 2;    ///< a kept particle, while it is seen: lists of the nearest come and go
constexpr double kBytesAPixel = 44;     ///< depth, normal, thickness, coverage, entry, exit, and what is filtered

/// m^2: of water that lies in a box as in a tank: level, across the shortest side. Walls and floor are surface too.
double area_of(double volume, const Bounds& bounds, double spacing) {
  const vec3 extent = bounds.extent();
  double side[3] = {extent.x + spacing, extent.y + spacing, extent.z + spacing};
  std::sort(side, side + 3);
  const double depth = std::min(volume / (side[1] * side[2]), side[0]);
  return 2 * side[1] * side[2] + 2 * (side[1] + side[2]) * depth;
}

}  // namespace

RaycastEstimate estimate_raycast(std::uint64_t count, const Bounds& bounds, const RaycastOptions& options,
                                 std::uint64_t pixels) {
  RaycastEstimate estimate;
  const double spacing = options.spacing, n = static_cast<double>(count);
  if (!(spacing > 0 && spacing < 1e30))
    throw Error(ErrorCode::invalid_argument, "an estimate of a surface needs the particles' spacing, above 0 m");
  // Cells are a smoothing length wide. Those are kept that sums at the surface reach, the one that the surface runs
  // through, and another until all around are full.
  const double cell = options.smoothing_length > 0 ? options.smoothing_length : 2 * spacing;
  const double normals = options.normal_radius > 0 ? options.normal_radius : 3 * spacing;
  const double band = options.cull_interior ? (std::ceil(std::max(cell, normals) / cell) + 2) * cell
                                            : std::numeric_limits<double>::infinity();
  const double volume = n * spacing * spacing * spacing;
  const double area = bounds.empty() ? 0 : kRoughness * area_of(volume, bounds, spacing);
  const double kept = std::min(n, band * std::max(area, 1e-30) / (spacing * spacing * spacing));
  // A block has 8 cells along an edge, and those at the surface are full of air by half.
  const double block = 8 * cell;
  const double blocks = std::min(n, volume / std::pow(block, 3) + area / (block * block) + (count > 0 ? 1 : 0));
  const double cells = 512 * blocks;
  const auto bytes = [](double b) { return static_cast<std::uint64_t>(std::max(b, 0.0)); };
  estimate.kept_bytes = bytes(kBytesKept * kept + kBytesACell * cells);
  estimate.build_bytes = bytes(kBytesBuilt * kept + (kBytesACell + kBytesACellBuilt) * cells);
  estimate.view_bytes = bytes(kBytesAPixel * static_cast<double>(pixels) + kBytesSplatted * kept);
  estimate.particles = n;
  estimate.kept = kept;
  estimate.pixels = static_cast<double>(pixels);
  return estimate;
}

}  // namespace meniscus
