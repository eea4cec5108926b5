/// The buffers themselves as pictures.
#pragma once

#include "meniscus/render.h"

namespace meniscus {

/// Display-linear colours in [0, 1] of what `show` names, over white where there is no water.
/// @throws Error invalid_argument: Show::water, which is not a buffer
Image<vec3> shown(Show show, const View& view, const SurfaceBuffers& buffers);

}  // namespace meniscus
