/// Normals for meshes that come without.
#pragma once

#include "meniscus/scene.h"

namespace meniscus {

/// Gives every corner whose normal is zero the mean of the faces around its point, weighted by area, as far as they are
/// within the crease angle of its own face; sharper edges stay sharp. Points at the same place count as one. Then
/// corners that agree in everything share a point, and points without triangles are dropped.
/// @param mesh        normals one a position
/// @param cos_crease  cosine of the crease angle
void smooth_normals(Mesh& mesh, float cos_crease);

}  // namespace meniscus
