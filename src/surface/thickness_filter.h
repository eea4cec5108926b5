/// Smoothing of the thickness map.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Takes the ripple of rows of particles out of a thickness map, which refraction would show as moire: a Gaussian
/// along rows, then along columns, whose weights fade where the thickness differs by more than a fifth and a spacing
/// (the outline of a drop before a deeper body).
/// @param sigma    px; none below half a pixel
/// @param spacing  m
Image<float> smoothed_thickness(const Image<float>& thickness, float sigma, float spacing);

/// A Gaussian along rows, then along columns; beyond the border the picture goes on as within the reach of the weights.
/// @param sigma  px; none below a fifth of a pixel
Image<float> blurred(const Image<float>& picture, float sigma);

}  // namespace meniscus
