// The bilateral filter of the normal map.
#include "surface/fixtures.h"
#include "surface/normal_filter.h"

namespace meniscus {
namespace {

using namespace surface_tests;

constexpr float kTolerance = 0.5f * kSpacing;

/// A picture of surfaces given by their depth and normal at each pixel.
struct Picture {
  View view;
  Image<float> depth;
  Image<vec3> normal;
};

/// An orthographic picture of pixels a quarter of a spacing wide that looks down along z from height 1.
Picture picture(int width, int height, const std::function<float(vec2)>& height_at,
                const std::function<vec3(vec2)>& normal_at) {
  Picture p{
      orthographic_view({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 0.25f * kSpacing * static_cast<float>(height), width, height),
      Image<float>(width, height), Image<vec3>(width, height)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const vec3 from = pixel_ray(p.view, x, y).origin;
      p.depth(x, y) = 1.0f - height_at({from.x, from.y});
      p.normal(x, y) = p.depth(x, y) < kInfinity ? glm::normalize(normal_at({from.x, from.y})) : vec3{0};
    }
  return p;
}

/// The header's formula in double precision.
glm::dvec3 expected(const Picture& p, int x, int y, int radius) {
  const auto point = [&](int i, int j) {
    const Ray ray = pixel_ray(p.view, i, j);
    return glm::dvec3(ray.origin) + static_cast<double>(p.depth(i, j)) * glm::dvec3(ray.direction);
  };
  const glm::dvec3 n(p.normal(x, y));
  const double sigma = 0.5 * radius;
  glm::dvec3 sum{0};
  for (int j = std::max(y - radius, 0); j <= std::min(y + radius, p.view.height - 1); ++j)
    for (int i = std::max(x - radius, 0); i <= std::min(x + radius, p.view.width - 1); ++i) {
      if (!(p.depth(i, j) < kInfinity)) continue;
      const glm::dvec3 other(p.normal(i, j));
      const double e = glm::dot(n, point(i, j) - point(x, y)) / kTolerance;
      const double r2 = (i - x) * (i - x) + (j - y) * (j - y);
      sum += other * std::exp(-0.5 * r2 / (sigma * sigma) - 0.5 * e * e -
                              (1 - glm::dot(n, other)) / static_cast<double>(kNormalSharpness));
    }
  return glm::normalize(sum);
}

TEST(NormalFilter, KeepsConstantNormalsAsTheyAre) {
  const vec3 tilted = glm::normalize(vec3{-0.6f, 0.2f, 1});
  const Picture p = picture(
      37, 29, [](vec2 q) { return 0.6f * q.x - 0.2f * q.y; }, [&](vec2) { return tilted; });
  for (const int radius : {1, 4, 9})
    for (const vec3& n : filtered_normals(p.view, p.depth, p.normal, radius, kTolerance))
      EXPECT_LT(degrees_between(n, tilted), 0.05);
}

TEST(NormalFilter, DoesNotSmoothAcrossAStepInDepth) {
  // Two levels, five spacings apart, with normals that would mix if they belonged together.
  const vec3 low = glm::normalize(vec3{0.1f, 0, 1}), high = glm::normalize(vec3{-0.1f, 0, 1});
  const Picture p = picture(
      40, 24, [](vec2 q) { return q.x < 0 ? 0 : 5 * kSpacing; }, [&](vec2 q) { return q.x < 0 ? low : high; });
  const Image<vec3> result = filtered_normals(p.view, p.depth, p.normal, 4, kTolerance);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x) EXPECT_LT(degrees_between(result(x, y), x < 20 ? low : high), 0.05) << x;
}

TEST(NormalFilter, KeepsACrease) {
  // A roof of 90 degrees: at the ridge the normals stay within a few degrees of their own side.
  const vec3 left = glm::normalize(vec3{-1, 0, 1}), right = glm::normalize(vec3{1, 0, 1});
  const Picture p = picture(
      40, 24, [](vec2 q) { return -std::abs(q.x); }, [&](vec2 q) { return q.x < 0 ? left : right; });
  const Image<vec3> result = filtered_normals(p.view, p.depth, p.normal, 4, kTolerance);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x) EXPECT_LT(degrees_between(result(x, y), x < 20 ? left : right), 1.0) << x;
}

Picture noisy_plane(std::uint64_t seed) {
  Random random(seed);
  return picture(
      64, 48, [&](vec2) { return 0.1f * kSpacing * random.between(-1, 1); },
      [&](vec2) {
        return vec3{0, 0, 1} + 0.15f * random.in_cube(1);
      });
}

TEST(NormalFilter, ShrinksNoiseOnAPlane) {
  const Picture p = noisy_plane(71);
  const Image<vec3> result = filtered_normals(p.view, p.depth, p.normal, 4, kTolerance);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    before += degrees_between(p.normal[i], {0, 0, 1});
    after += degrees_between(result[i], {0, 0, 1});
  }
  EXPECT_LT(after, 0.35 * before);
}

TEST(NormalFilter, FollowsItsFormula) {
  // Noise, a step, and holes without surface, at sizes that are not multiples of a vector.
  Random random(72);
  for (const int radius : {1, 3, 4, 7}) {
    const Picture p = picture(
        45, 33,
        [&](vec2 q) {
          if (random.between(0, 1) < 0.1f) return -kInfinity;
          return (q.x > 0.02f ? 1.5f * kSpacing : 0.0f) + 0.3f * kSpacing * random.between(-1, 1);
        },
        [&](vec2) {
          return vec3{0, 0, 1} + 0.4f * random.in_cube(1);
        });
    const Image<vec3> result = filtered_normals(p.view, p.depth, p.normal, radius, kTolerance);
    for (int y = 0; y < 33; ++y)
      for (int x = 0; x < 45; ++x) {
        if (!(p.depth(x, y) < kInfinity)) {
          EXPECT_EQ(glm::length(result(x, y)), 0.0f);
          continue;
        }
        EXPECT_LT(degrees_between(result(x, y), vec3(expected(p, x, y, radius))), 0.02)
            << x << ", " << y << ", radius " << radius;
      }
  }
}

TEST(NormalFilter, IsTheSameInThePlainSurface) {
  const Particles particles = wavy_tank();
  const View view = looking_at(particles.bounds(), {1, 0.4f, 0.7f}, Projection::perspective, 96, 72);
  RaycastOptions raw = options();
  raw.filter_radius = 0;
  const auto fast = make_raycast_surface(particles, options())->see(view),
             unfiltered = make_raycast_surface(particles, raw)->see(view);
  const auto plain = make_plain_raycast_surface(particles, options())->see(view);
  const Difference d = difference(plain, fast);
  EXPECT_LT(d.normal_mean, 0.1) << d;
  EXPECT_GT(difference(unfiltered, fast).normal_mean, 0.5);  // and it does something
}

}  // namespace
}  // namespace meniscus
