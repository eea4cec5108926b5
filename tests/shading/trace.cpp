// Rays followed through bodies of water whose optics are known in closed form.
#include <gtest/gtest.h>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>

#include "fixtures.h"
#include "meniscus/formulas/optics.h"

namespace meniscus {
namespace {

using namespace tests;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Water between the zeros of a convex body's boundary: a list of intervals along any ray, each with its normals.
class AnalyticWater : public Surface {
 public:
  struct Span {
    float enter, leave;
    vec3 enter_normal, leave_normal;
  };
  using Spans = std::function<std::vector<Span>(const Ray&)>;  ///< in rising order

  explicit AnalyticWater(Spans spans) : spans_(std::move(spans)) {}

  SurfaceBuffers see(const View& view, std::span<const vec2>, StageTimes*) const override {
    SurfaceBuffers seen;
    seen.depth = Image<float>(view.width, view.height, kInfinity);
    seen.normal = Image<vec3>(view.width, view.height, vec3{0});
    seen.thickness = Image<float>(view.width, view.height, 0.0f);
    seen.coverage = Image<float>(view.width, view.height, 0.0f);
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        for (const Span& span : spans_(ray)) {
          if (span.leave <= 0) continue;
          if (!(seen.depth(x, y) < kInfinity)) {
            seen.eye_in_water = span.enter < 0;
            seen.depth(x, y) = seen.eye_in_water ? span.leave : span.enter;
            seen.normal(x, y) = seen.eye_in_water ? span.leave_normal : span.enter_normal;
            seen.coverage(x, y) = 1;
          }
          seen.thickness(x, y) += span.leave - std::max(span.enter, 0.0f);
        }
      }
    return seen;
  }
  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    return see(view, points, times).thickness;
  }
  bool can_march() const override { return true; }
  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      found[i] = {};
      for (const Span& span : spans_(rays[i])) {
        const float t = inside[i] ? span.leave : span.enter;
        if (!(t >= from[i] + 1e-4f)) continue;
        if (t <= limit[i]) found[i] = {t, inside[i] ? span.leave_normal : span.enter_normal};
        break;
      }
    }
  }
  Bounds bounds() const override { return {vec3{-10}, vec3{10}}; }

 private:
  Spans spans_;
};

AnalyticWater balls(std::vector<vec3> centres, float radius) {
  return AnalyticWater([=](const Ray& ray) {
    std::vector<AnalyticWater::Span> spans;
    for (const vec3 centre : centres) {
      const glm::dvec3 o(ray.origin - centre), d(ray.direction);
      const double middle = -glm::dot(o, d),
                   half2 = radius * static_cast<double>(radius) - glm::dot(o + middle * d, o + middle * d);
      if (half2 <= 0) continue;
      const double a = middle - std::sqrt(half2), b = middle + std::sqrt(half2);
      const auto normal = [&](double t) { return glm::normalize(vec3(o + t * d)); };
      spans.push_back({static_cast<float>(a), static_cast<float>(b), normal(a), normal(b)});
    }
    std::sort(spans.begin(), spans.end(), [](const auto& a, const auto& b) { return a.enter < b.enter; });
    return spans;
  });
}

/// Water between two levels.
AnalyticWater slab(float low, float high) {
  return AnalyticWater([=](const Ray& ray) -> std::vector<AnalyticWater::Span> {
    if (std::abs(ray.direction.y) < 1e-9f) return {};
    const float a = (low - ray.origin.y) / ray.direction.y, b = (high - ray.origin.y) / ray.direction.y;
    const vec3 up{0, 1, 0};
    if (a < b) return {{a, b, -up, up}};
    return {{b, a, up, -up}};
  });
}

/// A sky whose colour tells the direction, smooth and without a sun.
Environment telling_environment() {
  const TemporaryFile file(flat_hdr(256, 128, [](int x, int y) {
    const double azimuth = (x + 0.5) / 256 * 2 * 3.14159265358979, polar = (y + 0.5) / 128 * 3.14159265358979;
    return vec3{static_cast<float>(1.0 + 0.5 * std::cos(azimuth) * std::sin(polar)),
                static_cast<float>(1.0 + 0.9 * std::cos(polar)),
                static_cast<float>(1.0 + 0.5 * std::sin(azimuth) * std::sin(polar))};
  }));
  EnvironmentOptions options;
  options.hdr_path = file.path();
  return Environment(options);
}

OpticsInputs traced(const Surface& surface, int bounces = 8) {
  OpticsInputs inputs;
  inputs.options.refraction = RefractionMethod::ray_traced;
  inputs.options.bounces = bounces;
  inputs.surface = &surface;
  return inputs;
}

Image<vec3> picture_of(const Surface& surface, const View& view, const Scene& scene, const Material& material,
                       int bounces = 8) {
  SurfaceBuffers seen = surface.see(view);
  return shade(view, {}, seen, scene, material, traced(surface, bounces));
}

/// Normals of a curved body widen beams; the closed form knows no beams.
View close_up(vec3 from, vec3 to, int size = 24) { return perspective_view(from, to, {0, 1, 0}, 2e-4f, size, size); }

/// All light that leaves a ball along one ray, by the double-precision series of its internal reflections.
glm::dvec3 through_ball(const Ray& ray, double radius, double ior, glm::dvec3 extinction, const Environment& sky,
                        int interfaces) {
  glm::dvec3 o(ray.origin), d(ray.direction), sum{0}, weight{1};
  const auto fresnel = [](double cos_i, double eta) {
    const double s2 = (1 - cos_i * cos_i) / (eta * eta);
    if (s2 >= 1) return std::pair{1.0, 0.0};
    const double cos_t = std::sqrt(1 - s2);
    const double rs = (cos_i - eta * cos_t) / (cos_i + eta * cos_t), rp = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return std::pair{0.5 * (rs * rs + rp * rp), cos_t};
  };
  const auto sky_at = [&](glm::dvec3 direction) { return glm::dvec3(sky.radiance(glm::normalize(vec3(direction)))); };
  const double middle = -glm::dot(o, d);
  const glm::dvec3 across = o + middle * d;
  const double half = std::sqrt(radius * radius - glm::dot(across, across));
  glm::dvec3 p = o + (middle - half) * d, n = p / radius;
  const double cos_i = -glm::dot(d, n);
  const auto [r, cos_t] = fresnel(cos_i, ior);
  sum += r * sky_at(d + 2 * cos_i * n);
  weight *= 1 - r;
  d = d / ior + (cos_i / ior - cos_t) * n;
  const double chord = 2 * radius * cos_t;
  for (int k = 1; k < interfaces; ++k) {
    for (int c = 0; c < 3; ++c) weight[c] *= std::exp(-extinction[c] * chord);
    p += chord * d;
    n = -p / radius;
    const auto [inner, cos_out] = fresnel(cos_t, 1 / ior);
    sum += weight * (1 - inner) * sky_at(d * ior + (cos_t * ior - cos_out) * n);
    weight *= inner;
    d += 2 * cos_t * n;
  }
  return sum;
}

TEST(RayTraced, ShowsTheWorldThroughABallAsTheClosedFormDoes) {
  const Environment sky = telling_environment();
  const Scene scene = without_ground(sky);
  const AnalyticWater water = balls({vec3{0}}, 1.0f);
  Material material = clear();
  material.extinction = {0.1f, 0.3f, 0.7f};
  for (const float off : {0.0f, 0.3f, 0.6f, 0.9f}) {
    const View view = close_up({4, 1, 3}, vec3{0, off, 0}, 8);
    const Image<vec3> picture = picture_of(water, view, scene, material);
    const Ray ray = view.ray({4.5f, 4.5f});
    const glm::dvec3 expected =
        through_ball(ray, 1.0, static_cast<double>(material.ior), glm::dvec3(material.extinction), sky, 12);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(picture(4, 4)[k], expected[k], 0.012) << off << " " << k;
    // Which tells a ball from a bare interface.
    const Image<vec3> single = picture_of(water, view, scene, material, 1);
    EXPECT_GT(glm::length(single(4, 4) - vec3(expected)), off > 0.5f ? 0.05f : 0.0f);
  }
}

TEST(RayTraced, ShowsTheWorldUpsideDownInADrop) {
  // White above, black below: the drop's lower half is white, its upper half black.
  const Scene scene = without_ground(half_lit_environment());
  const AnalyticWater water = balls({vec3{0}}, 0.1f);
  const View view = perspective_view({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 0.12f, 65, 65);
  const Image<vec3> picture = picture_of(water, view, scene, clear());
  EXPECT_LT(picture(32, 20).y, 0.2f);
  EXPECT_GT(picture(32, 44).y, 0.8f);
}

TEST(RayTraced, GivesTheRayItsDirectionBackBehindASlab) {
  // Parallel faces: the chequered ground is seen along the first direction, displaced sideways.
  Ground ground;
  ground.square = 0.5f;
  ground.height = -3;
  ground.albedo = {1, 0, 0};
  ground.second_albedo = {0, 0, 1};
  const Scene scene(uniform_environment(vec3{1}), ground);
  const AnalyticWater water = slab(0.0f, 0.8f);
  Material material = clear();
  material.specular = 0;
  int different = 0;
  for (const float angle : {0.2f, 0.6f, 1.0f}) {
    const vec3 direction{std::sin(angle), -std::cos(angle), 0.04f};
    const View view = looking(direction, 9, 9);
    const Ray ray = view.ray({4.5f, 4.5f});
    const double sin_i = std::sqrt(1.0 - std::pow(static_cast<double>(ray.direction.y), 2)), sin_t = sin_i / 1.333;
    const double aside = 0.8 * (sin_i / -static_cast<double>(ray.direction.y) - sin_t / std::sqrt(1 - sin_t * sin_t));
    const vec3 flat = glm::normalize(vec3{ray.direction.x, 0, ray.direction.z});
    const vec3 expected = scene.radiance({ray.origin - static_cast<float>(aside) * flat, ray.direction}, 1e-5f);
    const vec3 straight = scene.radiance(ray, 1e-5f);
    different += glm::length(expected - straight) > 0.5f;
    EXPECT_LT(glm::length(picture_of(water, view, scene, material)(4, 4) - expected), 0.02f) << angle;
  }
  EXPECT_GT(different, 0) << "the test must tell displaced from straight";
}

TEST(RayTraced, ReflectsTotallyInside) {
  // Through the front face of a long block one sees its upper face from below, beyond the critical angle: the dark
  // ground below is mirrored there, and nothing of the white sky.
  const Scene scene = without_ground(half_lit_environment());
  const AnalyticWater block([](const Ray& ray) -> std::vector<AnalyticWater::Span> {
    float enter = -kInfinity, leave = kInfinity;
    vec3 enter_normal{0}, leave_normal{0};
    const vec3 low{-50, -3, -20}, high{50, 0, 0};
    for (int k = 0; k < 3; ++k) {
      const float d = ray.direction[k];
      if (d == 0) continue;
      const float a = ((d > 0 ? low : high)[k] - ray.origin[k]) / d, b = ((d > 0 ? high : low)[k] - ray.origin[k]) / d;
      vec3 n{0};
      n[k] = d > 0 ? 1.0f : -1.0f;
      if (a > enter) enter = a, enter_normal = -n;
      if (b < leave) leave = b, leave_normal = n;
    }
    if (!(enter < leave)) return {};
    return {{enter, leave, enter_normal, leave_normal}};
  });
  Material material = clear();
  material.specular = 0;
  // 30 degrees upwards in the air are 22 in the water: 68 from the vertical; then down and out below: total as well.
  const View view = perspective_view({0, -1.5f, 1}, {0, -1.5f + std::tan(0.5236f), 0}, {0, 1, 0}, 1e-3f, 5, 5);
  EXPECT_LT(picture_of(block, view, scene, material)(2, 2).y, 0.05f);
  const View single = perspective_view({0, -1.5f, 1}, {0, -1.5f + std::tan(0.5236f), 0}, {0, 1, 0}, 1e-3f, 5, 5);
  EXPECT_GT(picture_of(block, single, scene, material, 1)(2, 2).y, 0.95f) << "a single interface shows the sky";
}

TEST(RayTraced, IsAWhiteFurnaceForClearWater) {
  const Scene scene = without_ground(uniform_environment());
  const AnalyticWater row = balls({{0, 0, 0}, {0.1f, 0.15f, -2.3f}, {-0.2f, 0.4f, -4.7f}, {0.5f, 0.9f, -7}}, 1.0f);
  const View view = perspective_view({0, 0.2f, 5}, {0, 0, 0}, {0, 1, 0}, 0.6f, 61, 47);
  const View inside = perspective_view({0.2f, 0.3f, 0.1f}, {1, 1, -3}, {0, 1, 0}, 1.2f, 31, 27);
  for (const int bounces : {1, 2, 3, 8, 64})
    for (const View& from : {view, inside})
      for (const float specular : {1.0f, 0.5f, 0.0f}) {
        Material material = clear();
        material.specular = specular;
        for (const vec3& radiance : picture_of(row, from, scene, material, bounces))
          ASSERT_LT(glm::length(radiance - vec3{1}), 2e-3f) << bounces << " " << specular;
      }
}

TEST(RayTraced, GoesThroughSeveralDropsInARow) {
  // Straight through the middles: two interfaces a drop, each with 2 % reflection; a black world but for a white sky
  // ahead tells how much comes through. Absorption counts the water only.
  const Scene scene = without_ground(uniform_environment());
  const AnalyticWater row = balls({{0, 0, 0}, {0, 0, -3}, {0, 0, -6}}, 1.0f);
  const View view = close_up({0, 0, 5}, {0, 0, 0}, 5);
  Material material = clear();
  material.extinction = {0.0f, 0.1f, 0.3f};
  material.specular = 0;
  const vec3 seen = picture_of(row, view, scene, material)(2, 2);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(seen[k], std::exp(-6.0 * static_cast<double>(material.extinction[k])), 2e-3) << k;
}

TEST(RayTraced, StopsAtSolidsInTheWater) {
  // A floor in a deep slab: its light through the water above it.
  Ground ground;
  ground.height = -0.5f;
  ground.albedo = vec3{0.6f};
  const Scene scene(uniform_environment(), ground);
  const AnalyticWater water = slab(-5.0f, 0.0f);
  Material material = clear();
  material.extinction = {0.5f, 1.0f, 2.0f};
  for (const float angle : {0.0f, 0.5f, 1.0f}) {
    const View view = looking({std::sin(angle), -std::cos(angle), 0});
    const vec3 seen = picture_of(water, view, scene, material)(4, 3);
    const double r = reflectance(angle, 1.333), cos_t = std::sqrt(1 - std::pow(std::sin(angle) / 1.333, 2));
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(seen[k], r + (1 - r) * 0.6 * std::exp(-static_cast<double>(material.extinction[k]) * 0.5 / cos_t),
                  1e-3);
  }
}

TEST(RayTraced, ShowsOtherWaterInTheMirror) {
  // A slab's surface mirrors an ink ball above it; the method without marching shows the sky there.
  const Scene scene = without_ground(uniform_environment());
  const AnalyticWater water([](const Ray& ray) {
    std::vector<AnalyticWater::Span> spans;
    if (std::abs(ray.direction.y) > 1e-9f) {
      const float a = (-9 - ray.origin.y) / ray.direction.y, b = (0 - ray.origin.y) / ray.direction.y;
      const vec3 up{0, 1, 0};
      spans.push_back(a < b ? AnalyticWater::Span{a, b, -up, up} : AnalyticWater::Span{b, a, up, -up});
    }
    const vec3 o = ray.origin - vec3{1, 1, 0};
    const float middle = -glm::dot(o, ray.direction);
    const vec3 across = o + middle * ray.direction;
    const float half2 = 0.25f - glm::dot(across, across);
    if (half2 > 0) {
      const float a = middle - std::sqrt(half2), b = middle + std::sqrt(half2);
      spans.push_back({a, b, (o + a * ray.direction) / 0.5f, (o + b * ray.direction) / 0.5f});
    }
    std::sort(spans.begin(), spans.end(), [](const auto& p, const auto& q) { return p.enter < q.enter; });
    return spans;
  });
  Material ink = clear();
  ink.extinction = vec3{1e4f};
  // Down at 45 degrees onto the origin, up at 45 degrees into the ball's middle.
  const View view = close_up({-2, 2, 0}, {0, 0, 0}, 5);
  const double r = reflectance(0.785398, 1.333), normal = reflectance(0, 1.333);
  EXPECT_NEAR(picture_of(water, view, scene, ink)(2, 2).y, r * normal, 2e-3);
  EXPECT_NEAR(picture_of(water, view, scene, ink, 1)(2, 2).y, r, 2e-3);
}

TEST(RayTraced, LooksOutOfTheWaterThroughSnellsWindow) {
  const Scene scene = without_ground(half_lit_environment());
  const AnalyticWater water = slab(-50.0f, 0.0f);
  for (const float angle : {0.1f, 0.5f, 0.75f, 0.95f, 1.2f}) {
    const View view = perspective_view({0, -1, 0}, {std::sin(angle), -1 + std::cos(angle), 0}, {0, 0, 1}, 1e-3f, 5, 5);
    const vec3 seen = picture_of(water, view, scene, clear(), 1)(2, 2);
    const bool within = std::sin(angle) * 1.333f < 1.0f;
    EXPECT_NEAR(seen.y, within ? 1.0 - reflectance(angle, 1.0 / 1.333) : 0.0, 3e-3) << angle;
  }
}

TEST(RayTraced, IsTheSameForAnyNumberOfThreadsAndWithRealParticles) {
  Particles particles;
  for (int z = 0; z < 12; ++z)
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 12; ++x) {
        const float wobble = 0.3f * std::sin(static_cast<float>(x * 7 + y * 3 + z * 11));
        particles.x.push_back(0.05f * (static_cast<float>(x) + wobble));
        particles.y.push_back(0.05f * (static_cast<float>(y) - wobble));
        particles.z.push_back(0.05f * (static_cast<float>(z) + 0.5f * wobble));
      }
  RaycastOptions options;
  options.spacing = 0.05f;
  const auto surface = make_raycast_surface(particles, options);
  Ground ground;
  ground.square = 0.2f;
  ground.height = -0.03f;
  const Scene scene(Environment{EnvironmentOptions{}}, ground);
  const View view = perspective_view({1.2f, 0.9f, 1.5f}, {0.3f, 0.2f, 0.3f}, {0, 1, 0}, 0.5f, 70, 50);
  const SurfaceBuffers seen = surface->see(view);
  Image<vec3> first;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const Image<vec3> picture = shade(view, {}, seen, scene, material_preset("water", 0.4f), traced(*surface));
    for (const vec3& radiance : picture) ASSERT_TRUE(radiance.x >= 0 && radiance.x + radiance.y + radiance.z < 1e4f);
    if (first.empty()) first = picture;
    ASSERT_EQ(std::memcmp(first.data(), picture.data(), picture.size() * sizeof(vec3)), 0) << threads;
  }
  // Under even light nothing of clear water is seen, whatever its shape.
  const Scene even_light = without_ground(uniform_environment());
  for (const vec3& radiance : shade(view, {}, seen, even_light, clear(), traced(*surface)))
    ASSERT_LT(glm::length(radiance - vec3{1}), 2e-3f);
}

TEST(RayTraced, NeedsASurfaceThatCanBeFollowed) {
  const Scene scene = without_ground(uniform_environment());
  const View view = looking({0, -1, 0});
  OpticsInputs inputs;
  inputs.options.refraction = RefractionMethod::ray_traced;
  EXPECT_THROW(shade(view, {}, even(8, 6, 5, {0, 1, 0}, 1), scene, clear(), inputs), Error);
}

}  // namespace
}  // namespace meniscus
