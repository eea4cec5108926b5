/// Virtual eyes against the ray-traced reference.                                            [Cords2008] fig. 13
#pragma once

#include "json.h"
#include "parse.h"

namespace meniscus::apps {

/// An object that stands through planar and through curved water in a pool.
/// @param frames  pictures that the median of the times is taken of
/// @return  [{case, virtual_eye_ms, virtual_eye_psnr_db, virtual_eye_ssim, ray_traced_ms, ratio, ...}] for "planar" and
///          "curved"; the same as published (lookups by direction) and with each point from its own eye
Json virtual_eye_cases(PictureSize size, int bounces, int frames);

}  // namespace meniscus::apps
