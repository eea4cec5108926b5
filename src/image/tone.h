/// The tone curve with its exposure taken apart.
#pragma once

#include "meniscus/image.h"

namespace meniscus {

/// tone_mapped(); @param factor  of the radiance: 2 to the power of the exposure
vec3 tone_mapped(vec3 radiance, float factor, ToneCurve curve);

}  // namespace meniscus
