#include <cmath>

#include "meniscus/formulas/kernels.h"
#include "sim/sph.h"

namespace meniscus {
namespace {

/// Of the step: how far sound goes in it, in smoothing lengths.
constexpr float kCourant = 0.5f;
/// Depth of water, in spacings, that the default step keeps from being pressed together by more than a tenth.
constexpr float kDepth_rel = 20.0f;
constexpr float kMostPressed = 0.1f;
/// The default viscosity: mu = rho_0 h c times this.
constexpr float kViscosity = 0.02f;
/// Surface tension of water at 20 degrees Celsius, N/m.
constexpr float kWaterTension = 0.0728f;
constexpr float kCordsStep = 0.003f;  ///< s [Cords2008] 4

/// Speed of sound at which gravity presses water kDepth_rel spacings deep together by kMostPressed; m/s.
float wanted_sound(const FluidOptions& options) {
  return std::sqrt(length(options.gravity) * kDepth_rel * options.spacing / kMostPressed);
}

}  // namespace

float longest_sph_step(const FluidOptions& options) {
  const float h = options.smoothing_length;
  // Sound, then diffusion of speed (15 / h^2 is the sum of the kernel's laplacian), then capillary waves of length h.
  float step = kCourant * h / std::sqrt(options.stiffness);
  if (options.viscosity > 0) step = std::min(step, 0.5f * h * h * options.rest_density / (15.0f * options.viscosity));
  if (options.surface_tension > 0)
    step = std::min(step, 0.4f * std::sqrt(options.rest_density * h * h * h / (6.2831853f * options.surface_tension)));
  return step;
}

void fill_sph_defaults(FluidOptions& options) {
  const float h = options.smoothing_length;
  const float wanted = wanted_sound(options);
  const bool step_given = options.step > 0;
  if (!step_given) {
    options.step = kCordsStep;
    const float sound = options.stiffness > 0 ? std::sqrt(options.stiffness) : wanted;
    if (sound > 0) options.step = std::min(options.step, kCourant * h / sound);
  }
  if (options.stiffness == 0) {
    const float sound = kCourant * h / options.step;
    options.stiffness = sound * sound;
  }
  if (options.viscosity < 0) {
    const float sound = std::sqrt(options.stiffness);
    options.viscosity = kViscosity * options.rest_density * h * (wanted > 0 ? std::min(sound, wanted) : sound);
  }
  if (options.surface_tension < 0) options.surface_tension = kWaterTension;
  if (!step_given) options.step = std::min(options.step, longest_sph_step(options));
}

SphConstants sph_constants(const FluidOptions& options) {
  SphConstants c{};
  c.h = options.smoothing_length;
  c.volume = options.spacing * options.spacing * options.spacing;
  // A cubic lattice has rest density.
  const int reach = static_cast<int>(c.h / options.spacing) + 1;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -reach; k <= reach; ++k)
        sum += formulas::spiky(options.spacing * std::sqrt(static_cast<float>(i * i + j * j + k * k)), c.h);
  c.per_lattice = static_cast<float>(1.0 / sum);
  c.solid = c.per_lattice / c.volume;
  c.stiffness = options.stiffness;
  c.kinematic = options.viscosity / options.rest_density;
  c.tension = options.surface_tension / options.rest_density;
  return c;
}

}  // namespace meniscus
