/// What the stages of the ray-cast surface share: the resolved options and the particles with their masses.
#pragma once

#include "meniscus/surface.h"
#include "particles/band_grid.h"

namespace meniscus {

/// The density field of the particles, relative to the density inside the water:
///   rho(x) = sum_j m_j s_j^3 W(|x - p_j|, h_j)                                              [Xiao2017] eq. 1
/// with the spacing s_j and smoothing length h_j of particle j, which are those of the options for all unless the
/// particles have sizes of their own, so that the iso-value has no units: a lattice of the given spacing has rho = 1.
///
/// Particles of different sizes are kept in levels: this field holds those with the smallest smoothing lengths, each
/// field in `coarser` those of up to twice the ones before, sorted by cells of their own. Sums run over all levels;
/// options, scale and step of a coarser level are those that its largest particle has.
struct RaycastField {
  RaycastOptions options;               ///< checked, every length resolved
  BandGrid grid;                        ///< cells of one smoothing length
  PagedVector<float> mass;              ///< m_j by sorted index, padded like the grid's arrays
  PagedVector<float> entry_radius;      ///< m by sorted index: the sphere outside of which j makes no surface
  std::vector<float> red, green, blue;  ///< linear, by sorted index, padded; empty without colours
  float scale = 0;                      ///< spacing^3 W(0, h): what a unit mass adds to rho at its own place
  float step = 0;                       ///< m, of the march
  /// Of particles with sizes of their own, by sorted index, padded: options.spacing / s_j (which is also R / R_j of the
  /// normals) and options.smoothing_length / h_j; empty where all are alike.
  std::vector<float> per_spacing, per_smoothing;
  std::vector<RaycastField> coarser;  ///< levels of larger particles, ascending; empty where all are alike

  float least_spacing = 0;  ///< m, of the smallest particle of all levels
  float widest_entry = 1;   ///< no entry radius is more, in smoothing lengths of its particle

  bool has_colours() const { return !red.empty(); }
  bool has_sizes() const { return !per_spacing.empty(); }
};

/// Which particles a field keeps, and what its grid knows of its cells.
enum class Keep {
  all,        ///< all cells are open
  all_kinds,  ///< all; cells in the midst of the water are hidden
  band        ///< those of deep cells are left out, if options.cull_interior
};

/// Checks the options, sorts the particles and their colours; masses are one.
/// @param least_spacing  m, of particles of different sizes, whose largest has that of the options; 0: all alike
/// @throws Error invalid_argument
RaycastField make_field(const Particles& particles, const RaycastOptions& options, std::span<const vec3> colours,
                        Keep keep = Keep::all, float least_spacing = 0);

/// W(r, h) of the field's kernel, 1/m^3.
float kernel_value(Kernel kernel, float r, float h);

/// How the mass of a particle follows from rho at its place: 1 from `full_density` up, `lone_mass` at the
/// density `lone_density` of a particle without neighbours, linear between them.
struct MassRule {
  float lone_density = 0;
  float lone_mass = 1;
  float full_density = 0;
};
/// lone_mass makes a lone particle's surface a sphere of its own volume, radius (3 / (4 pi))^(1/3) spacings.
/// full_density is a little less than that in a sheet one particle thick, whose surface unit masses place
/// where it should be, half a spacing from the particles.
MassRule mass_rule(const RaycastOptions& options);
inline float mass_at(const MassRule& rule, float density) {
  const float thin = (rule.full_density - density) / (rule.full_density - rule.lone_density);
  return 1.0f + (rule.lone_mass - 1.0f) * std::clamp(thin, 0.0f, 1.0f);
}

/// Above this density particles count as packed closer than inside the water.
constexpr float kPackedDensity = 1.2f;
/// Radius of the sphere that a ray has to enter before it can meet the surface near a particle, m: one spacing
/// at iso-values from 1/2 up, more below and where particles are packed closer than inside the water.
inline float entry_radius_at(const RaycastOptions& options, float density) {
  const float loose = std::clamp(1.0f + 2.0f * (0.5f - options.iso), 1.0f, 2.0f);
  const float packed = 1.0f + std::clamp((density - kPackedDensity) / 1.8f, 0.0f, 1.0f);
  return std::min(options.spacing * loose * packed, options.smoothing_length);
}

/// Radius of the spheres that thickness is summed from, m; each counts for one particle's volume. At 1.25 spacings
/// those of a lattice add up to an even sheet within a tenth along its axes and diagonals and within a twentieth
/// along other directions; at one spacing they are off by half along the axes.
inline float thickness_radius(const RaycastOptions& options) { return 1.25f * options.spacing; }

/// A value that lies between two lower ones a step away from it on either side: where between them the parabola
/// through the three is highest, and how high.
struct Summit {
  float place;  ///< steps from the middle one, in [-1/2, 1/2]
  float value;
};
inline Summit summit_of(float before, float here, float after) {
  const float fall = 2.0f * here - before - after;  // > 0
  const float place = 0.5f * (after - before) / fall;
  return {place, here + 0.25f * (after - before) * place};
}
/// Of the iso-value: how far below it a parabola's summit may lie for the density to be looked at there. Water thinner
/// than a step is not missed then, and the rims of drops are round.
constexpr float kSummitMargin = 0.25f;

/// Fewer neighbours within the normal radius than this leave the gradient alone to tell the normal.
constexpr int kFewestNeighboursForPca = 5;
/// Below this ratio of the middle to the largest eigenvalue the neighbours form a line, which has no normal.
constexpr float kLeastPcaSpread = 1e-3f;

}  // namespace meniscus
