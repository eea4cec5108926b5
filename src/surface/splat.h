/// Spheres drawn into a picture: where rays first and last meet one, and how much of them rays run through.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Spheres by their centres and radii, world space, m; structure of arrays of one length.
struct Spheres {
  std::span<const float> x, y, z;
  std::span<const float> radius;  ///< one a sphere, or one for all
};

/// For every pixel centre the least distance at which its ray enters a sphere (0 if it starts inside of one)
/// and the largest at which it leaves one; +infinity and -infinity where it meets none.
void splat_depth(const View& view, const Spheres& spheres, Image<float>& entry, Image<float>& exit);

/// For every `stride`-th pixel in both directions (at the centre of each block of stride x stride pixels) the
/// summed length of its ray inside the spheres, times `weight`; ceil(width / stride) x ceil(height / stride).
/// The sum runs in the order of the spheres, whatever the number of threads.
Image<float> splat_chords(const View& view, const Spheres& spheres, float weight, int stride);

}  // namespace meniscus
