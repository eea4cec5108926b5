/// How rays go on from the surface: what is common to the methods, and the one that looks into a picture.
#pragma once

#include "shading/image_space.h"
#include "shading/sample.h"

namespace meniscus {

/// @throws Error invalid_argument: an option outside its range, or a method without what it needs
void require_optics(const View& view, const OpticsInputs& optics);

/// Radiance that the picture of the scene shows at a point of the ray that lies there: the mean of the pixels around
/// it which are as far from the eye, else the nearest one.
vec3 radiance_at(const GeometryMap& map, const Image<vec3>& radiance, const ImageSpaceHit& hit);

/// The mean of that over a beam `width` m wide at the hit.
vec3 mean_radiance(const GeometryMap& map, const Image<vec3>& radiance, const ImageSpaceHit& hit, float width);

/// Water seen from the air: one interface; what the refracted and the reflected ray meet is found in the picture of the
/// scene without water, and where it is not in the picture by a ray in the scene.           [Iwasaki2008] 5.2
/// @param picture_point  at which the sample is seen, px
vec3 image_space_radiance(const Sample& sample, vec2 picture_point, const GeometryMap& map, const Image<vec3>& picture,
                          const OpticsOptions& options, const Scene& scene, const Material& material);

/// Water that stands against a wall of a tank has a flat side there, however rough its particles are: where the surface
/// is within about a spacing of the wall and looks at it, its normal becomes that of the wall and the point moves along
/// the ray onto the wall. Changes neither without a tank or where the spacing is not known (0).
/// @param outwards  normal out of the water
void flatten_at_walls(const Tank& tank, float spacing, const Ray& ray, float& distance, vec3& outwards);

}  // namespace meniscus
