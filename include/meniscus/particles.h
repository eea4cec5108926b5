/// From raw positions to what a surface needs: neighbours, spacing, attributes as colours.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// What the program takes the particles to be when nobody says otherwise.
struct SpacingEstimate {
  float spacing = 0;      ///< m: edge of the cube of water that one particle stands for; 0 if there is none
  float dimension = 3;    ///< 3 inside a body of water, near 2 for a thin sheet
  std::string reasoning;  ///< one line for the user
};

/// Particle spacing from the volume that particles take up inside the water (from the surroundings of a fixed
/// sample of them), not from nearest neighbours alone: clouds of FLIP solvers clump. Within 15 % for lattices, FLIP
/// seeds, sheets of one or more layers, threads, drops and splashes; docs/spacing.md has the method and the errors.
/// What the file tells (Particles::spacing) is taken if it is within a factor of two of the estimate.
/// Deterministic. One particle or particles in one point: a positive fallback, said in `reasoning`.
SpacingEstimate estimate_spacing(const Particles& particles);

/// The up axis: from the file, else the way that water lies (it stands on a floor, has no ceiling, and is wider than
/// high), else y. `reasoning` says which. For particles of a plane the axis of the two that span it, y first.
struct UpEstimate {
  Axis axis = Axis::y;
  std::string reasoning;
};
UpEstimate estimate_up(const Particles& particles);

/// Bounds without the few particles that have flown far away: what a camera should be fitted to. Left out are at most
/// 0.3 % of the particles on each side, and only those farther from the rest than half of its longest edge; of fewer
/// than 334 particles none. Empty for no particles.
Bounds robust_bounds(const Particles& particles);

/// The particles that have at least `neighbours` others within `radius` m; order and attributes are kept.
/// @throws Error  invalid_argument: radius negative or not finite
Particles without_isolated(const Particles& particles, float radius, int neighbours);

enum class Colormap { viridis, magma, turbo, coolwarm, grey };
/// @throws Error invalid_argument naming the known maps
Colormap colormap_of(std::string_view name);
/// Linear RGB at t, clamped to [0, 1].
vec3 colormap_at(Colormap map, float t);

/// How particles get their colours.
struct ColourBy {
  std::string attribute;  ///< a vector's magnitude is taken, except for colours
  Colormap colormap = Colormap::viridis;
  std::optional<std::pair<float, float>> range;  ///< else that of the values
};

/// One linear colour a particle. An attribute named "color", "colour" or "Cd" of 3 components is taken as
/// linear colours themselves (negative parts and NaN as 0). One value for all is the middle of the map, NaN its lower
/// end.
/// @param range_used  what 0 and 1 of the map stand for
/// @throws Error not_found: no such attribute; the message lists those that there are. invalid_argument: an attribute
///         without a value for every particle
std::vector<vec3> particle_colours(const Particles& particles, const ColourBy& by, std::pair<float, float>& range_used);

}  // namespace meniscus
