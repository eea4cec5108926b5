// Water along rays [vanDerLaan2009], in metres.
#include "surface/thickness.h"
#include <fmt/core.h>

#include "surface/fixtures.h"
#include "surface/splat.h"
#include "surface/thickness_filter.h"

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
  const Particles particles = lattice_box(28, 26, 24);  // deep cells amidst spheres
  const Bounds box = particles.bounds().grown(0.5f * kSpacing);
  for (const Projection projection : kProjections)
    // Along the lattice's axes and diagonals, too. Smoothing rounds the edges between the faces: a tenth there.
    for (const vec3 direction :
         {vec3{0, 0, 1}, vec3{1, 0.4f, 0.3f}, vec3{0.5f, 0.6f, -1}, vec3{-0.8f, 1, 0.7f}, vec3{-1, 1, 1}})
      for (const int size : {60, 170}) {  // both sampled at every pixel and at every few
        const auto fast = make_raycast_surface(particles, options());
        const View view = looking_at(particles.bounds(), direction, projection, size, size);
        const Image<float> thickness = fast->thickness(view);
        std::vector<double> off;
        double mean = 0;
        for (int y = 0; y < size; ++y)
          for (int x = 0; x < size; ++x) {
            // Rays well inside: at least two spacings from the edges where they enter and leave.
            const Ray ray = pixel_ray(view, x, y);
            const double expected = chord(ray, box);
            if (chord(ray, box.grown(-2.0f * kSpacing)) < 0.6 * expected || expected < 8 * kSpacing) continue;
            off.push_back(std::abs(thickness(x, y) / expected - 1));
            mean += thickness(x, y) / expected - 1;
          }
        ASSERT_GT(off.size(), 100u);
        EXPECT_LT(std::abs(mean / static_cast<double>(off.size())), 0.02);
        EXPECT_LT(quantile(off, 0.95), 0.05) << direction.x << " " << direction.y << " " << direction.z;
        EXPECT_LT(quantile(off, 1), 0.1) << direction.x << " " << direction.y << " " << direction.z;
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
    EXPECT_NEAR(sum * pixel * pixel / volume, 1.0, 0.04);  // smoothing keeps it nearly
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

TEST(Thickness, IsThatOfThePlainSurfaceSmoothedAndTheSameByAllWaysToAskForIt) {
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
  // The plain surface does not smooth; the width is a spacing in the middle of the water.
  const float spacing_px = kSpacing / view.pixel_size(glm::dot(particles.bounds().centre() - view.eye, view.forward));
  const Image<float> smooth = smoothed_thickness(b, spacing_px, kSpacing);
  // Particles a few samples wide are points spread like their spheres: single drops differ a little.
  double sum = 0, plain_sum = 0, off = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], smooth[i], 0.25f * kSpacing + 0.05f * smooth[i]);
    off += std::abs(static_cast<double>(a[i]) - smooth[i]);
    sum += a[i];
    plain_sum += b[i];
    ASSERT_NEAR(a[i], d[i], 1e-3f * kSpacing);
  }
  EXPECT_NEAR(sum / plain_sum, 1.0, 0.04);
  EXPECT_LT(off / sum, 0.02);
}

/// What the spheres of all particles add up to, smoothed as the fast sums are.
Image<float> additive_spheres(const Particles& particles, const View& view) {
  const float radius = 1.25f * kSpacing,
              weight = 1.0f / (4.0f / 3.0f * std::numbers::pi_v<float> * std::pow(1.25f, 3.0f));
  const Image<float> sums =
      splat_chords(view, {particles.x, particles.y, particles.z, std::span<const float>(&radius, 1)}, weight, 1);
  const float middle = glm::dot(particles.bounds().centre() - view.eye, view.forward);
  return smoothed_thickness(sums, kSpacing / view.pixel_size(middle), kSpacing);
}

/// Whether the water `reach` pixels to all sides is at least half as deep.
bool amidst(const Image<float>& thickness, int x, int y, int reach) {
  for (int j = -reach; j <= reach; ++j)
    for (int i = -reach; i <= reach; ++i) {
      const int column = std::clamp(x + i, 0, thickness.width() - 1),
                row = std::clamp(y + j, 0, thickness.height() - 1);
      if (!(thickness(column, row) > 0.5f * thickness(x, y))) return false;
    }
  return true;
}

TEST(Thickness, OfCountedCellsIsThatOfTheirSpheresFromAllSidesWhereverTheirRowsLie) {
  // Blocks whose inner cells are known by the numbers of their particles alone. A particle beside them moves the cells:
  // rows lie on their sides, or from a quarter of a spacing to half of one beside these.
  for (const float jitter : {0.0f, 0.2f})
    for (const float offset : {0.0f, 0.25f, 0.5f}) {
      Particles particles = lattice_box(48, 44, 40, jitter);
      if (offset > 0) add(particles, particles.bounds().low - (2 + offset) * kSpacing);
      const BandGrid grid(particles, {2 * kSpacing, 3, 2});
      const BandGrid all(particles, {2 * kSpacing, 0, 2});
      ASSERT_TRUE(grid.has_deep());
      ASSERT_LT(grid.size(), particles.size());
      for (const Projection projection : kProjections)
        for (const vec3 direction :
             {vec3{1, 0, 0}, vec3{0, 1, 0}, vec3{0, 0, 1}, vec3{0.1f, 1, 0.05f}, vec3{1, 0.4f, 0.3f}, vec3{-1, 1, 1}}) {
          const View view = looking_at(particles.bounds(), direction, projection, 120, 120);
          const Image<float> counted = splatted_thickness(grid, kSpacing, view, {}),
                             spheres = additive_spheres(particles, view);
          const Image<float> points = splatted_thickness(all, kSpacing, view, {});
          std::vector<double> off_points, off_spheres;
          double counted_sum = 0, sum = 0;
          for (int y = 0; y < view.height; ++y)
            for (int x = 0; x < view.width; ++x) {
              counted_sum += counted(x, y);
              sum += spheres(x, y);
              if (!(spheres(x, y) > 4 * kSpacing)) continue;
              off_points.push_back(std::abs(counted(x, y) / points(x, y) - 1));
              // On outlines along the rays the water ends within a sample.
              if (amidst(spheres, x, y, 4)) off_spheres.push_back(std::abs(counted(x, y) / spheres(x, y) - 1));
            }
          ASSERT_GT(off_spheres.size(), 1000u);
          const std::string what =
              fmt::format("jitter {}, offset {}, projection {}, direction {} {} {}", jitter, offset,
                          static_cast<int>(projection), direction.x, direction.y, direction.z);
          EXPECT_LT(quantile(off_points, 0.95), 0.05) << what;
          EXPECT_LT(quantile(off_spheres, 0.95), 0.05) << what;
          EXPECT_NEAR(counted_sum / sum, 1.0, 0.01) << what;
        }
    }
}

TEST(Thickness, OfCountedCellsIsTheSameForAnyNumberOfThreads) {
  const Particles particles = lattice_box(48, 44, 40, 0.2f);
  const BandGrid grid(particles, {2 * kSpacing, 3, 2});
  const View view = looking_at(particles.bounds(), {1, 0.4f, 0.3f}, Projection::perspective, 120, 120);
  const Image<float> counted = splatted_thickness(grid, kSpacing, view, {});
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(same_bits(splatted_thickness(grid, kSpacing, view, {}), counted));
  }
}

TEST(SmoothedThickness, TakesRipplesAndLeavesOutlines) {
  // A ripple of a tenth with a period of four pixels on water of ten spacings, and a drop's edge before nothing.
  Image<float> map(64, 48, 0.0f);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 40; ++x)
      map(x, y) = 10 * kSpacing * (1 + 0.1f * std::sin(0.5f * std::numbers::pi_v<float> * static_cast<float>(x)));
  const Image<float> smooth = smoothed_thickness(map, 3.0f, kSpacing);
  for (int x = 8; x < 32; ++x) EXPECT_NEAR(smooth(x, 20), 10 * kSpacing, 0.4f * kSpacing) << x;
  for (int x = 40; x < 64; ++x) EXPECT_EQ(smooth(x, 20), 0.0f);
  const Image<float> even(30, 20, 0.7f);
  for (const float t : smoothed_thickness(even, 2.0f, kSpacing)) EXPECT_NEAR(t, 0.7f, 1e-5f);
  EXPECT_TRUE(same_bits(smoothed_thickness(map, 0.3f, kSpacing), map));
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
