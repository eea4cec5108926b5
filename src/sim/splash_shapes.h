/// What a splash looks like at an age: pyramids, spheres, a disk.                          [Mizukami2013] section 4
#pragma once

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>

#include "meniscus/formulas/rain.h"
#include "meniscus/sim.h"
#include "sim/splash_make.h"

namespace meniscus {

/// From 0 at t <= 0 to 1 at t >= 1, without a kink; slope 1.5 at most. Nothing of a splash appears or goes faster.
inline float eased(float t) { return glm::smoothstep(0.0f, 1.0f, t); }

/// s in which a pile's base becomes as wide as it gets, and a droplet at least takes to swell on its tip.
inline constexpr float kWiden = 0.008f, kSwell = 0.005f;
/// Of the way to its tip that a pile of a crown still reaches when it is down: without, needles would lie around it.
inline constexpr float kCrownKeeps = 0.3f;

/// The shapes of one splash at one age. Each is handed over as what makes it, so that counting them costs little.
template <class Sink>
class SplashShapes {
 public:
  SplashShapes(const Splash& splash, const SplashOptions& options, float age, Sink sink)
      : splash_(splash), options_(options), age_(age), sink_(sink) {}

  /// @param droplets  of the splash
  void show(std::span<const Droplet> droplets) {
    if (!(age_ > 0 && age_ < splash_.ends)) return;
    if (splash_.kind == SplashKind::disk) sink_([&] { return disk(); });
    if (splash_.kind == SplashKind::scattering)
      for (const Droplet& droplet : droplets) show_scattering(droplet);
    if (splash_.kind == SplashKind::crown_cone) {
      for (const Droplet& tip : droplets.subspan(1))
        if (age_ < tip.lands) sink_([&] { return crown_pile(tip); });
      if (age_ > splash_.cone_starts) show_cone(droplets.front());
    }
  }

 private:
  void show_scattering(const Droplet& droplet) {
    if (age_ < droplet.leaves + kSinkTime) sink_([&] { return scattering_pile(droplet); });
    if (age_ > 0.5f * droplet.leaves && age_ < droplet.lands + kLandFade)
      sink_([&] { return ball(droplet, place(droplet, std::min(age_, droplet.lands)), 0.5f * droplet.leaves); });
  }

  void show_cone(const Droplet& drop) {
    const float starts = splash_.cone_starts, middle = 0.5f * (starts + drop.leaves);
    if (age_ < sunk(drop)) sink_([&] { return cone(drop); });
    if (age_ > middle && age_ < drop.lands + kLandFade)
      sink_([&] { return ball(drop, place_of_cone(drop, std::min(age_, drop.lands)), middle); });
  }

  vec3 place(const Droplet& droplet, float age) const {
    return droplet.start +
           formulas::orbit_offset(droplet.velocity, splash_.impact.wind, options_.gravity, droplet.drag, age);
  }
  /// On the orbit that starts with the cone, without wind.
  vec3 place_of_cone(const Droplet& drop, float age) const {
    return drop.start +
           formulas::orbit_offset(drop.velocity, vec3(0.0f), options_.gravity, drop.drag, age - splash_.cone_starts);
  }

  /// The tip is on the droplet's orbit until that leaves, then it goes back.
  WaterPiece scattering_pile(const Droplet& droplet) const {
    const float left = 1 - eased((age_ - droplet.leaves) / kSinkTime);
    const vec3 tip = place(droplet, std::min(age_, droplet.leaves));
    return pile(droplet, tip, left, splash_.width * eased(age_ / kWiden) * left);
  }
  /// The tip is on its orbit as it rises; as it comes down the pile draws back from it and gets thinner.
  WaterPiece crown_pile(const Droplet& tip) const {
    const float left = 1 - eased(2 * age_ / tip.lands - 1);
    return pile(tip, place(tip, age_), kCrownKeeps + (1 - kCrownKeeps) * left,
                splash_.width * eased(age_ / kWiden) * left);
  }
  WaterPiece pile(const Droplet& droplet, vec3 tip, float length, float width) const {
    WaterPiece piece;
    piece.kind = WaterPiece::Kind::pyramid;
    piece.from = droplet.start;
    piece.to = droplet.start + (tip - droplet.start) * length;
    // Level with the surface and square to where the tip sets out to; for what goes straight up along the circle.
    const vec3 normal = splash_.impact.normal;
    vec3 across = glm::cross(droplet.velocity, normal);
    if (glm::dot(across, across) < 1e-8f * glm::dot(droplet.velocity, droplet.velocity))
      across = glm::cross(droplet.start - splash_.impact.point, normal);
    piece.across = across * (width / std::max(glm::length(across), 1e-20f));
    return piece;
  }

  /// s after the impact when the cone is gone: its drop is still in the air.
  static float sunk(const Droplet& drop) { return drop.leaves + 0.6f * (drop.lands - drop.leaves); }
  WaterPiece cone(const Droplet& drop) const {
    const float left = 1 - eased((age_ - drop.leaves) / std::max(sunk(drop) - drop.leaves, 1e-6f));
    const vec3 tip = place_of_cone(drop, std::min(age_, drop.leaves));
    const float width = options_.size * kConeWidth * splash_.impact.diameter * left;
    WaterPiece piece;
    piece.kind = WaterPiece::Kind::pyramid;
    piece.from = drop.start;
    piece.to = drop.start + (tip - drop.start) * left;
    const vec3 side = std::abs(drop.velocity.x) < std::abs(drop.velocity.y) ? vec3(1, 0, 0) : vec3(0, 1, 0);
    piece.across =
        glm::normalize(glm::cross(drop.velocity, side)) * (width * eased((age_ - splash_.cone_starts) / (2 * kWiden)));
    return piece;
  }

  /// A droplet: it swells on its tip from `from` on and sinks into what it lands on.
  WaterPiece ball(const Droplet& droplet, vec3 centre, float from) const {
    WaterPiece piece;
    piece.from = centre;
    piece.radius = options_.size * droplet.radius * eased((age_ - from) / std::max(droplet.leaves - from, kSwell)) *
                   (1 - eased((age_ - droplet.lands) / kLandFade));
    return piece;
  }

  /// It spreads at once, stays, and goes in the second half of its time.
  WaterPiece disk() const {
    WaterPiece piece;
    piece.kind = WaterPiece::Kind::disk;
    piece.from = splash_.impact.point;
    piece.across = splash_.impact.normal;
    piece.radius = splash_.circle * eased(age_ / kSpreadTime);
    piece.opacity = 1 - eased(2 * age_ / splash_.ends - 1);
    return piece;
  }

  const Splash& splash_;
  const SplashOptions& options_;
  float age_;
  Sink sink_;
};

}  // namespace meniscus
