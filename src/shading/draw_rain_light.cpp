#include "shading/draw_rain_light.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "meniscus/formulas/optics.h"

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// Part of a jet's light that its bumps scatter, in its middle and more at its rims, where there is more water.
constexpr float kScattered = 0.15f, kScatteredAtRims = 0.5f;
/// How far a jet bends light of what a ball would.
constexpr float kBend = 0.6f;
/// Radians by which bumps blur what jets refract.
constexpr float kJetCone = 0.35f;
/// Radians between the points of a ball that its mean is taken from, as their rays go apart.
constexpr float kBallCone = 0.12f;
/// The turn of a line, [0, 1], counter-clockwise with y upwards: along the edge of a diamond, without trigonometry.
float turn_of(vec2 axis) {
  if (axis.y < 0) axis = -axis;
  const float size = std::abs(axis.x) + axis.y;
  return size > 0 ? 0.5f - 0.5f * axis.x / size : 0.5f;
}
/// The unit vector with this turn.
vec2 axis_at(float turn) {
  const float x = 1.0f - 2.0f * turn;
  return glm::normalize(vec2{x, 1.0f - std::abs(x)});
}
/// Sun and lamps in the mean over a body, in radiances of a white ground.
constexpr float kBrightestLamps = 12.0f;

}  // namespace

BallOptics::BallOptics(float ior) : ior_(ior) {
  // Rings of directions by h = sin(half the angle): cosine = 1 - 2 h^2, and a ring's solid angle is 4 pi d(h^2).
  // Mirrored light goes to h = cos i, evenly over the sphere but for its weight; refracted light from rings of equal
  // area into the rings that it reaches.
  std::array<float, kSteps> refracted{};
  constexpr int kAreas = 512;
  float before = 0;
  for (int k = 1; k <= kAreas; ++k) {
    const float beside2 = static_cast<float>(k) / kAreas;  // squared distance from the axis
    const float middle2 = (static_cast<float>(k) - 0.5f) / kAreas;
    const float sin_i = std::sqrt(beside2);
    const float h = std::sin(std::asin(sin_i) - std::asin(sin_i / ior));
    const float light = (1.0f - formulas::fresnel_reflectance(std::sqrt(1.0f - middle2), ior)) / kAreas;
    const float low = std::clamp(before * kSteps, 0.0f, kSteps - 1e-3f),
                high = std::clamp(h * kSteps, 0.0f, kSteps - 1e-3f);
    for (int ring = static_cast<int>(low); ring <= static_cast<int>(high); ++ring) {
      const float from = std::max(low, static_cast<float>(ring)), to = std::min(high, static_cast<float>(ring + 1));
      refracted[static_cast<std::size_t>(ring)] += high > low ? light * (to - from) / (high - low) : light;
    }
    before = h;
  }
  for (int k = 0; k < kSteps; ++k) {
    const float inner = static_cast<float>(k) / kSteps, outer = static_cast<float>(k + 1) / kSteps;
    const float mirrored = formulas::fresnel_reflectance(0.5f * (inner + outer), ior);
    const auto ring = static_cast<std::size_t>(k);
    phase_[ring] = mirrored / (4.0f * kPi) + refracted[ring] / (4.0f * kPi * (outer * outer - inner * inner));
  }
}

float BallOptics::phase(float cosine) const {
  const float h = std::sqrt(std::clamp(0.5f * (1.0f - cosine), 0.0f, 1.0f));
  const float x = std::clamp(h * kSteps - 0.5f, 0.0f, kSteps - 1.001f);
  const auto i = static_cast<std::size_t>(x);
  const float t = x - static_cast<float>(i);
  return phase_[i] + t * (phase_[i + 1] - phase_[i]);
}

RainLight::RainLight(const View& view, const Surroundings& surroundings, float ior)
    : optics_(ior),
      surroundings_(&surroundings),
      parts_(&surroundings.parts()),
      width_(static_cast<float>(view.width)),
      height_(static_cast<float>(view.height)),
      nodes_(static_cast<std::size_t>(kColumns * kRows)) {
  constexpr int kPoints = 96, kAcross = 8;
  // Points of a disc of equal areas, on a spiral.
  std::array<vec3, kPoints> disc;  // x, y and the cosine of incidence
  for (int k = 0; k < kPoints; ++k) {
    const float r2 = (static_cast<float>(k) + 0.5f) / kPoints, turn = 2.39996323f * static_cast<float>(k);
    disc[static_cast<std::size_t>(k)] = {std::sqrt(r2) * std::cos(turn), std::sqrt(r2) * std::sin(turn),
                                         std::sqrt(1.0f - r2)};
  }
  // In a parallel view all rays are alike: one node serves.
  const bool alike = view.projection == Projection::orthographic;
  parallel_for(alike ? 1 : nodes_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const vec2 place{width_ * static_cast<float>(i % kColumns) / (kColumns - 1),
                       height_ * static_cast<float>(i / kColumns) / (kRows - 1)};
      const vec3 v = view.ray(place).direction;
      const vec3 right = glm::normalize(view.right - glm::dot(view.right, v) * v), up = glm::cross(right, v);
      Node& node = nodes_[i];
      for (const vec3& p : disc) {
        const BodyRays body = rays(v, p.x * right + p.y * up - p.z * v);
        node.ball += (body.mirrored * parts_->radiance(body.mirror_direction, kBallCone) +
                      (1.0f - body.mirrored) * parts_->radiance(body.exit, kBallCone)) /
                     static_cast<float>(kPoints);
      }
      for (int a = 0; a < kAngles; ++a) {
        const vec2 axis = axis_at(static_cast<float>(a) / kAngles);
        const vec3 side = -axis.y * right + axis.x * up;  // across the axis
        const vec3 inside = in_jets(axis.x * right + axis.y * up);
        vec3 sum{0.0f};
        for (int k = 0; k < kAcross; ++k) {
          const float s = (2.0f * static_cast<float>(k) + 1.0f) / kAcross - 1.0f;
          const JetRays jet = jet_rays(v, s * side - std::sqrt(1.0f - s * s) * v);
          const vec3 through = parts_->radiance(jet.body.exit, kJetCone);
          sum += jet.body.mirrored * parts_->radiance(jet.body.mirror_direction, kJetCone) +
                 (1.0f - jet.body.mirrored) * (through + jet.scattered * (inside - through));
        }
        node.jets[static_cast<std::size_t>(a)] = sum / static_cast<float>(kAcross);
      }
    }
  });
  if (alike) std::fill(nodes_.begin() + 1, nodes_.end(), nodes_.front());
}

std::array<RainLight::Corner, 4> RainLight::corners(vec2 place) const {
  const float x = std::clamp(place.x / width_ * (kColumns - 1), 0.0f, kColumns - 1.001f);
  const float y = std::clamp(place.y / height_ * (kRows - 1), 0.0f, kRows - 1.001f);
  const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  const std::size_t first = j * kColumns + i;
  return {Corner{first, (1 - s) * (1 - t)}, Corner{first + 1, s * (1 - t)}, Corner{first + kColumns, (1 - s) * t},
          Corner{first + kColumns + 1, s * t}};
}

vec3 RainLight::ball(vec2 place) const {
  vec3 sum{0.0f};
  for (const Corner& corner : corners(place)) sum += corner.weight * nodes_[corner.node].ball;
  return sum;
}

vec3 RainLight::jet(vec2 place, vec2 axis) const {
  const float x = turn_of({axis.x, -axis.y}) * kAngles;
  const auto whole = static_cast<std::size_t>(x);
  const std::size_t a = whole % kAngles, b = (whole + 1) % kAngles;
  const float t = x - static_cast<float>(whole);
  vec3 sum{0.0f};
  for (const Corner& corner : corners(place)) {
    const Node& node = nodes_[corner.node];
    sum += corner.weight * ((1.0f - t) * node.jets[a] + t * node.jets[b]);
  }
  return sum;
}

vec3 RainLight::lamps(vec3 point, vec3 direction) const {
  vec3 sum = parts_->sun_irradiance * optics_.phase(glm::dot(direction, parts_->sun_direction));
  for (const PointLight& lamp : parts_->lamps) {
    const vec3 way = lamp.position - point;
    const float squared = std::max(glm::dot(way, way), 1e-4f);
    sum += lamp.intensity * (optics_.phase(glm::dot(direction, way) / std::sqrt(squared)) / squared);
  }
  const float peak = std::max(sum.x, std::max(sum.y, sum.z));
  return peak > 0 ? sum * (kBrightestLamps / (kBrightestLamps + peak)) : vec3{0.0f};
}

BodyRays RainLight::rays(vec3 direction, vec3 normal) const {
  float cos_i = -glm::dot(direction, normal);
  const vec3 beside = normal + cos_i * direction;  // across the viewing ray
  cos_i = std::clamp(std::abs(cos_i), 0.0f, 1.0f);
  const float length2 = glm::dot(beside, beside);
  const vec3 outwards = length2 > 1e-12f ? beside / std::sqrt(length2) : vec3{0.0f};
  const BallOptics::Bend bend = optics_.at(cos_i);
  // Mirrored at n = sin i outwards - cos i direction: direction + 2 cos i n.
  const float sin_i = std::sqrt(std::max(0.0f, 1.0f - cos_i * cos_i));
  return {bend.cosine * direction - bend.sine * outwards,
          direction + 2.0f * cos_i * (sin_i * outwards - cos_i * direction), bend.cosine, bend.mirrored};
}

JetRays RainLight::jet_rays(vec3 direction, vec3 normal) const {
  JetRays jet{rays(direction, normal), 0};
  const vec3 exit = glm::normalize(direction + kBend * (jet.body.exit - direction));
  jet.body.exit = exit;
  jet.body.straight = glm::dot(direction, exit);
  const float facing = glm::dot(direction, normal), beside2 = std::max(0.0f, 1.0f - facing * facing);
  jet.scattered = kScattered + (kScatteredAtRims - kScattered) * beside2 * beside2;
  return jet;
}

vec3 RainLight::glare(const BodyRays& body, vec3 point, float variance) const {
  return body.mirrored * surroundings_->glare(point, body.mirror_direction, variance) +
         (1.0f - body.mirrored) * surroundings_->glare(point, body.exit, variance);
}

}  // namespace meniscus
