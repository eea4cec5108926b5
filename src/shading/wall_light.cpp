#include "shading/wall_light.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "meniscus/formulas/optics.h"
#include "shading/caustics_cells.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Beams that go towards a plane at a smaller cosine do not reach it.
constexpr float kAlong = 1e-3f;
/// Beams that rise at a smaller sine meet the next wave.
constexpr float kFlattest = 0.02f;
/// Surfaces this near to a plane, in steps of the field, that look its way are the wall.
constexpr float kNear = 1.5f;
constexpr float kLooksInwards = 0.9f;
/// The mirrored light of still water lights a body by its plane where it goes towards that at this cosine or more.
constexpr float kSteepest = 0.1f;
/// Texels up a wall, in those along the longer side of the field.
constexpr int kHighest = 2;

/// A beam that leaves the water.
struct MirroredBeam {
  vec3 from{0.0f}, direction{0.0f};
  float flux = -1;  ///< per horizontal area, over that of the sun on what faces it; negative: no water
};

Image<MirroredBeam> mirrored_beams(const HeightField& field, const FieldFrame& frame, const EnteringLight& light,
                                   const Image<float>& lit) {
  Image<MirroredBeam> beams(frame.width, frame.height);
  parallel_for(static_cast<std::size_t>(frame.height), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < frame.width; ++x) {
        MirroredBeam& beam = beams(x, y);
        const float height = field.height(x, y);
        if (!(height > -kInfinity)) continue;
        const vec3 normal = field.normal(x, y);
        const float cosine = glm::dot(normal, light.sun);
        beam.from = frame.world(frame.place(x, y), height);
        beam.direction = formulas::mirrored(-light.sun, normal);
        const bool rises = cosine > 0 && normal[frame.up] > 0.01f && beam.direction[frame.up] > kFlattest;
        beam.flux = rises ? light.reflectance(cosine) * cosine / normal[frame.up] : 0.0f;
        if (!lit.empty()) beam.flux *= lit(x, y);
      }
  });
  return beams;
}

}  // namespace

float WallLight::Wall::at(vec2 place) const {
  const vec2 p = (place - low) / texel;
  // The texels at the edges go on: light that was mirrored beside the water is none, but walls meet there.
  if (!(p.x >= -1.0f && p.y >= -1.0f && p.x <= static_cast<float>(value.width()) &&
        p.y <= static_cast<float>(value.height() - 1)))
    return 0;
  return between(value, std::clamp(p.x, 0.0f, static_cast<float>(value.width() - 1)), std::max(p.y, 0.0f));
}

WallLight::WallLight(const HeightField& field, std::shared_ptr<const WaterLevel> level, const EnteringLight& light,
                     const Image<float>& lit, FirstSolids solids, float top, int size)
    : level_(std::move(level)), light_(light), solids_(std::move(solids)), top_(top) {
  const FieldFrame& frame = level_->frame();
  const float texel = frame.longer_side() / static_cast<float>(size);
  if (!level_->any() || !(top > level_->lowest()) || !(texel > 0)) return;
  const Image<MirroredBeam> beams = mirrored_beams(field, frame, light, lit);
  const vec2 low = frame.low, high = frame.high();
  Image<LightPoint> points(frame.width, frame.height);
  for (int k = 0; k < 4; ++k) {
    Wall& wall = walls_[k];
    const bool over_a = k < 2;
    wall.across = over_a ? frame.a : frame.b;
    wall.along = over_a ? frame.b : frame.a;
    wall.inwards = k % 2 == 0 ? 1.0f : -1.0f;
    const int axis = over_a ? 0 : 1;
    wall.place = k % 2 == 0 ? low[axis] : high[axis];
    wall.texel = texel;
    const float begin = low[1 - axis], end = high[1 - axis];
    wall.low = {begin + 0.5f * texel, level_->lowest() - 0.5f * texel};
    const int width = std::max(2, static_cast<int>(std::ceil((end - begin) / texel - 1e-3f)));
    const int height =
        static_cast<int>(std::min(std::ceil((top - wall.low.y) / texel) + 1.0f, static_cast<float>(kHighest * size)));
    if (height < 2) continue;
    // Each beam on this plane, as far as it goes towards it; whether it ends here, samples are asked one by one.
    std::vector<std::uint8_t> any(static_cast<std::size_t>(frame.height), 0);
    parallel_for(static_cast<std::size_t>(frame.height), 8, [&](std::size_t first, std::size_t last) {
      for (std::size_t y = first; y < last; ++y)
        for (int x = 0; x < frame.width; ++x) {
          const MirroredBeam& beam = beams(x, static_cast<int>(y));
          LightPoint& point = points(x, static_cast<int>(y));
          const float towards = std::max(-wall.inwards * beam.direction[wall.across], kAlong);
          const float way = wall.inwards * (beam.from[wall.across] - wall.place) / towards;
          const vec2 met{beam.from[wall.along] + way * beam.direction[wall.along],
                         beam.from[frame.up] + way * beam.direction[frame.up]};
          point.at = (met - wall.low) / texel;
          point.flux = towards > kAlong ? beam.flux : 0.0f;
          any[y] |= point.flux > 0 && met.x >= begin && met.x <= end && met.y <= top;
        }
    });
    if (std::none_of(any.begin(), any.end(), [](std::uint8_t v) { return v != 0; })) continue;
    wall.value = Image<float>(width, height, 0.0f);
    gather_cells(points, frame.step.x * frame.step.y / (texel * texel), {(begin - wall.low.x) / texel, -kInfinity},
                 {(end - wall.low.x) / texel, kInfinity}, wall.value);
  }
}

float WallLight::on_wall(const Wall& wall, vec3 point) const {
  return wall.value.empty() ? 0.0f : wall.at({point[wall.along], point[level_->frame().up]});
}

vec3 WallLight::irradiance(vec3 point, vec3 normal) const {
  const FieldFrame& frame = level_->frame();
  if (!level_->any() || !(point[frame.up] <= top_)) return vec3{0.0f};
  const float over = -level_->depth(point);
  if (!(over > 0)) return vec3{0.0f};
  const float near = kNear * std::max(frame.step.x, frame.step.y);
  for (const Wall& wall : walls_)
    if (wall.inwards * normal[wall.across] > kLooksInwards && std::abs(point[wall.across] - wall.place) <= near)
      return light_.strength * (on_wall(wall, point) * wall.inwards * normal[wall.across]);

  // Anything else: on along the mirrored light of still water, or back along it, to the first of the planes.
  const float facing = -glm::dot(normal, light_.mirrored);
  if (!(facing > 0)) return vec3{0.0f};
  const Wall* first = nullptr;
  float nearest = kInfinity;
  for (const Wall& wall : walls_) {
    const float towards = -wall.inwards * light_.mirrored[wall.across];
    if (!(towards > kSteepest)) continue;
    const float way = wall.inwards * (point[wall.across] - wall.place) / towards;
    if (way < nearest) {
      nearest = way;
      first = &wall;
    }
  }
  if (!first) return vec3{0.0f};
  const float value = on_wall(*first, point + nearest * light_.mirrored);
  if (!(value > 0)) return vec3{0.0f};
  const float up = std::max(point[frame.up] - level_->mean(), 0.0f);
  const float passes =
      solids_.empty() ? 1.0f
                      : solids_.passes(frame.across(point) - light_.mirrored_slide * up, up / light_.cos_sun, normal);
  return light_.strength * (value * facing * passes / std::abs(light_.mirrored[first->across]));
}

}  // namespace meniscus
