#include <cmath>

#include "sim/pbf.h"
#include "sim/sph.h"

namespace meniscus {
namespace {

/// epsilon of the constraint, times h^2: of the order of a particle's own steepness, which is 1 in a cubic lattice.
constexpr float kRelaxation = 0.3f;
/// k of the artificial pressure over h^2: acts on pairs nearer than a third of the smoothing length.
constexpr float kApart = 0.01f;
constexpr float kBlend = 0.05f;         ///< default c of XSPH
constexpr float kStep = 1.0f / 120.0f;  ///< s

}  // namespace

float longest_pbf_step(const FluidOptions& options) {
  // In a step water at rest falls by no more than a twentieth of the smoothing length; twice that does not come to
  // rest.
  const float fall = length(options.gravity);
  return std::min(1.0f / 30.0f, fall > 0 ? std::sqrt(0.1f * options.smoothing_length / fall) : 1.0f);
}

void fill_pbf_defaults(FluidOptions& options) {
  if (options.step == 0) options.step = std::min(kStep, longest_pbf_step(options));
  if (options.viscosity < 0) options.viscosity = kBlend;
  if (options.vorticity < 0) options.vorticity = 0;
}

PbfConstants pbf_constants(const FluidOptions& options) {
  const SphConstants shared = sph_constants(options);
  PbfConstants c{};
  c.h = shared.h;
  c.volume = shared.volume;
  c.per_lattice = shared.per_lattice;
  c.solid = shared.solid;
  c.relaxation = kRelaxation / (c.h * c.h);
  c.apart = kApart * c.h * c.h;
  c.blend = options.viscosity;
  return c;
}

}  // namespace meniscus
