/// Maps of what stands in and around the water, drawn from virtual eyes.                  [Cords2008] 2.1 to 2.3
#pragma once

#include "shading/plane_light.h"
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
    float ratio = 1;                    ///< index of refraction on the eye's side over that behind the surface
    int size = 0;                       ///< of the maps' faces
    const PlaneLight* light = nullptr;  ///< of all planes; must outlive the side
  };
  EyeSide(const Inputs& inputs, bool reflected);

  /// @param rays   from the surface into this side, neighbours close together; no more than a thousand or so
  /// @param beam   of the rays
  /// @param looks  one a ray, overwritten
  void look(std::span<const Ray> rays, Beam beam, std::span<EyeLook> looks) const;
  const std::vector<VirtualEye>& eyes() const { return eyes_; }

 private:
  /// An object's solids alone, and a ball around what its virtual eye shows of it.
  struct Body {
    Scene solids;
    std::int32_t index = 0;
    vec3 centre{0.0f};
    float radius = 0;
    vec3 axis_top{0.0f}, axis{0.0f};  ///< from one end of the main axis to the other, m
    std::size_t map = 0;              ///< that shows it
  };
  void share_maps(int size);
  bool draw_objects(std::size_t map, std::span<const vec3> directions, std::span<MapTexel> texels) const;
  bool draw_still(std::span<const vec3> directions, std::span<MapTexel> texels) const;
  void look_still(std::span<const Ray> rays, Beam beam, std::span<EyeLook> looks) const;
  void look_still_by_direction(vec3 direction, EyeLook& look) const;
  void look_by_direction(vec3 from, vec3 direction, EyeLook& look) const;
  void look_by_position(vec3 from, vec3 direction, EyeLook& look) const;
  void add(const CubeMap::Cell& cell, vec3 from, std::int32_t only, EyeLook& look) const;

  Scene scene_, still_scene_;
  VirtualEye still_eye_;
  std::vector<Body> bodies_;
  std::vector<VirtualEye> eyes_;     ///< of the bodies
  std::vector<Trapezium> trapezia_;  ///< of all objects; none: objects are seen everywhere
  Axis up_ = Axis::y;
  bool per_point_ = false, by_position_ = true, objects_by_position_ = false, nothing_still_ = false;
  const PlaneLight* light_;
  float slack_ = 0;
  /// Looked up by position, objects that hide each other from their own virtual eyes need not do so along a ray: they
  /// are in different maps. By direction there is one.
  std::vector<std::unique_ptr<CubeMap>> object_maps_;
  std::unique_ptr<CubeMap> still_map_;
};

class VirtualEyes {
 public:
  /// @param inputs  without their light
  VirtualEyes(EyeSide::Inputs inputs, const Bounds& region, float step)
      : light_(inputs.scene, region, step),
        refracted_((inputs.light = &light_, inputs), false),
        reflected_(inputs, true),
        plane_(inputs.plane),
        sides_too_(inputs.eye_above && inputs.options.object_position && inputs.options.static_position &&
                   inputs.scene.tank().style == TankStyle::tiled) {}
  const EyeSide& refracted() const { return refracted_; }
  const EyeSide& reflected() const { return reflected_; }
  const ApproximatingPlane& plane() const { return plane_; }
  /// Whether sides of the water are looked through like its surface: everything is found by its place, and the water
  /// ends at walls.
  bool sides_too() const { return sides_too_; }

 private:
  PlaneLight light_;
  EyeSide refracted_, reflected_;
  ApproximatingPlane plane_;
  bool sides_too_ = false;
};

/// Radiance of points of the surface by lookups in the maps.
/// @param samples    neighbours close together; no more than a thousand or so
/// @param materials  one for all, or one a sample
/// @param seen       one a sample
void virtual_eye_radiance(std::span<const Sample> samples, std::span<const Material> materials, const VirtualEyes& eyes,
                          const Scene& scene, bool eye_in_water, std::span<vec3> seen);

}  // namespace meniscus
