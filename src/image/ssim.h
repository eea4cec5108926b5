#pragma once

#include "meniscus/image.h"

namespace meniscus {

/// Mean structural similarity [Wang2004] of the BT.709 luma of two pictures of one size, in [-1, 1]; 1 for
/// empty ones. Windows of 11 x 11 weighted by a Gaussian of sigma 1.5, K1 = 0.01, K2 = 0.03, L = 255; only
/// windows that lie wholly inside count. Along a side shorter than 11 the window is as long as the side.
double mean_ssim(const Image<Rgb8>& a, const Image<Rgb8>& b);

}  // namespace meniscus
