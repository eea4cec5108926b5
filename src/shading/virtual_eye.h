/// Maps of what stands in and around the water, drawn from virtual eyes.                  [Cords2008] 2.1 to 2.3
#pragma once

#include "shading/sample.h"
#include "shading/trapezium.h"
#include "shading/virtual_eye_map.h"
#include "shading/virtual_eye_object.h"

namespace meniscus {

/// @throws Error invalid_argument: an option outside its range
void require_eyes(const VirtualEyeOptions& options);

/// What lies along a ray that leaves the surface.
struct EyeLook {
  vec3 still{0.0f};                                               ///< radiance of what stands still, times still_alpha
  float still_alpha = 0;                                          ///< 0: only the environment
  float still_distance = std::numeric_limits<float>::infinity();  ///< m from the surface
  vec3 object{0.0f};  ///< radiance of the objects before it, times object_alpha
  float object_alpha = 0;
  float object_distance = 0;  ///< m from the surface
};

/// One side of the surface as seen from the eye: what is refracted (behind the surface) or what is mirrored in it
/// (before it).
class EyeSide {
 public:
  /// What all maps of one view are made from.
  struct Inputs {
    const View& view;
    const HeightField& field;
    const Scene& scene;
    std::span<const WaterObject> objects;
    const VirtualEyeOptions& options;
    ApproximatingPlane plane;  ///< of the whole water, its normal on the eye's side
    float slack = 0;           ///< m by which the water differs from it
    bool eye_above = true;
    float ratio = 1;  ///< index of refraction on the eye's side over that behind the surface
    int size = 0;     ///< of the maps' faces
  };
  EyeSide(const Inputs& inputs, bool reflected);

  /// @param from       on the surface
  /// @param direction  unit, into this side
  EyeLook look(vec3 from, vec3 direction) const;
  const CubeMap& objects_map() const { return *object_map_; }
  const CubeMap& still_map() const { return *still_map_; }
  const std::vector<VirtualEye>& eyes() const { return eyes_; }

 private:
  /// An object's solids alone, and a ball around what its virtual eye shows of it.
  struct Body {
    Scene solids;
    std::int32_t index = 0;
    vec3 centre{0.0f};
    float radius = 0;
    vec3 axis_top{0.0f}, axis{0.0f};  ///< from one end of the main axis to the other, m
  };
  bool draw_objects(std::span<const vec3> directions, std::span<MapTexel> texels) const;
  bool draw_still(std::span<const vec3> directions, std::span<MapTexel> texels) const;
  void look_still(vec3 from, vec3 direction, EyeLook& look) const;
  void look_by_direction(vec3 from, vec3 direction, EyeLook& look) const;
  void look_by_position(vec3 from, vec3 direction, EyeLook& look) const;
  void add(const CubeMap::Cell& cell, vec3 from, std::int32_t only, EyeLook& look) const;
  float way_out(vec3 from, vec3 direction) const;

  Scene scene_, still_scene_;
  VirtualEye still_eye_;
  std::vector<Body> bodies_;
  std::vector<VirtualEye> eyes_;     ///< of the bodies
  std::vector<Trapezium> trapezia_;  ///< of all objects; none: objects are seen everywhere
  Axis up_ = Axis::y;
  bool per_point_ = false, by_position_ = true, objects_by_position_ = false, nothing_still_ = false;
  Bounds room_;
  float slack_ = 0;
  std::unique_ptr<CubeMap> object_map_, still_map_;
};

class VirtualEyes {
 public:
  VirtualEyes(const EyeSide::Inputs& inputs)
      : refracted_(inputs, false), reflected_(inputs, true), plane_(inputs.plane) {}
  const EyeSide& refracted() const { return refracted_; }
  const EyeSide& reflected() const { return reflected_; }
  const ApproximatingPlane& plane() const { return plane_; }

 private:
  EyeSide refracted_, reflected_;
  ApproximatingPlane plane_;
};

/// Radiance of one point of the surface by lookups in the maps.
vec3 virtual_eye_radiance(const Sample& sample, const VirtualEyes& eyes, const Scene& scene, const Material& material,
                          bool eye_in_water);

}  // namespace meniscus
