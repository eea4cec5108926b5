/// The sun's light through water that is nearly a plane, and what stands in its way.
#pragma once

#include "meniscus/scene.h"
#include "meniscus/shading.h"
#include "shading/caustics_level.h"

namespace meniscus {

/// The sun's light as still water at the mean level bends and mirrors it.
struct EnteringLight {
  vec3 sun{0, 1, 0};          ///< unit, towards it
  vec3 strength{0.0f};        ///< irradiance on a surface that faces it
  float ior = 1.333f;         ///< of the water
  float specular = 1;         ///< factor of Fresnel's reflectance
  vec3 bent{0, -1, 0};        ///< unit, in the water
  vec3 mirrored{0, 1, 0};     ///< unit, away from the water
  float cos_sun = 1;          ///< of the sun with the vertical, > 0
  float cos_bent = 1;         ///< of the bent light with it
  float transmittance = 1;    ///< of the interface
  vec2 bent_slide{0.0f};      ///< m along a and b that the bent light goes for each metre down
  vec2 mirrored_slide{0.0f};  ///< and the mirrored one for each metre up
  vec2 sun_slide{0.0f};       ///< towards the sun, for each metre up

  /// Reflectance of the water where the light meets it at this cosine.
  float reflectance(float cosine) const;
};
EnteringLight entering_light(const FieldFrame& frame, vec3 sun, vec3 strength, const Material& material);

/// Which points of a field the sun reaches: 1, or 0 behind a solid. Empty: it reaches all.
Image<float> sunlit(const HeightField& field, const WaterLevel& level, const Scene& scene, vec3 sun);

/// Where light that leaves the mean level in one direction first meets a solid.
class FirstSolids {
 public:
  FirstSolids() = default;
  /// @param direction  unit, down into the water or up from it
  FirstSolids(const WaterLevel& level, const Scene& scene, vec3 direction);
  /// The part of a point's light that no solid holds back.
  /// @param place   where the light of the point leaves the level, m along a and b
  /// @param length  m from there to the point
  /// @param normal  unit, of the lit surface
  float passes(vec2 place, float length, vec3 normal) const;
  bool empty() const { return distance_.empty(); }

 private:
  vec3 direction_{0.0f};
  vec2 low_{0.0f};
  float step_ = 1;         ///< m
  Image<float> distance_;  ///< m along the direction
};

/// A plane of values that are looked up where still water lets the light of a point in.
struct PlaneMap {
  vec2 low{0.0f};      ///< m along a and b, of the centre of the first texel
  vec2 texel{1.0f};    ///< m
  Image<float> value;  ///< irradiance in units of that of still water

  /// Linear between texels; 0 beside the map.
  float at(vec2 place) const;
};

/// What the sun's light is under and beside the water, from a plane map.
class PlaneCaustics {
 public:
  PlaneCaustics(std::shared_ptr<const WaterLevel> level, const EnteringLight& light, const Material& material,
                PlaneMap pattern, FirstSolids solids);
  WaterLight::Light at(vec3 point, vec3 normal) const;
  const PlaneMap& pattern() const { return pattern_; }

 private:
  std::shared_ptr<const WaterLevel> level_;
  EnteringLight light_;
  vec3 extinction_, sky_extinction_;
  float soft_;  ///< m over which the waterline goes over from light above it to light under it
  float deep_;  ///< m of water that cover the sky
  PlaneMap pattern_;
  FirstSolids solids_;
};

}  // namespace meniscus
