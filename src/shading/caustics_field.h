/// The sun's light by a height field: on what lies under the water and on what stands out of it.
#pragma once

#include "shading/caustics_light.h"
#include "shading/caustics_plane.h"
#include "shading/wall_light.h"

namespace meniscus {

/// The surface's own field, or one that is looked for in what is seen of the water from above.
class FieldOf {
 public:
  /// @param box  of the water that counts, m
  FieldOf(const Surface& surface, const Scene& scene, const Bounds& box, StageTimes* times = nullptr);
  const HeightField& operator*() const { return own_ ? *own_ : made_; }

 private:
  const HeightField* own_ = nullptr;
  HeightField made_;
};

/// What the methods simple, light_map and combined make of the sun.
struct FieldLight {
  std::shared_ptr<const WaterLevel> level;
  std::shared_ptr<const PlaneCaustics> plane;  ///< null for triangles
  std::shared_ptr<const WallLight> walls;      ///< null: none is asked for, or nothing stands out of the water
};
FieldLight field_light(const HeightField& field, const LightSource& sun, const Scene& scene, const Material& material,
                       const CausticsOptions& options, StageTimes* times = nullptr);

/// Two maps superposed: what each adds to the mean or takes from it, on the other, scaled to the first one's sum.
/// @param simple  values of the same mean
/// @param mean    of still water
void superpose(PlaneMap& map, const PlaneMap& simple, float mean);

/// Level of the plane that light through the mean level lands on, m: the median over the field of what is met.
float receiving_level(const HeightField& field, const WaterLevel& level, const EnteringLight& light,
                      const Scene& scene);

}  // namespace meniscus
