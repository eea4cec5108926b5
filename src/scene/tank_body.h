/// A tank as rays and light meet it.
#pragma once

#include <array>

#include "meniscus/scene.h"

namespace meniscus {

/// Everything is analytic: a handful of planes and bars.
///
/// tiled: a floor and four walls that are seen from the inside only, and a flat rim around the upper edge that is seen
/// from above only. Light does not pass floor and walls, from whichever side: it comes in over the rim.
/// glass: twelve bars along the edges that rays meet, and four panes that they pass.
class TankBody {
 public:
  /// Width of the joints in tiles.
  static constexpr float kJoint = 0.05f;
  /// What is seen of the edges of glass panes: light that was led there, greenish.
  static constexpr vec3 kEdgeColour{0.62f, 0.80f, 0.74f};
  static constexpr float kEdgeRoughness = 0.1f;
  static constexpr float kGlass = 1.5f;  ///< index of refraction

  /// @throws Error invalid_argument: no space inside, an up direction that is no axis, sizes or colours out of range
  explicit TankBody(const Tank& tank);

  /// With walls and bars.
  Bounds bounds() const { return outside_; }
  /// The first part of the tank between `from` and `limit` m along the ray.
  SolidHit hit(const Ray& ray, Beam beam, float from, float limit) const;
  /// Whether a point at the height of the ground is over the space of a tiled tank that is sunk into it.
  bool opens_ground(vec3 point) const;
  /// What is left of light along a ray of this length.
  vec3 light_transmittance(const Ray& ray, float length) const;
  /// Whether a wall or the floor of a tiled tank keeps light from coming along the ray, `from` to `limit` m from its
  /// origin. Water bulges a little beyond the walls: there is no light for it either.
  bool keeps_light_out(const Ray& ray, float from, float limit) const;

  /// A pane that a ray crosses.
  struct Pane {
    float distance;
    vec3 normal;         ///< unit, towards the ray's origin
    float reflectance;   ///< of both faces together
    vec3 transmittance;  ///< of light that goes straight through
  };
  struct Panes {
    std::array<Pane, 4> panes;
    int count = 0;
  };
  /// The panes before `limit` m along the ray, the nearest first.
  Panes panes(const Ray& ray, float limit) const;
  /// A pane at this angle, wherever it is.
  Pane pane(float cos_in) const;

  /// The parts, for those who meet them with many rays at once.
  const Tank& tank() const { return tank_; }
  vec3 tile() const { return tile_; }
  const std::array<Bounds, 12>& bars() const { return bars_; }
  int up() const { return up_; }
  int side() const { return side_; }
  int other() const { return other_; }
  /// Planes are this much larger than they are, m, so that no ray slips through a corner.
  float overlap() const { return overlap_; }
  /// How far water may bulge beyond a wall, m.
  float bulge() const { return bulge_; }

 private:
  SolidHit tiled_hit(const Ray& ray, Beam beam, float from, float limit) const;
  SolidHit bar_hit(const Ray& ray, float from, float limit) const;
  vec3 tiles(vec3 point, int axis, const Ray& ray, float width) const;

  Tank tank_;
  Bounds outside_;
  vec3 tile_{1.0f};  ///< edges of the tiles along the axes, m: whole tiles on every wall
  std::array<Bounds, 12> bars_;
  int up_ = 1, side_ = 2, other_ = 0;  ///< axes
  float overlap_ = 0, bulge_ = 0;      ///< m
};

}  // namespace meniscus
