/// The virtual screen of [Iwasaki2008] 5.1: what of the water the light meets first.
#pragma once

#include "meniscus/surface.h"
#include "shading/caustics_light.h"

namespace meniscus {

/// Points of the water behind the pixels of the virtual screen.
struct VirtualScreen {
  View view;      ///< square pixels
  int width = 0;  ///< points, which need not be the view's pixels
  int height = 0;
  vec2 step{1.0f};   ///< px of the view between neighbouring points
  vec3 up{0, 1, 0};  ///< of the scene, unit
  /// At the points; `coverage` is the part of the point's square that has water. Where the points are the view's pixels
  /// it is counted at the border at places between the points, and a point beside the water shows the water of those.
  SurfaceBuffers seen;
  std::size_t wet = 0;  ///< points with water

  /// The picture point of point (x, y).
  vec2 picture(int x, int y) const {
    return {(static_cast<float>(x) + 0.5f) * step.x, (static_cast<float>(y) + 0.5f) * step.y};
  }
  Ray ray(int x, int y) const { return view.ray(picture(x, y)); }
  bool is_wet(int x, int y) const { return seen.coverage(x, y) > 0; }
  /// The point on the water, m.
  vec3 point(int x, int y) const;
  /// Where the ray of point (x, y) meets the plane through `level` that is horizontal, or faces a screen that stands
  /// upright: where the water of a neighbour would go on.
  vec3 beside(int x, int y, vec3 level) const;
};

/// Looks at the water through a screen that holds `box`, and at its border more closely.
VirtualScreen see_screen(const Surface& surface, const LightSource& light, const Bounds& box, vec3 up,
                         const CausticsOptions& options, StageTimes* times = nullptr);

}  // namespace meniscus
