#include "sim/splash_make.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>

#include "meniscus/formulas/rain.h"
#include "sim/splash_orbit.h"
#include "sim/splash_random.h"

namespace meniscus {
namespace {

constexpr double kPi = std::numbers::pi;

// What the paper leaves to "the size of the drop" and "the situation of the surface"; lengths in diameters of the drop.
constexpr float kCircleWet = 0.75f, kCircle3mm = 1.0f, kCircle5mm = 1.5f;  ///< initial circle of the piles
constexpr float kCircleCrown = 2.0f;                                       ///< and of a crown
constexpr float kDisk = 1.5f;                                              ///< radius of the disk
constexpr float kWidest = 0.4f;                                            ///< half a diagonal of a pile's base at most
// The walls of a crown stand steep and rise by two to three diameters of the drop.
constexpr float kCrownLowest = 66, kCrownHighest = 86, kCrownAngle = 76, kCrownAngleSigma = 3;  ///< degrees
constexpr float kCrownSpeed = 0.055f;      ///< of the crown's tips, over the drop's speed against the surface
constexpr float kCrownSpeedSigma = 0.08f;  ///< over the mean
constexpr float kCrownWidth = 0.8f;  ///< half a diagonal of its piles' bases, over the way from one to the next: a wall
constexpr float kCrownPart = 0.25f;  ///< of the longest time of a splash, that a crown may take
constexpr float kCrownTip = 0.3f;    ///< radius of what the air brakes at a crown's tip
constexpr float kJitter = 0.25f;     ///< standard deviation of the azimuth, over the angle between two piles
constexpr float kJitterMost = 0.35f;  ///< rad
constexpr float kUneven = 0.5f;       ///< standard deviation of the logarithm of the droplets' volumes

struct Frame {
  vec3 normal, x, y;  ///< orthonormal
};

Frame frame_of(vec3 normal) {
  // Any direction that is not the normal's; the azimuth is random anyway.
  const vec3 other = std::abs(normal.y) < 0.8f ? vec3(0, 1, 0) : vec3(0, 0, 1);
  const vec3 x = glm::normalize(glm::cross(other, normal));
  return {normal, x, glm::cross(normal, x)};
}

float radius_of(double volume) { return static_cast<float>(std::cbrt(volume * 3 / (4 * kPi))); }

float circle_of(const Impact& impact, SplashKind kind) {
  if (kind == SplashKind::disk) return kDisk * impact.diameter;
  if (kind == SplashKind::crown_cone) return kCircleCrown * impact.diameter;
  const float factor = impact.wetness == Wetness::wet          ? kCircleWet
                       : impact.wetness == Wetness::puddle_3mm ? kCircle3mm
                                                               : kCircle5mm;
  return factor * impact.diameter;
}

/// The piles of a splash stand evenly on its circle, from anywhere on, and lean a little to the sides.
/// @param speed, elevation  m/s and radians, of this pile
/// @param carried           part of the drop's velocity along the surface that it takes over
Droplet pile(const Impact& impact, const Frame& frame, float circle, double azimuth, double jitter, double speed,
             double elevation, float carried) {
  const auto on_circle = [&](double angle) {
    return frame.x * static_cast<float>(std::cos(angle)) + frame.y * static_cast<float>(std::sin(angle));
  };
  const vec3 along = impact.velocity - frame.normal * glm::dot(impact.velocity, frame.normal);
  Droplet droplet;
  droplet.start = impact.point + on_circle(azimuth) * circle;
  droplet.velocity = on_circle(azimuth + jitter) * static_cast<float>(speed * std::cos(elevation)) +
                     frame.normal * static_cast<float>(speed * std::sin(elevation)) + along * carried;
  return droplet;
}

/// Fills in how the droplet flies.
/// @param radius     m, of what the air brakes
/// @param most_time  s after its start when it is given up
void fly(Droplet& droplet, float radius, vec3 wind, vec3 normal, vec3 gravity, float most_time) {
  droplet.drag = air_drag(glm::length(droplet.velocity - wind), 2 * radius);
  droplet.lands = landing_time({droplet.velocity, wind, gravity, droplet.drag}, normal, most_time);
}

void scatter(Splash& splash, const SplashOptions& options, Draws& draws, std::vector<Droplet>& droplets) {
  const Impact& impact = splash.impact;
  const Frame frame = frame_of(impact.normal);
  const SplashRanges r = splash_ranges(impact.material, impact.wetness, drop_size_of(impact.diameter));
  const int number = number_within(draws, r.number_mean, r.number_sigma, r.fewest, r.most);
  const double between = 2 * kPi / number, first = 2 * kPi * draws.uniform();
  const double jitter = std::min<double>(kJitter * between, kJitterMost);
  splash.width = std::min(kWidest * options.size * impact.diameter, 0.5f * splash.circle * static_cast<float>(between));

  std::array<double, kMostDroplets> volumes;
  double sum = 0;
  for (int i = 0; i < number; ++i) {
    const double speed = normal_within(draws, r.speed_mean, r.speed_sigma, r.slowest, r.fastest);
    const double angle = normal_within(draws, r.angle_mean_deg, r.angle_sigma_deg, r.lowest_deg, r.highest_deg);
    droplets.push_back(pile(impact, frame, splash.circle, first + between * i, jitter * draws.normal(), speed,
                            angle * kPi / 180, kCarried));
    sum += volumes[static_cast<std::size_t>(i)] = std::exp(kUneven * draws.normal());
  }
  const double drop = kPi / 6 * std::pow(static_cast<double>(impact.diameter), 3);
  const double flying = drop * flying_share(splash.kind, impact.wetness);
  const auto begin = droplets.end() - number;
  for (int i = 0; i < number; ++i) {
    begin[i].radius = radius_of(flying * volumes[static_cast<std::size_t>(i)] / sum);
    fly(begin[i], begin[i].radius, impact.wind, impact.normal, options.gravity, options.most_time - kLandFade);
    begin[i].leaves =
        leaving_time({begin[i].velocity, impact.wind, options.gravity, begin[i].drag}, options.growth_length,
                     std::min({options.growth_time, begin[i].lands, options.most_time - kSinkTime}));
  }
  // By the time when they land, so that those that land within an interval are found by halving.
  std::sort(begin, droplets.end(), [](const Droplet& a, const Droplet& b) { return a.lands < b.lands; });
  for (auto droplet = begin; droplet != droplets.end(); ++droplet)
    splash.ends = std::max({splash.ends, droplet->lands + kLandFade, droplet->leaves + kSinkTime});
}

void crown_and_cone(Splash& splash, const SplashOptions& options, Draws& draws, std::vector<Droplet>& droplets) {
  const Impact& impact = splash.impact;
  const DropSize size = drop_size_of(impact.diameter);
  const Frame frame = frame_of(impact.normal);
  const std::size_t cone = droplets.size();
  droplets.emplace_back();

  // The crown: "all quadrangular pyramids prepared for the scattering model", as many as on the deepest puddle that
  // scatters; they fall back whole. "Initial conditions ... by the attributes of a fallen waterdrop": as fast as it
  // was.
  const SplashRanges many = splash_ranges(GroundMaterial::asphalt, Wetness::puddle_5mm, size);
  const SplashRanges r = splash_ranges(impact.material, impact.wetness, size);
  const int number = number_within(draws, many.number_mean, many.number_sigma, many.fewest, many.most);
  const double between = 2 * kPi / number, first = 2 * kPi * draws.uniform();
  splash.width = kCrownWidth * splash.circle * static_cast<float>(between);
  const double against = std::abs(glm::dot(impact.velocity, impact.normal));
  const double mean = std::clamp<double>(kCrownSpeed * against, r.slowest, r.fastest);
  for (int i = 0; i < number; ++i) {
    const double speed = normal_within(draws, mean, kCrownSpeedSigma * mean, r.slowest, r.fastest);
    const double angle = normal_within(draws, kCrownAngle, kCrownAngleSigma, kCrownLowest, kCrownHighest);
    Droplet tip = pile(impact, frame, splash.circle, first + between * i, 0, speed, angle * kPi / 180, kCarriedByCrown);
    fly(tip, kCrownTip * impact.diameter, impact.wind, impact.normal, options.gravity, kCrownPart * options.most_time);
    tip.leaves = tip.lands;
    splash.cone_starts = std::max(splash.cone_starts, tip.lands);
    droplets.push_back(tip);
  }

  // The cone, "after disappearance of the crown-shape water splash". Its tip goes up at the speed of table 1; the drop
  // leaves it at the highest point and moves "in the perpendicular direction" only: no wind.
  Droplet& drop = droplets[cone];
  const double volume =
      kPi / 6 * std::pow(static_cast<double>(impact.diameter), 3) * flying_share(splash.kind, impact.wetness);
  drop.radius = radius_of(volume);
  drop.start = impact.point;
  const float speed = static_cast<float>(normal_within(draws, r.speed_mean, r.speed_sigma, r.slowest, r.fastest));
  const bool level = glm::dot(impact.normal, options.up) > 0.5f;
  const vec3 direction = level ? options.up : impact.normal;
  drop.velocity = direction * speed;
  fly(drop, drop.radius, vec3(0.0f), direction, options.gravity, options.most_time - kLandFade - splash.cone_starts);
  // Up until v exp(-k t) = g (1 - exp(-k t)) / k; what never turns is let go halfway.
  const float gravity = -glm::dot(options.gravity, direction);
  float top = 0.5f * drop.lands;
  if (gravity > 0)
    top = std::min(top, drop.drag * speed < 1e-4f * gravity ? speed / gravity
                                                            : std::log1p(drop.drag * speed / gravity) / drop.drag);
  drop.leaves = splash.cone_starts + top;
  drop.lands += splash.cone_starts;
  splash.ends = drop.lands + kLandFade;
}

/// Bounds of speed and way of all droplets of a splash.
void bound(Splash& splash, const SplashOptions& options, std::span<const Droplet> droplets) {
  const vec3 n = splash.impact.normal;
  float away = 0;
  for (const Droplet& droplet : droplets) {
    const bool of_cone = splash.kind == SplashKind::crown_cone && &droplet == droplets.data();
    const vec3 wind = of_cone ? vec3(0.0f) : splash.impact.wind;
    const float time = of_cone ? droplet.lands - splash.cone_starts : droplet.lands;
    // Along and away from the surface each part of orbit_offset() only grows, so that its end bounds it ...
    const float x = droplet.drag * time;
    const float own = time * formulas::decay_mean(x), blown = time - own,
                fallen = time * time * formulas::decay_rest(x);
    const auto along = [&](vec3 v) { return glm::length(v - n * glm::dot(v, n)); };
    const float side = along(droplet.velocity) * own + along(wind) * blown + along(options.gravity) * fallen;
    const float v = glm::dot(droplet.velocity, n), w = glm::dot(wind, n), g = glm::dot(options.gravity, n);
    // ... but what comes down again is never higher than without drag and wind, where those do not lift it.
    float up = std::abs(v) * own + std::abs(w) * blown + std::abs(g) * fallen;
    if (g < 0 && w <= 0 && droplet.lands < options.most_time - 2 * kLandFade) up = std::min(up, -v * v / (2 * g));
    away = std::max(away, std::sqrt(side * side + up * up));
    splash.fastest = std::max(splash.fastest,
                              glm::length(droplet.velocity) + glm::length(wind) + glm::length(options.gravity) * own);
    splash.reach = std::max(splash.reach, options.size * droplet.radius);
  }
  const float cone = splash.kind == SplashKind::crown_cone ? options.size * kConeWidth * splash.impact.diameter : 0;
  splash.reach = 1.001f * (away + splash.circle + std::max({splash.reach, splash.width, cone}));
  splash.fastest *= 1.001f;
}

}  // namespace

float flying_share(SplashKind kind, Wetness wetness) {
  if (kind == SplashKind::crown_cone) return 0.3f;
  if (kind != SplashKind::scattering) return 0;
  return wetness == Wetness::wet ? 0.3f : wetness == Wetness::puddle_3mm ? 0.6f : 0.9f;
}

double volume_of(const Droplet& droplet) {
  const double r = droplet.radius;
  return 4 * kPi / 3 * r * r * r;
}

Splash make_splash(const Impact& impact, const SplashOptions& options, std::vector<Droplet>& droplets) {
  Splash splash;
  splash.impact = impact;
  splash.kind = splash_kind(impact.material, impact.wetness);
  splash.first = droplets.size();
  if (splash.kind == SplashKind::none) return splash;
  splash.circle = options.size * circle_of(impact, splash.kind);
  Draws draws(options.seed, impact.id);
  if (splash.kind == SplashKind::scattering) scatter(splash, options, draws, droplets);
  if (splash.kind == SplashKind::crown_cone) crown_and_cone(splash, options, draws, droplets);
  if (splash.kind == SplashKind::disk) splash.ends = options.most_time;
  splash.count = droplets.size() - splash.first;
  bound(splash, options, std::span(droplets).subspan(splash.first));
  return splash;
}

}  // namespace meniscus
