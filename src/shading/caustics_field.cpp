#include "shading/caustics_field.h"

#include <algorithm>
#include <cmath>

#include "shading/backward_map.h"
#include "shading/simple_caustics.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kLeastSize = 128, kLargestSize = 512;
/// Mirrored light is faint: its maps are this many times as coarse, but no coarser than so many texels.
constexpr int kWallPart = 2, kLeastWall = 64;
/// Columns along the longer side of a field that is made here.
constexpr int kColumns = 256;
/// Rays along a side of the field that look for the floor.
constexpr int kSoundings = 12;

Axis upwards(vec3 up) {
  const vec3 size{std::abs(up.x), std::abs(up.y), std::abs(up.z)};
  return size.y >= size.x && size.y >= size.z ? Axis::y : size.z >= size.x ? Axis::z : Axis::x;
}

int map_size(const FieldFrame& frame, const CausticsOptions& options) {
  if (options.map_size > 0) return options.map_size;
  return std::clamp(std::max(frame.width, frame.height) - 1, kLeastSize, kLargestSize);
}

/// Part of simple caustics in both superposed: more and dark places become black.
constexpr float kSimplePart = 0.35f;

}  // namespace

FieldOf::FieldOf(const Surface& surface, const Scene& scene, const Bounds& box, StageTimes* times) {
  if (const HeightField* field = surface.height_field()) {
    own_ = field;
    return;
  }
  const StageTimer timer(times, "caustics surface");
  const Axis up = upwards(scene.ground().up);
  const vec3 extent = box.extent();
  const float longer = up == Axis::x   ? std::max(extent.y, extent.z)
                       : up == Axis::y ? std::max(extent.x, extent.z)
                                       : std::max(extent.x, extent.y);
  if (longer > 0)
    made_ =
        height_field_of(surface, up, box, std::max(longer / static_cast<float>(kColumns), 0.5f * surface.spacing()));
}

float receiving_level(const HeightField& field, const WaterLevel& level, const EnteringLight& light,
                      const Scene& scene) {
  const FieldFrame& frame = level.frame();
  std::vector<float> met(static_cast<std::size_t>(kSoundings) * kSoundings, kInfinity);
  parallel_for(met.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const int i =
          static_cast<int>((2 * (k % kSoundings) + 1) * static_cast<std::size_t>(frame.width) / (2 * kSoundings));
      const int j =
          static_cast<int>((2 * (k / kSoundings) + 1) * static_cast<std::size_t>(frame.height) / (2 * kSoundings));
      if (field.height(i, j) > -kInfinity)
        met[k] = scene.distance({frame.world(frame.place(i, j), field.height(i, j)), light.bent});
      if (met[k] < kInfinity) met[k] = field.height(i, j) - met[k] * light.cos_bent;
    }
  });
  met.erase(std::remove(met.begin(), met.end(), kInfinity), met.end());
  if (met.empty()) return std::min(field.floor, level.mean());
  std::nth_element(met.begin(), met.begin() + static_cast<std::ptrdiff_t>(met.size() / 2), met.end());
  return std::min(met[met.size() / 2], level.mean());
}

void superpose(PlaneMap& map, const PlaneMap& simple, float mean) {
  double before = 0, after = 0;
  const vec2 high = simple.low + simple.texel * vec2{static_cast<float>(simple.value.width() - 1),
                                                     static_cast<float>(simple.value.height() - 1)};
  for (int y = 0; y < map.value.height(); ++y)
    for (int x = 0; x < map.value.width(); ++x) {
      const vec2 place = map.low + map.texel * vec2{static_cast<float>(x), static_cast<float>(y)};
      float& value = map.value(x, y);
      before += static_cast<double>(value);
      if (place.x >= simple.low.x && place.y >= simple.low.y && place.x <= high.x && place.y <= high.y)
        value = std::max(0.0f, value + kSimplePart * (simple.at(place) - mean));
      after += static_cast<double>(value);
    }
  if (!(after > 0)) return;
  const float factor = static_cast<float>(before / after);
  for (float& value : map.value) value *= factor;
}

FieldLight field_light(const HeightField& field, const LightSource& sun, const Scene& scene, const Material& material,
                       const CausticsOptions& options, StageTimes* times) {
  FieldLight result;
  auto level = std::make_shared<const WaterLevel>(field);
  result.level = level;
  if (!level->any() || level->frame().width < 2 || level->frame().height < 2) return result;
  const FieldFrame& frame = level->frame();
  const EnteringLight light = entering_light(frame, sun.direction, sun.strength, material);
  Image<float> lit;
  {
    const StageTimer timer(times, "caustics shadows");
    lit = sunlit(field, *level, scene, light.sun);
  }
  const int size = map_size(frame, options);
  if (options.method != CausticsMethod::triangles) {
    const StageTimer timer(times, "caustics map");
    PlaneMap map;
    if (options.method != CausticsMethod::light_map) map = simple_caustics(field, *level, light, lit, options);
    if (options.method != CausticsMethod::simple) {
      PlaneMap traced = backward_map(field, *level, light, lit, receiving_level(field, *level, light, scene), size);
      if (options.method == CausticsMethod::combined) superpose(traced, map, light.transmittance);
      map = std::move(traced);
    }
    result.plane =
        std::make_shared<PlaneCaustics>(level, light, material, std::move(map), FirstSolids(*level, scene, light.bent));
  }
  const Bounds solids = scene.solid_bounds();
  if (!options.on_walls || solids.empty() || !(solids.high[frame.up] > level->lowest())) return result;
  const StageTimer timer(times, "caustics walls");
  result.walls = std::make_shared<WallLight>(field, level, light, lit, FirstSolids(*level, scene, light.mirrored),
                                             solids.high[frame.up], std::max(size / kWallPart, kLeastWall));
  return result;
}

}  // namespace meniscus
