#include "shading/caustics_plane.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "meniscus/formulas/optics.h"
#include "shading/caustics_landing.h"

namespace meniscus {
namespace {

/// Part of a step of the field over which light above the water becomes light under it.
constexpr float kSoftLine = 0.5f;
/// What clear and dark water take of the sky's light, and the part of the field's longer side that is deep: as in
/// soft_shadow().
constexpr float kLeastSkyTaken = 0.30f, kMostSkyTaken = 0.8f, kDeep = 0.02f;

}  // namespace

float EnteringLight::reflectance(float cosine) const {
  return std::min(1.0f, formulas::fresnel_reflectance(cosine, ior) * specular);
}

EnteringLight entering_light(const FieldFrame& frame, vec3 sun, vec3 strength, const Material& material) {
  EnteringLight light;
  light.sun = sun;
  light.strength = strength;
  light.ior = material.ior;
  light.specular = material.specular;
  vec3 up{0.0f};
  up[frame.up] = 1;
  light.cos_sun = std::max(glm::dot(sun, up), 1e-3f);
  light.bent = formulas::refracted(-sun, up, material.ior, formulas::fresnel(light.cos_sun, material.ior).cos_t);
  light.mirrored = formulas::mirrored(-sun, up);
  light.cos_bent = -glm::dot(light.bent, up);
  light.transmittance = 1.0f - light.reflectance(light.cos_sun);
  light.bent_slide = frame.across(light.bent) / light.cos_bent;
  light.mirrored_slide = frame.across(light.mirrored) / light.cos_sun;
  light.sun_slide = frame.across(sun) / light.cos_sun;
  return light;
}

float PlaneMap::at(vec2 place) const {
  vec2 p = (place - low) / texel;
  const vec2 last{static_cast<float>(value.width() - 1), static_cast<float>(value.height() - 1)};
  if (!(p.x >= -0.01f && p.y >= -0.01f && p.x <= last.x + 0.01f && p.y <= last.y + 0.01f)) return 0;
  p = {std::clamp(p.x, 0.0f, last.x), std::clamp(p.y, 0.0f, last.y)};
  return between(value, p.x, p.y);
}

PlaneCaustics::PlaneCaustics(std::shared_ptr<const WaterLevel> level, const EnteringLight& light,
                             const Material& material, PlaneMap pattern, FirstSolids solids)
    : level_(std::move(level)),
      light_(light),
      extinction_(caustics_extinction(material)),
      sky_extinction_(material.extinction + 0.35f * material.scattering),
      soft_(kSoftLine * std::max(level_->frame().step.x, level_->frame().step.y)),
      deep_(kDeep * level_->frame().longer_side()),
      pattern_(std::move(pattern)),
      solids_(std::move(solids)) {}

WaterLight::Light PlaneCaustics::at(vec3 point, vec3 normal) const {
  WaterLight::Light light;
  if (!level_->any()) return light;
  const float depth = level_->depth(point);
  const float under = std::clamp(depth / soft_ + 0.5f, 0.0f, 1.0f);
  if (!(under > 0)) return light;
  // Straight towards the sun: where there is water on the way this light has been bent.
  const FieldFrame& frame = level_->frame();
  const vec2 place = frame.across(point);
  const float down = std::max(level_->mean() - point[frame.up], 0.0f);
  light.sun = vec3{1.0f - under * level_->cover(place + light_.sun_slide * down)};
  const float cover = level_->cover(place);
  if (cover > 0) {
    const float covered = under * cover * (1.0f - std::exp(-std::max(depth, 0.0f) / deep_));
    const vec3 left = formulas::beer_lambert(sky_extinction_, std::max(depth, 0.0f));
    light.sky = 1.0f - covered * glm::mix(vec3{kMostSkyTaken}, vec3{kLeastSkyTaken}, left);
  }
  // And back along the light of still water.
  const float facing = -glm::dot(normal, light_.bent);
  if (!(facing > 0)) return light;
  const vec2 entry = place - light_.bent_slide * down;
  const float pattern = pattern_.at(entry);
  if (!(pattern > 0)) return light;
  const float path = down / light_.cos_bent;
  const float passes = solids_.empty() ? 1.0f : solids_.passes(entry, path, normal);
  const float relative = under * pattern * passes * facing * light_.cos_sun / light_.cos_bent;
  light.refracted = relative * light_.strength * formulas::beer_lambert(extinction_, path);
  return light;
}

}  // namespace meniscus
