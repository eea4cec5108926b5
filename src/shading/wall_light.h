/// The sun mirrored by the water onto the walls around it and what stands out of it.       [Cords2008] fig. 9 c
#pragma once

#include "shading/caustics_plane.h"

namespace meniscus {

/// Maps of the four upright planes at the borders of a field, in which the beams that the water mirrors end. What does
/// not stand in such a plane gets the light that would go on to it, by the mirrored beam of still water.
class WallLight {
 public:
  /// @param lit   of sunlit()
  /// @param top   m along up that the maps reach
  /// @param size  texels along the longer side of the field
  WallLight(const HeightField& field, std::shared_ptr<const WaterLevel> level, const EnteringLight& light,
            const Image<float>& lit, FirstSolids solids, float top, int size);
  /// Irradiance of mirrored light on a surface with this normal; none under water.
  vec3 irradiance(vec3 point, vec3 normal) const;

  /// One of the planes: its inside looks along +a, -a, +b, -b.
  struct Wall {
    int along = 0, across = 0;  ///< components of a vec3: in the plane, and through it
    float place = 0;            ///< m of the plane
    float inwards = 1;          ///< sign of the normal that looks into the field
    vec2 low{0.0f};             ///< m along the wall and up, of the centre of the first texel
    float texel = 1;            ///< m
    Image<float> value;         ///< irradiance on the plane over that of the sun on what faces it; empty: none
    float at(vec2 place) const;
  };
  const Wall* walls() const { return walls_; }

 private:
  float on_wall(const Wall& wall, vec3 point) const;
  std::shared_ptr<const WaterLevel> level_;
  EnteringLight light_;
  FirstSolids solids_;
  float top_;
  Wall walls_[4];
};

}  // namespace meniscus
