/// The mesh of a body, from its file or by the name of its shape.
#pragma once

#include "meniscus/render.h"

namespace meniscus {

/// @throws Error  as read_mesh(); invalid_argument: an unknown shape
Mesh mesh_of(const BodyOptions& body);

}  // namespace meniscus
