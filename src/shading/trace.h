/// Rays followed through the water: out at its far side, totally reflected, into the next sheet or drop.
#pragma once

#include <span>
#include <vector>

#include "shading/sample.h"

namespace meniscus {

struct TraceInputs {
  const Surface* surface = nullptr;  ///< one that can be marched
  const Scene* scene = nullptr;
  int bounces = 8;            ///< interfaces in one path at most
  bool eye_in_water = false;  ///< the samples are seen from inside
};

/// Radiance of each sample. At every interface the path splits into the refracted and the reflected one; Fresnel's
/// weights add up to one, so that under even light clear water is not seen. A path whose weight is small, or which has
/// met its last interface, ends in what the scene shows along its direction: no light is lost.
/// @param materials  one a sample
std::vector<vec3> traced_radiance(std::span<const Sample> samples, std::span<const Material> materials,
                                  const TraceInputs& inputs);

}  // namespace meniscus
