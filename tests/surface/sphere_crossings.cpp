// Rays through balls against all their intervals in double precision.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

struct Interval {
  double in, out;
};

/// Where the ray is in balls, without overlaps, rising.
std::vector<Interval> united(const Particles& particles, double radius, const Ray& ray) {
  std::vector<Interval> each, all;
  const glm::dvec3 o(ray.origin), d = glm::normalize(glm::dvec3(ray.direction));
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const glm::dvec3 offset = glm::dvec3(particles.position(i)) - o;
    const double middle = glm::dot(offset, d), half2 = radius * radius - glm::dot(offset, offset) + middle * middle;
    if (half2 > 0) each.push_back({middle - std::sqrt(half2), middle + std::sqrt(half2)});
  }
  std::sort(each.begin(), each.end(), [](const Interval& a, const Interval& b) { return a.in < b.in; });
  for (const Interval& one : each) {
    if (all.empty() || one.in > all.back().out)
      all.push_back(one);
    else
      all.back().out = std::max(all.back().out, one.out);
  }
  return all;
}

Crossing crossing_of(const Surface& surface, const Ray& ray, float from, float limit, bool inside) {
  Crossing found;
  const std::uint8_t in = inside ? 1 : 0;
  surface.crossings({&ray, 1}, {&from, 1}, {&limit, 1}, {&in, 1}, {&found, 1});
  return found;
}

/// Distance from a point to the nearest ball's face.
float off_face(const Particles& particles, float radius, vec3 point) {
  float least = kInfinity;
  for (std::size_t i = 0; i < particles.size(); ++i)
    least = std::min(least, std::abs(glm::length(point - particles.position(i)) - radius));
  return least;
}

TEST(SphereCrossings, AreTheEndsOfTheUnitedIntervals) {
  const float radius = 0.7f * kSpacing;
  Particles particles = lattice_box(9, 7, 8, 0.3f);
  Random random(11);
  for (int i = 0; i < 200; ++i) add(particles, random.in_cube(14 * kSpacing));
  const auto surface = make_sphere_surface(particles, radius);
  ASSERT_TRUE(surface->can_march());
  std::size_t into = 0, out_of = 0;
  for (int i = 0; i < 2000; ++i) {
    const vec3 direction = random.direction();
    const Ray ray{random.in_cube(8 * kSpacing) - direction * random.between(0, 40 * kSpacing), direction};
    const std::vector<Interval> stretches = united(particles, radius, ray);
    const float from = random.between(0, 30 * kSpacing);
    for (const Interval& stretch : stretches) {
      // Gaps and stretches as short as rounding tell nothing.
      const auto near = [&](double t) { return std::abs(t - from) < 1e-4; };
      if (std::any_of(stretches.begin(), stretches.end(),
                      [&](const Interval& s) { return near(s.in) || near(s.out) || s.out - s.in < 1e-3; }))
        break;
      if (stretch.out < from) continue;
      const bool inside = stretch.in < from;
      const double expected = inside ? stretch.out : stretch.in;
      const Crossing found = crossing_of(*surface, ray, from, kInfinity, inside);
      ASSERT_NEAR(found.distance, expected, 2e-4 * static_cast<double>(radius)) << "ray " << i;
      const vec3 point = ray.origin + found.distance * ray.direction;
      EXPECT_LT(off_face(particles, radius, point), 1e-3f * radius);
      EXPECT_NEAR(glm::length(found.normal), 1.0f, 1e-4f);
      EXPECT_EQ(glm::dot(found.normal, ray.direction) > 0, inside);
      const auto before = static_cast<float>(expected - 0.05 * static_cast<double>(radius));
      if (before > from) {
        EXPECT_EQ(crossing_of(*surface, ray, from, before, inside).distance, kInfinity);
      }
      ++(inside ? out_of : into);
      break;
    }
    if (stretches.empty()) {
      EXPECT_EQ(crossing_of(*surface, ray, from, kInfinity, false).distance, kInfinity);
    }
  }
  EXPECT_GT(into, 300u);
  EXPECT_GT(out_of, 80u);
}

TEST(SphereCrossings, ARayOnTheOtherSideCrossesWhereItComesToItsOwnOrElseAtOnce) {
  Particles particles;
  for (const float x : {0.0f, 3.0f, 4.0f, 5.0f}) add(particles, {x, 0, 0});
  const auto surface = make_sphere_surface(particles, 1.0f);
  const Ray ray{{-10, 0, 0}, {1, 0, 0}};
  // Just inside of the first ball although it should have left it: it enters the second one.
  EXPECT_NEAR(crossing_of(*surface, ray, 10.9f, 100, false).distance, 12.0f, 1e-4f);
  // Deep in a chain of balls longer than the rounding that this is for: where it starts.
  EXPECT_EQ(crossing_of(*surface, ray, 12.5f, 100, false).distance, 12.5f);
  // A little before a ball that it should be in: it leaves the chain of three.
  EXPECT_NEAR(crossing_of(*surface, ray, 11.5f, 100, true).distance, 16.0f, 1e-4f);
  // Far from any ball: where it starts.
  EXPECT_EQ(crossing_of(*surface, ray, 2.0f, 100, true).distance, 2.0f);
  EXPECT_EQ(crossing_of(*surface, ray, 2.0f, 1.0f, true).distance, kInfinity);
}

TEST(SphereCrossings, EndForRaysThatComeFromVeryFarAndForParticlesSpreadVeryThinly) {
  Particles particles;
  add(particles, {0, 0, 0});
  add(particles, {1e4f, 1e4f, 1e4f});
  const auto surface = make_sphere_surface(particles, 0.01f);
  const vec3 diagonal = glm::normalize(vec3{1, 1, 1});
  EXPECT_NEAR(crossing_of(*surface, {{0, 0, 0}, diagonal}, 0.0f, kInfinity, true).distance, 0.01f, 1e-6f);
  EXPECT_NO_THROW(crossing_of(*surface, {-1e9f * diagonal, diagonal}, 0, kInfinity, false));
  const auto none = make_sphere_surface({}, 0.01f);
  EXPECT_EQ(crossing_of(*none, {{0, 0, 0}, diagonal}, 0, kInfinity, false).distance, kInfinity);
}

TEST(SphereCrossings, AreTheSameForAnyThreadCount) {
  const Particles particles = lattice_box(6, 6, 6, 0.4f);
  Random random(5);
  std::vector<Ray> rays;
  for (int i = 0; i < 1000; ++i) {
    const vec3 direction = random.direction();
    rays.push_back({random.in_cube(kSpacing) - 10 * kSpacing * direction, direction});
  }
  const std::vector<float> from(rays.size(), 0.0f), limit(rays.size(), 100.0f);
  const std::vector<std::uint8_t> inside(rays.size(), 0);
  std::vector<Crossing> one(rays.size()), five(rays.size());
  for (const auto& [threads, found] : {std::pair{1, &one}, std::pair{5, &five}}) {
    const ThreadLimit thread_limit(threads);
    make_sphere_surface(particles, 0.6f * kSpacing)->crossings(rays, from, limit, inside, *found);
  }
  EXPECT_EQ(std::memcmp(one.data(), five.data(), one.size() * sizeof(Crossing)), 0);
}

}  // namespace
}  // namespace meniscus
