/// The guesses one by one, as settings_of() takes them and guesses_of() tells them.
#pragma once

#include <algorithm>

#include "meniscus/render.h"

namespace meniscus {

/// Fewer particles than this are a few drops, which stand on no floor.
constexpr std::size_t kFewParticles = 64;

/// The largest coordinate.
inline float longest_of(vec3 v) { return std::max({v.x, v.y, v.z}); }

std::string material_name(const PictureOptions& options);
/// m; positive even without particles.
float spacing_of(const Survey& survey, const PictureOptions& options);
/// m: the depth over which water is seen to be tinted: the shortest edge of the bounds, ten spacings at least.
float depth_scale(const Survey& survey, const PictureOptions& options);
/// m along the up axis: a quarter of a spacing above the lowest particles, which hides the rounded lower edge that
/// the surface of a body of particles has where the floor was.
float ground_height(const Survey& survey, const PictureOptions& options);
/// Azimuth and elevation: behind the water to the right of the camera, so that waves glitter and shade.
vec2 sun_deg(const Survey& survey, const PictureOptions& options);

}  // namespace meniscus
