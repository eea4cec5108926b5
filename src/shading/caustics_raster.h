/// Convex polygons added into an image with the exact area that each covers of each texel.
#pragma once

#include <vector>

#include "meniscus/base.h"

namespace meniscus {

/// A triangle or a quadrangle, in texels; (0, 0) is the upper left corner of the image.
struct LightPolygon {
  vec2 corner[4];
  int corners = 3;
  vec3 flux{0.0f};  ///< of the whole polygon, spread evenly over it
};

/// Twice the signed area, texels^2.
float doubled_area(const LightPolygon& polygon);

/// Adds every polygon's flux to the texels in proportion to the area that it covers of them; what lies beside the image
/// is lost. Polygons of next to no area become lines. Within a texel the sum has the order of the lists, so that the
/// result is the same for any number of threads.
void draw_polygons(const std::vector<std::vector<LightPolygon>>& lists, Image<vec3>& image);

/// The same with polygons of many texels drawn in texels 4, 16 or 64 times as large: their light is thin, and their
/// edges may be soft.
void draw_light(const std::vector<std::vector<LightPolygon>>& lists, Image<vec3>& image);

}  // namespace meniscus
