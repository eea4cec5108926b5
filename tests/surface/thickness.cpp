// Water along rays [vanDerLaan2009], in metres.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// Length of the ray inside a box.
double chord(const Ray& ray, const Bounds& box) {
  double low = 0, high = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.low[axis] - static_cast<double>(ray.origin[axis])) / ray.direction[axis];
    const double b = (box.high[axis] - static_cast<double>(ray.origin[axis])) / ray.direction[axis];
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  return std::max(high - low, 0.0);
}

TEST(Thickness, OfAFilledBoxIsItsChordWithinFivePercent) {
  const Particles particles = lattice_box(20, 18, 16);
  const Bounds box = particles.bounds().grown(0.5f * kSpacing);
  for (const Projection projection : kProjections)
    // Parallel rays along the lattice's axes or diagonals run between its rows: a tenth there. Others: a twentieth.
    for (const vec3 direction : {vec3{0, 0, 1}, vec3{1, 0.4f, 0.3f}, vec3{0.5f, 0.6f, -1}, vec3{-0.8f, 1, 0.7f}})
      for (const int size : {60, 170}) {  // both sampled at every pixel and at every few
        const auto fast = make_raycast_surface(particles, options());
        const View view = looking_at(particles.bounds(), direction, projection, size, size);
        const Image<float> thickness = fast->thickness(view);
        double most = 0, mean = 0;
        int looked = 0;
        for (int y = 0; y < size; ++y)
          for (int x = 0; x < size; ++x) {
            // Rays well inside: at least two spacings from the edges where they enter and leave.
            const Ray ray = pixel_ray(view, x, y);
            const double expected = chord(ray, box);
            if (chord(ray, box.grown(-2.0f * kSpacing)) < 0.6 * expected || expected < 8 * kSpacing) continue;
            ++looked;
            mean += thickness(x, y) / expected - 1;
            most = std::max(most, std::abs(thickness(x, y) / expected - 1));
          }
        EXPECT_GT(looked, 100);
        EXPECT_LT(most, direction.x == 0 ? 0.12 : 0.05) << direction.x << " " << direction.y << " " << direction.z;
        EXPECT_LT(std::abs(mean / looked), 0.02);
      }
}

TEST(Thickness, OfAJitteredBoxIsItsChordWithinFivePercentOnAverage) {
  // Along an axis, too, when averaged over two by two spacings: jitter itself makes columns of unequal water.
  const Particles particles = lattice_box(20, 20, 16, 0.2f);
  const View view = orthographic_view({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 12 * kSpacing, 96, 96);  // 8 px a spacing
  const Image<float> thickness = make_raycast_surface(particles, options())->thickness(view);
  for (int y = 0; y < 96; y += 16)
    for (int x = 0; x < 96; x += 16) {
      double mean = 0;
      for (int j = 0; j < 16; ++j)
        for (int i = 0; i < 16; ++i) mean += thickness(x + i, y + j) / 256.0;
      EXPECT_NEAR(mean / (16 * kSpacing), 1.0, 0.05);
    }
}

TEST(Thickness, OfAnyCloudHoldsItsVolume) {
  // Seen through parallel rays, thickness integrates to the particles' volume.
  for (const Particles& particles : {lattice_ball(6), wavy_tank(), clumped_cloud(2000, 20, 101)}) {
    const View view =
        looking_at(particles.bounds().grown(2 * kSpacing), {0.3f, 0.5f, 0.8f}, Projection::orthographic, 150, 150);
    const Image<float> thickness = make_raycast_surface(particles, options())->thickness(view);
    double sum = 0;
    for (const float t : thickness) sum += t;
    const double pixel = 2.0 * view.half_height / view.height;
    const double volume = static_cast<double>(particles.size()) * std::pow(kSpacing, 3);
    EXPECT_NEAR(sum * pixel * pixel / volume, 1.0, 0.02);
  }
}

TEST(Thickness, IsNotNegativeAndZeroAwayFromTheWater) {
  const Particles particles = lattice_ball(4);
  const View view = looking_at(particles.bounds().grown(8 * kSpacing), {1, 1, 1}, Projection::perspective, 160, 120);
  const SurfaceBuffers seen = make_raycast_surface(particles, options())->see(view);
  int away = 0, covered = 0;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      EXPECT_GE(seen.thickness(x, y), 0.0f);
      const Ray ray = pixel_ray(view, x, y);
      const float off = glm::length(glm::cross(-ray.origin, ray.direction));
      if (off > 7 * kSpacing) {
        EXPECT_EQ(seen.thickness(x, y), 0.0f);
        ++away;
      }
      if (seen.depth(x, y) < kInfinity) {
        EXPECT_GT(seen.thickness(x, y), 0.0f);
        ++covered;
      }
    }
  EXPECT_GT(away, 1000);
  EXPECT_GT(covered, 300);
}

TEST(Thickness, IsTheSameByBothSurfacesAndWaysToAskForIt) {
  const Particles particles = wavy_tank();
  const View view = looking_at(particles.bounds(), {1, 0.2f, 0.5f}, Projection::perspective, 71, 53);
  const auto fast = make_raycast_surface(particles, options()),
             plain = make_plain_raycast_surface(particles, options());
  const Image<float> a = fast->thickness(view), b = plain->thickness(view), c = fast->see(view).thickness;
  EXPECT_TRUE(same_bits(a, c));
  std::vector<vec2> centres;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      centres.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  const Image<float> d = fast->thickness(view, centres);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], b[i], 0.02f * kSpacing);
    ASSERT_NEAR(a[i], d[i], 1e-3f * kSpacing);
  }
}

TEST(Thickness, CanBeLeftOut) {
  RaycastOptions with = options();
  with.want_thickness = false;
  const Particles particles = lattice_ball(3);
  const View view = looking_at(particles.bounds(), {1, 0, 0}, Projection::perspective, 32, 32);
  EXPECT_TRUE(make_raycast_surface(particles, with)->see(view).thickness.empty());
  EXPECT_TRUE(make_plain_raycast_surface(particles, with)->see(view).thickness.empty());
}

}  // namespace
}  // namespace meniscus
