/// The rays of a view's picture points, many at once.
#pragma once

#include "scene/ray_block.h"

namespace meniscus {

/// Picture points of a block, px; padded as its rays are.
struct BlockPixels {
  alignas(64) float x[RayBlock::kRays];
  alignas(64) float y[RayBlock::kRays];
};

/// View::ray() of 1 .. RayBlock::kRays points, to rounding. Points beyond `count` are filled in.
void view_rays(const View& view, BlockPixels& pixels, int count, RayBlock& rays);

}  // namespace meniscus
