/// The density field behind point-sampled surfaces.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// The particles sorted, with their masses.
/// @param cull  leave the masses of particles deep inside the water at one without looking
/// @throws Error invalid_argument
RaycastField make_density_field(const Particles& particles, const DensityOptions& options, bool cull,
                                std::span<const vec3> colours = {}, StageTimes* times = nullptr);

}  // namespace meniscus
