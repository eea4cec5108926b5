/// What caustics() takes.
#pragma once

#include "meniscus/shading.h"

namespace meniscus {

/// @throws Error invalid_argument: an option outside its range
void require_caustics(const CausticsOptions& options);

}  // namespace meniscus
