#include "render/crown_shape.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>

#include "base/random.h"

namespace meniscus {
namespace {

using glm::vec2;
using glm::vec3;

constexpr float kPi = std::numbers::pi_v<float>;

// The pool.
constexpr float kLevel = 0.30f;        ///< m, of still water
constexpr float kBase = 0.42f;         ///< m from the axis to where the sheet stands on the pool
constexpr float kRingLength = 0.19f;   ///< m from ring to ring
constexpr float kRingHeight = 0.020f;  ///< m, of the first ring

// The sheet goes from (kBase, kFoot) outwards and up, bent outwards.
constexpr float kFoot = 0.24f;                                    ///< m; under the swell
constexpr float kOut = 0.21f;                                     ///< m from foot to end, away from the axis
constexpr float kUp = 0.54f;                                      ///< m from foot to end, up
constexpr float kFootThickness = 0.036f, kEndThickness = 0.018f;  ///< m

constexpr int kLobes = 21;
constexpr float kLobeWidth = 0.075f;  ///< radians, standard deviation
constexpr int kLooseDrops = 160;
constexpr int kEnds = 4096;  ///< angles at which the sheet's end is kept

float gauss(float x) { return std::exp(-x * x); }

vec3 turned(float angle, float r, float y) { return {r * std::cos(angle), y, r * std::sin(angle)}; }

}  // namespace

float crown_pool_height(float x, float z) {
  const float r = std::sqrt(x * x + z * z);
  const float out = r - kBase;
  const float crater = -0.13f * gauss(r / 0.27f) * (1 + 0.06f * std::cos(2 * kPi * r / 0.11f));
  const float swell = 0.045f * gauss(out / 0.065f);
  // Rings begin with no slope at the swell and fade away outwards.
  const float begin = std::clamp(out / 0.15f, 0.0f, 1.0f);
  const float rings =
      kRingHeight * begin * begin * (3 - 2 * begin) * std::cos(2 * kPi * out / kRingLength) * std::exp(-out / 0.7f);
  const float wind = 0.0035f * std::sin(9 * x + 4 * z) + 0.0025f * std::sin(-7 * x + 13 * z + 1) +
                     0.0012f * std::sin(23 * x + 19 * z + 2);
  return kLevel + crater + swell + rings + wind;
}

CrownShape::CrownShape(float spacing, std::uint64_t seed) : spacing_(spacing) {
  constexpr int kPieces = 256;
  for (int i = 0; i < kPieces; ++i) {
    const Profile a = profile(static_cast<float>(i) / kPieces), b = profile(static_cast<float>(i + 1) / kPieces);
    length_ += std::hypot(b.r - a.r, b.y - a.y);
  }
  Draws draws(seed, 1);
  for (int i = 0; i < kLobes; ++i)
    lobes_.push_back({2 * kPi / kLobes * (static_cast<float>(i) + static_cast<float>(draws.between(-0.28, 0.28))),
                      static_cast<float>(draws.between(0.08, 0.20))});
  for (int i = 0; i <= kEnds; ++i) ends_.push_back(end_by_lobes(2 * kPi / kEnds * static_cast<float>(i)));
  add_rim(seed);
  add_jets(seed);
}

CrownShape::Profile CrownShape::profile(float v) const {
  const vec2 slope = glm::normalize(vec2(kOut * (0.35f + 1.3f * v), kUp * (1.25f - 0.5f * v)));
  return {kBase + kOut * v * (0.35f + 0.65f * v), kFoot + kUp * v * (1.25f - 0.25f * v), slope.y, -slope.x};
}

float CrownShape::thickness(float v) const {
  return std::max(3 * spacing_, kFootThickness + (kEndThickness - kFootThickness) * v);
}

float CrownShape::end(float angle) const {
  const float turns = angle / (2 * kPi);
  const float at = kEnds * (turns - std::floor(turns));
  const auto before = static_cast<std::size_t>(std::min(at, static_cast<float>(kEnds - 1)));
  return ends_[before] + (at - static_cast<float>(before)) * (ends_[before + 1] - ends_[before]);
}

float CrownShape::end_by_lobes(float angle) const {
  float up = 0.74f + 0.025f * std::sin(2 * angle + 0.4f) + 0.015f * std::sin(5 * angle);
  for (const Lobe& lobe : lobes_) {
    const float off = std::remainder(angle - lobe.angle, 2 * kPi);
    if (std::abs(off) < 4 * kLobeWidth) up += lobe.height * gauss(off / (std::sqrt(2.0f) * kLobeWidth));
  }
  return std::min(up, 0.98f);
}

bool CrownShape::near_sheet(vec3 point) const {
  // The height of the profile is a quadratic of v: 0.25 v^2 - 1.25 v + (y - foot) / up = 0.
  const float root = 1.25f * 1.25f - (point.y - kFoot) / kUp;
  if (root < 0) return false;
  const float v = 2 * (1.25f - std::sqrt(root));
  if (v < 0) return false;
  const Profile middle = profile(v);
  const float away = std::abs((std::hypot(point.x, point.z) - middle.r) * middle.nr);
  if (away > 0.5f * (thickness(v) + spacing_)) return false;
  return v < end(std::atan2(point.z, point.x)) + 0.5f * spacing_ / length_;
}

void CrownShape::add_ball(vec3 centre, float radius) { balls_.push_back({centre, std::max(radius, 0.7f * spacing_)}); }

// A bead along the end of the sheet, somewhat thicker than the sheet and of changing thickness.
void CrownShape::add_rim(std::uint64_t seed) {
  Draws draws(seed, 2);
  const float phase = static_cast<float>(draws.between(0, 6));
  for (float angle = 0; angle < 2 * kPi;) {
    const float v = end(angle);
    const Profile at = profile(v);
    const float radius = thickness(v) * (0.62f + 0.12f * std::sin(31 * angle + phase));
    add_ball(turned(angle, at.r, at.y), radius);
    // Where the end of the sheet is steep the balls stand closer in angle.
    constexpr float kProbe = 1e-3f;
    const Profile next = profile(end(angle + kProbe));
    const float run = std::hypot(std::hypot(next.r - at.r, next.y - at.y), at.r * kProbe) / kProbe;
    angle += 0.35f * radius / run;
  }
}

// Jets rise from the rim on the way of the sheet, grow thinner and end in beads; before them fly drops.
void CrownShape::add_jets(std::uint64_t seed) {
  Draws draws(seed, 3);
  const auto between = [&](double low, double high) { return static_cast<float>(draws.between(low, high)); };
  for (const Lobe& lobe : lobes_) {
    const float v = end(lobe.angle);
    const Profile at = profile(v);
    const float wide = 0.62f * thickness(v);
    const float length = between(0.05, 0.20);
    vec2 place(at.r, at.y), way = glm::normalize(vec2(-at.ny + between(0.0, 0.35), at.nr));
    float angle = lobe.angle, gone = 0;
    const float turn = between(-0.25, 0.25);
    while (gone < length) {
      const float radius = wide * (1 - 0.55f * gone / length);
      add_ball(turned(angle, place.x, place.y), radius);
      const float step = 0.35f * std::max(radius, 0.7f * spacing_);
      place += step * way;
      angle += step * turn / place.x;
      way = glm::normalize(way + vec2(0, -1.2f * step));
      gone += step;
    }
    add_ball(turned(angle, place.x, place.y), wide * between(0.75, 1.05));
    const int drops = 2 + static_cast<int>(draws.uniform() * 5);
    for (int i = 0; i < drops; ++i) {
      place += between(0.025, 0.06) * way;
      way = glm::normalize(way + vec2(between(0.0, 0.1), -0.12f));
      add_ball(turned(angle + between(-0.03, 0.03), place.x, place.y), between(0.004, 0.013));
    }
  }
  // Loose ones above the crown and around it; small ones are many.
  for (int i = 0; i < kLooseDrops; ++i) {
    const float r = between(0.30, 0.85), radius = 0.0025f + 0.008f * std::pow(between(0, 1), 3.0f);
    add_ball(turned(between(0, 2 * kPi), r, between(0.45, 1.05) - 0.5f * std::max(0.0f, r - 0.65f)), radius);
  }
}

}  // namespace meniscus
