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
/// sample of them), not from nearest neighbours alone: clouds of FLIP solvers clump.
/// Deterministic. One particle or particles in one point: a positive fallback, said in `reasoning`.
SpacingEstimate estimate_spacing(const Particles& particles);

/// The up axis: from the file, else from the shape of the bounds, else y. `reasoning` says which.
struct UpEstimate {
  Axis axis = Axis::y;
  std::string reasoning;
};
UpEstimate estimate_up(const Particles& particles);

/// Bounds without the few particles that have flown far away: what a camera should be fitted to.
Bounds robust_bounds(const Particles& particles);

/// The particles that have at least `neighbours` others within `radius` m; order and attributes are kept.
Particles without_isolated(const Particles& particles, float radius, int neighbours);

enum class Colormap { viridis, magma, turbo, coolwarm, grey };
/// @throws Error invalid_argument naming the known maps
Colormap colormap_of(std::string_view name);
/// Linear RGB at t, clamped to [0, 1].
vec3 colormap_at(Colormap map, float t);

/// How particles get their colours.
struct ColourBy {
  std::string attribute;                         ///< a vector's magnitude is taken, except for colours
  Colormap colormap = Colormap::viridis;
  std::optional<std::pair<float, float>> range;  ///< else that of the values
};

/// One linear colour a particle. An attribute named "color", "colour" or "Cd" of 3 components is taken as
/// linear colours themselves.
/// @param range_used  what 0 and 1 of the map stand for
/// @throws Error not_found: no such attribute; the message lists those that there are
std::vector<vec3> particle_colours(const Particles& particles, const ColourBy& by, std::pair<float, float>& range_used);

}  // namespace meniscus
