#include <gtest/gtest.h>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "fixtures.h"
#include "shading/caustics_map.h"

namespace meniscus {
namespace {

const vec3 kUp{0, 1, 0};
constexpr double kRadius = 0.2;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A ball of water, over a pool on the square |x|, |z| <= 1 if `level` is above the floor at y = 0.
class BallOverPool : public Surface {
 public:
  BallOverPool(double height, double level) : height_(height), level_(level) {}

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes*) const override {
    const int width = points.empty() ? view.width : static_cast<int>(points.size());
    const int rows = points.empty() ? view.height : 1;
    SurfaceBuffers seen;
    seen.depth = Image<float>(width, rows, kInfinity);
    seen.normal = Image<vec3>(width, rows);
    seen.thickness = Image<float>(width, rows);
    seen.coverage = Image<float>(width, rows);
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < width; ++x) {
        const Ray ray = view.ray(points.empty() ? vec2{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}
                                                : points[static_cast<std::size_t>(x)]);
        const Crossing in = cross(ray, 0, false);
        if (!(in.distance < kInfinity)) continue;
        seen.depth(x, y) = in.distance;
        seen.normal(x, y) = in.normal;
        seen.coverage(x, y) = 1;
        // Water on the whole ray, of ball and pool.
        double thickness =
            static_cast<double>(std::min(cross(ray, in.distance + 1e-4f, true).distance, 10.0f) - in.distance);
        if (level_ > 0 && in.normal != kUp) thickness += level_ / -static_cast<double>(ray.direction.y);
        seen.thickness(x, y) = in.normal == kUp ? static_cast<float>(level_ / -static_cast<double>(ray.direction.y))
                                                : static_cast<float>(thickness);
      }
    return seen;
  }
  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes*) const override {
    return see(view, points, nullptr).thickness;
  }
  bool can_march() const override { return true; }
  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      found[i] = cross(rays[i], from[i], inside[i] != 0);
      if (found[i].distance > limit[i]) found[i] = {};
    }
  }
  Bounds bounds() const override {
    Bounds box;
    const float half = level_ > 0 ? 1.0f : static_cast<float>(kRadius);
    box.add({-half, level_ > 0 ? 0.0f : static_cast<float>(height_ - kRadius), -half});
    box.add({half, static_cast<float>(height_ + kRadius), half});
    return box;
  }

 private:
  Crossing cross(const Ray& ray, float from, bool inside) const {
    const glm::dvec3 o = glm::dvec3(ray.origin) - glm::dvec3(0, height_, 0), d(ray.direction);
    const double near = static_cast<double>(from) + 1e-5;
    Crossing first;
    const double along = glm::dot(o, d), root = along * along - glm::dot(o, o) + kRadius * kRadius;
    if (root > 0) {
      const double t = inside ? -along + std::sqrt(root) : -along - std::sqrt(root);
      if (t > near) first = {static_cast<float>(t), vec3((o + t * d) / kRadius)};
    }
    if (level_ > 0 && (inside ? d.y > 0 : d.y < 0)) {
      const double t = (level_ - height_ - o.y) / d.y;
      const glm::dvec3 p = o + t * d;
      if (t > near && t < static_cast<double>(first.distance) && std::abs(p.x) <= 1 && std::abs(p.z) <= 1)
        first = {static_cast<float>(t), kUp};
    }
    return first;
  }
  double height_, level_;
};

Scene floor_at(float height) {
  EnvironmentOptions options;
  options.sun_direction = kUp;
  Ground ground;
  ground.height = height;
  return Scene(Environment(options), ground);
}

LightCast cast(const Surface& water, const Scene& scene, const Material& material, bool single = false) {
  const Bounds box = casting_box(water, {});
  CausticsOptions options;
  options.screen_width = 200;
  options.exact_hits = true;
  options.single_interface = single;
  return cast_light(water, caustics_lights(scene, box, 1).at(0), box, scene, material, options, nullptr, true);
}

TEST(BallOfWater, BendsLightTwiceAsASphereDoes) {
  const double n = static_cast<double>(tests::clear().ior), above = 0.45;
  const LightCast light = cast(BallOverPool(above, 0), floor_at(0), tests::clear());
  std::size_t followed = 0;
  for (const LightLanding& landing : light.landings) {
    if (landing.state != LandingState::landed) continue;
    const vec2 from{landing.from.x, landing.from.z}, to{landing.point.x, landing.point.z};
    const double h = static_cast<double>(glm::length(from));
    if (h < 0.01 * kRadius || h > 0.95 * kRadius) continue;
    // A ray at h from the axis is turned by 2 (a - b) and passes the centre at h again.
    const double a = std::asin(h / kRadius), b = std::asin(h / kRadius / n), turned = 2 * (a - b);
    const double expected = h / std::cos(turned) - above * std::tan(turned);
    EXPECT_NEAR(static_cast<double>(glm::dot(to, from)) / h, expected, 2e-3 * kRadius) << h;
    EXPECT_NEAR(static_cast<double>(landing.path), 2 * kRadius * std::cos(b), 2e-3 * kRadius);
    EXPECT_NEAR(static_cast<double>(landing.later), 1 - tests::reflectance(a, n), 2e-3);
    ++followed;
  }
  EXPECT_GT(followed, 10'000u);
}

TEST(BallOfWater, FocusesAtItsBackFocalDistance) {
  const double n = static_cast<double>(tests::clear().ior), focal = n * kRadius / (2 * (n - 1));
  // Rays near the axis come together there, and nowhere before or behind.
  const auto widest = [&](double distance) {
    const LightCast light = cast(BallOverPool(distance, 0), floor_at(0), tests::clear());
    double result = 0;
    for (const LightLanding& landing : light.landings)
      if (landing.state == LandingState::landed &&
          glm::length(vec2{landing.from.x, landing.from.z}) < 0.15f * static_cast<float>(kRadius))
        result = std::max(result, static_cast<double>(glm::length(vec2{landing.point.x, landing.point.z})));
    return result / kRadius;
  };
  EXPECT_LT(widest(focal), 0.004);
  EXPECT_GT(widest(0.8 * focal), 0.02);
  EXPECT_GT(widest(1.2 * focal), 0.02);
}

TEST(BallOfWater, LosesNoLight) {
  const LightCast light = cast(BallOverPool(0.45, 0), floor_at(0), tests::clear());
  const LightBalance& b = light.balance;
  EXPECT_NEAR((b.drawn + b.hidden + b.grazing + b.absorbed + b.mirrored + b.trapped + b.lost) / b.entered, 1.0, 1e-6);
  EXPECT_NEAR(b.absorbed / b.entered, 0.0, 1e-6);
  EXPECT_LT((b.trapped + b.lost) / b.entered, 0.01);
  const vec3 drawn = light.maps.at(0).power();
  EXPECT_NEAR(static_cast<double>(drawn.x + drawn.y + drawn.z) / b.drawn, 1.0, 0.05);  // some goes far beyond the map
  // What the disc of the ball lets in, by rings.
  const double n = static_cast<double>(tests::clear().ior);
  double entered = 0, left = 0;
  constexpr int kRings = 20'000;
  for (int i = 0; i < kRings; ++i) {
    const double s = (i + 0.5) / kRings, passes = 1 - tests::reflectance(std::asin(s), n);
    entered += 2 * s / kRings * passes;
    left += 2 * s / kRings * passes * passes;
  }
  EXPECT_NEAR(b.drawn / b.entered, left / entered, 0.003);
}

TEST(BallOfWater, AbsorbsOnlyInside) {
  Material tinted = tests::clear();
  tinted.extinction = vec3{2.0f};
  const double n = static_cast<double>(tinted.ior);
  const LightCast clear = cast(BallOverPool(1.5, 0), floor_at(0), tests::clear());
  const LightCast dark = cast(BallOverPool(1.5, 0), floor_at(0), tinted);
  double plain = 0, absorbed = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double s = (i + 0.5) / 20'000, passes = std::pow(1 - tests::reflectance(std::asin(s), n), 2);
    plain += s * passes;
    absorbed += s * passes * std::exp(-2 * 2 * kRadius * std::cos(std::asin(s / n)));
  }
  EXPECT_NEAR(dark.balance.drawn / clear.balance.drawn, absorbed / plain, 0.003);
}

TEST(DropOverThePool, ThrowsNoFalseShadow) {
  const auto landed = [](const LightCast& light) { return light.balance.drawn / light.balance.entered; };
  const LightCast both = cast(BallOverPool(0.425, 0.1), floor_at(0), tests::clear());  // the floor is in focus
  EXPECT_GT(landed(both), 0.985);  // the rest is mirrored at second and third interfaces, or beyond the map
  // Behind the drop the floor is brighter than beside it, and the light came out and in again.
  const float beside = both.maps.at(0).irradiance({0.7f, 0, 0.7f}, kUp).x;
  EXPECT_GT(both.maps.at(0).irradiance({0, 0, 0}, kUp).x, 2 * beside);
  const LightLanding& axis = both.landings(both.landings.width() / 2, both.landings.height() / 2);
  EXPECT_EQ(axis.way, 1 * 4 + 3);
  EXPECT_NEAR(axis.path, 2 * kRadius + 0.1, 5e-3);
}

TEST(DropOverThePool, CastsTheSameBitsForAnyNumberOfThreads) {
  std::vector<std::vector<vec3>> results;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const LightCast light = cast(BallOverPool(0.425, 0.1), floor_at(0), tests::clear());
    results.emplace_back(light.maps.at(0).texels().begin(), light.maps.at(0).texels().end());
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST(DropOverThePool, IsPartOfThePoolWithASingleInterface) {
  const LightCast single = cast(BallOverPool(0.9, 0.4), floor_at(0), tests::clear(), true);
  for (const LightLanding& landing : single.landings) {
    EXPECT_EQ(landing.way, 0);
    EXPECT_EQ(landing.later, 1.0f);
  }
}

/// Flat water that hardly bends or mirrors light: what it takes of the unbent light it brings bent.
TEST(FlatPool, HasNeitherABrightNorADarkEdge) {
  class Slab : public BallOverPool {
   public:
    Slab() : BallOverPool(-9, 0.02) {}
    bool can_march() const override { return false; }
    Bounds bounds() const override {
      Bounds box;
      box.add({-1, 0, -1});
      box.add({1, 0.02f, 1});
      return box;
    }
  };
  for (const vec3 sun : {vec3{0, 1, 0}, vec3{0.31f, 1, 0.17f}}) {
    EnvironmentOptions options;
    options.sun_direction = sun;
    const Scene scene(Environment(options), Ground{});
    CausticsOptions caustics_options;
    caustics_options.screen_width = 128;
    caustics_options.single_interface = true;
    const auto light = caustics(Slab(), scene, tests::clear(1.0005f), caustics_options);
    const float all = scene.environment().sun_irradiance().x * scene.environment().sun_direction().y;
    float least = 1e9f, most = 0;
    for (int i = 0; i <= 400; ++i) {
      // Across the edges and a corner, in the water's shadow by the sun.
      const float x = -1.3f + 2.6f * static_cast<float>(i) / 400;
      for (const vec3 point : {vec3{x, 0, 0.123f}, vec3{-0.321f, 0, x}, vec3{x, 0, x}}) {
        const WaterLight::Light at = light->at(point, kUp);
        const float sum = at.refracted.x / all + at.sun.x;
        least = std::min(least, sum);
        most = std::max(most, sum);
      }
    }
    EXPECT_GT(least, 0.82f);
    EXPECT_LT(most, 1.18f);
  }
}

TEST(UnbentLight, FadesOverAPointAndAHalfAtASlantedEdge) {
  // Water below a line through the picture; coverage as its points have it.
  const View view = orthographic_view({0, 2, 0}, {0, 0, 0}, {0, 0, -1}, 1.0f, 64, 64);
  Image<float> depth(64, 64, kInfinity), coverage(64, 64);
  const auto edge = [](float x) { return 20.3f + 0.17f * x; };
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      coverage(x, y) = std::clamp(static_cast<float>(y) + 0.5f - edge(static_cast<float>(x) + 0.5f) + 0.5f, 0.0f, 1.0f);
      if (coverage(x, y) > 0) depth(x, y) = 1;
    }
  const UnbentLight light(view, depth, coverage);
  // The edge is where half of the light arrives, without stairs, and as wide everywhere.
  for (float x = 10; x < 50; x += 0.37f) {
    const auto at = [&](float offset) {
      const Ray ray = view.ray({x, edge(x) + offset});
      return light.fraction(ray.origin + 2.0f * ray.direction);
    };
    EXPECT_NEAR(at(0), 0.5f, 0.03f);
    EXPECT_NEAR(at(-0.75f), 0.87f, 0.07f);
    EXPECT_NEAR(at(0.75f), 0.13f, 0.07f);
    EXPECT_EQ(at(-3), 1.0f);
    EXPECT_EQ(at(3), 0.0f);
  }
}

}  // namespace
}  // namespace meniscus
