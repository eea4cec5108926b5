/// Surfels of a whole field.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// The options with every length resolved.
/// @throws Error invalid_argument
SurfelOptions resolved(const SurfelOptions& options);
DensityOptions density_options_of(const SurfelOptions& options);

/// @param options  resolved
std::vector<Surfel> extract_surfels(const RaycastField& field, const SurfelOptions& options, StageTimes* times);

}  // namespace meniscus
