/// Virtual eyes against the ray-traced reference.                                            [Cords2008] fig. 13
#pragma once

#include "json.h"
#include "parse.h"

namespace meniscus::apps {

/// An object that stands through planar and through curved water in a pool.
/// @param frames  pictures that the median of the times is taken of
/// @return  [{case, virtual_eye_ms, ray_traced_ms, ratio, psnr_db, ssim, ...}] for "planar" and "curved"
Json virtual_eye_cases(PictureSize size, int bounces, int frames);

}  // namespace meniscus::apps
