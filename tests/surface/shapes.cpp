// Shapes whose surface is known: half-space, ball, drop, filament, sheet.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// Offsets of the surface from half a spacing above the top layer, over a lattice of 24 x 24 x 8.
struct PlaneErrors {
  double mean = 0, most = 0;  ///< spacings, signed mean and largest size
  double normal_most = 0;     ///< degrees
  std::size_t pixels = 0;
};

PlaneErrors plane_errors(const RaycastOptions& with, vec3 direction, Projection projection) {
  const Particles particles = lattice_box(24, 24, 8);
  const auto surface = make_raycast_surface(particles, with);
  const View view = looking_at(particles.bounds(), direction, projection, 120, 96);
  const SurfaceBuffers seen = surface->see(view);
  const float expected = particles.bounds().high.z + 0.5f * kSpacing;
  PlaneErrors errors;
  for_each_hit(view, seen, [&](int x, int y, const Ray&, vec3 point) {
    if (std::max(std::abs(point.x), std::abs(point.y)) > 7 * kSpacing || point.z < 0) return;
    const double off = (point.z - expected) / kSpacing;
    errors.mean += off;
    errors.most = std::max(errors.most, std::abs(off));
    errors.normal_most = std::max(errors.normal_most, degrees_between(seen.normal(x, y), {0, 0, 1}));
    ++errors.pixels;
  });
  errors.mean /= static_cast<double>(std::max<std::size_t>(errors.pixels, 1));
  return errors;
}

constexpr float kSlants[][3] = {{0, 0, 1}, {0.5f, 0.3f, 1}, {-1, 0.4f, 0.8f}};

TEST(HalfSpace, IsAPlaneHalfASpacingAboveItsTopLayer) {
  for (const Kernel kernel : kKernels)
    for (const Projection projection : kProjections)
      for (const auto& slant : kSlants) {
        RaycastOptions with = options();
        with.kernel = kernel;
        const PlaneErrors errors = plane_errors(with, {slant[0], slant[1], slant[2]}, projection);
        EXPECT_GT(errors.pixels, 300u);
        EXPECT_LT(errors.most, 0.05) << surface_tests::name_of(kernel) << ", mean " << errors.mean;
        EXPECT_LT(errors.normal_most, 1.0) << surface_tests::name_of(kernel);
      }
}

TEST(HalfSpace, HasItsNormalByEveryMethod) {
  for (const NormalMethod method : {NormalMethod::gradient, NormalMethod::pca, NormalMethod::blend}) {
    RaycastOptions with = options();
    with.normals = method;
    EXPECT_LT(plane_errors(with, {0.5f, 0.3f, 1}, Projection::perspective).normal_most, 1.0);
  }
}

TEST(HalfSpace, RisesAsTheIsoValueFalls) {
  double before = 1;
  for (const float iso : {0.2f, 0.35f, 0.5f, 0.65f, 0.8f}) {
    RaycastOptions with = options();
    with.iso = iso;
    const double mean = plane_errors(with, {0, 0, 1}, Projection::orthographic).mean;
    EXPECT_LT(mean, before - 0.1) << iso;
    before = mean;
  }
}

TEST(Ball, IsASphereOfItsVolume) {
  for (const float radius : {3.0f, 5.0f, 8.0f})
    for (const Kernel kernel : kKernels)
      for (const Projection projection : kProjections) {
        const Particles particles = lattice_ball(radius);
        RaycastOptions with = options();
        with.kernel = kernel;
        const View view = looking_at(particles.bounds(), {1, 0.6f, 0.4f}, projection, 96, 80);
        const SurfaceBuffers seen = make_raycast_surface(particles, with)->see(view);
        const float expected = radius_of_volume(particles.size());
        double mean = 0, most = 0, normal_mean = 0;
        for_each_hit(view, seen, [&](int x, int y, const Ray&, vec3 point) {
          const double off = (glm::length(point) - expected) / kSpacing;
          mean += off;
          most = std::max(most, std::abs(off));
          normal_mean += degrees_between(seen.normal(x, y), point);
        });
        const auto count = static_cast<double>(hits(seen));
        ASSERT_GT(count, 1000);
        EXPECT_LT(std::abs(mean / count), 0.13) << radius << " " << surface_tests::name_of(kernel);
        EXPECT_LT(most, 0.6) << radius << " " << surface_tests::name_of(kernel);  // a lattice ball has steps
        EXPECT_LT(normal_mean / count, radius < 4 ? 6.0 : 4.0) << radius << " " << surface_tests::name_of(kernel);
      }
}

TEST(LoneParticle, IsARoundDropOfItsOwnVolume) {
  for (const Kernel kernel : kKernels)
    for (const float iso : {0.3f, 0.5f, 0.7f})
      for (const Projection projection : kProjections) {
        Particles particles;
        add(particles, {0.3f, -0.2f, 0.1f});
        RaycastOptions with = options();
        with.kernel = kernel;
        with.iso = iso;
        with.filter_radius = 0;
        Bounds box;
        box.add(particles.position(0));
        const View view = looking_at(box.grown(kSpacing), {0.3f, 1, 0.5f}, projection, 200, 200);
        const auto surface = make_raycast_surface(particles, with);
        const SurfaceBuffers seen = surface->see(view);
        const double radius = kDropRadius * kSpacing;
        double radius_most = 0, radius_mean = 0;
        std::vector<double> normals;
        std::vector<vec2> points;
        for_each_hit(view, seen, [&](int x, int y, const Ray&, vec3 point) {
          const double off = std::abs(glm::length(glm::dvec3(point - box.low)) - radius) / kSpacing;
          radius_most = std::max(radius_most, off);
          radius_mean += off / static_cast<double>(hits(seen));
          normals.push_back(degrees_between(seen.normal(x, y), point - box.low));
          points.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        });
        EXPECT_LT(radius_mean, 0.004) << surface_tests::name_of(kernel) << " iso " << iso;
        EXPECT_LT(radius_most, 0.05) << surface_tests::name_of(kernel) << " iso " << iso;
        // In pictures normals are interpolated where they turn by less than 6 degrees in two pixels, and not at the
        // rim, where a ball turns much within a pixel.
        EXPECT_LT(quantile(normals, 0.99), 0.3) << surface_tests::name_of(kernel) << " iso " << iso;
        EXPECT_LT(quantile(normals, 1), 0.6) << surface_tests::name_of(kernel) << " iso " << iso;
        const SurfaceBuffers single = surface->see(view, points);
        double normal_most = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
          if (!(single.depth[i] < kInfinity)) continue;
          const Ray ray = view.ray(points[i]);
          const vec3 point = ray.origin + single.depth[i] * ray.direction;
          normal_most = std::max(normal_most, degrees_between(single.normal[i], point - box.low));
        }
        EXPECT_LT(normal_most, 0.1) << surface_tests::name_of(kernel) << " iso " << iso;
        // A perspective eye sees a ball under the angle asin(radius / distance).
        const double distance = glm::length(glm::dvec3(view.eye) - glm::dvec3(box.low));
        const double on_plane =
            projection == Projection::orthographic ? radius : std::tan(std::asin(radius / distance));
        const double pixel = 2.0 * view.half_height / view.height;
        const double area = std::numbers::pi * on_plane * on_plane / (pixel * pixel);
        EXPECT_NEAR(static_cast<double>(hits(seen)) / area, 1.0, 0.02)
            << surface_tests::name_of(kernel) << " iso " << iso;
      }
}

TEST(LoneParticle, VanishesWithUnitMasses) {
  Particles particles;
  add(particles, vec3{0});
  RaycastOptions with = options();
  with.keep_thin = false;
  const View view = looking_at(particles.bounds().grown(kSpacing), {0, 1, 0}, Projection::orthographic, 64, 64);
  EXPECT_EQ(hits(make_raycast_surface(particles, with)->see(view)), 0u);
  // Its density at its own place is 8 / (8 pi) of the bulk with the cubic spline of two spacings.
  with.iso = 0.31f;
  EXPECT_GT(hits(make_raycast_surface(particles, with)->see(view)), 0u);
  with.iso = 0.33f;
  EXPECT_EQ(hits(make_raycast_surface(particles, with)->see(view)), 0u);
}

TEST(TwoParticles, AreOneDropWhenCloseAndTwoWhenApart) {
  for (const float apart : {0.0f, 0.5f, 1.0f, 3.0f}) {
    Particles particles;
    add(particles, vec3{-0.5f * apart * kSpacing, 0, 0});
    add(particles, vec3{0.5f * apart * kSpacing, 0, 0});
    const View view = looking_at(particles.bounds().grown(kSpacing), {0, 1, 0}, Projection::orthographic, 128, 128);
    const SurfaceBuffers seen = make_raycast_surface(particles, options())->see(view);
    expect_consistent(seen);
    EXPECT_GT(hits(seen), 100u);
    const bool between = seen.depth(64, 64) < kInfinity;
    EXPECT_EQ(between, apart <= 1.0f) << apart;
    // Between one drop of two volumes' silhouette and a generous bound.
    const double pixel = 2.0 * view.half_height / view.height;
    const double area =
        static_cast<double>(hits(seen)) * pixel * pixel / (std::numbers::pi * std::pow(kDropRadius * kSpacing, 2));
    // Two in one point count as packed water rather than as two drops: they make a smaller one.
    EXPECT_GT(area, apart > 0 ? 0.95 : 0.5) << apart;
    EXPECT_LT(area, 2.7) << apart;
  }
}

TEST(Filament, StaysConnectedAlongItsLength) {
  for (const Kernel kernel : kKernels)
    for (const float pitch : {0.8f, 1.0f, 1.15f}) {
      Particles particles;
      for (int i = 0; i < 24; ++i) add(particles, vec3{(static_cast<float>(i) - 11.5f) * pitch * kSpacing, 0, 0});
      RaycastOptions with = options();
      with.kernel = kernel;
      const View view = orthographic_view({0, 1, 0}, {0, 0, 0}, {0, 0, 1}, 4 * kSpacing, 800, 100);
      const SurfaceBuffers seen = make_raycast_surface(particles, with)->see(view);
      int broken = 0;
      for (int x = 0; x < view.width; ++x) {
        const Ray ray = pixel_ray(view, x, view.height / 2);
        if (std::abs(ray.origin.x) < 11.5f * pitch * kSpacing) broken += !(seen.depth(x, view.height / 2) < kInfinity);
      }
      EXPECT_EQ(broken, 0) << surface_tests::name_of(kernel) << ", pitch " << pitch;
    }
}

/// Pixels without water among those that look at the middle of a sheet one particle thick.
int holes_in_sheet(float pitch, float jitter, const RaycastOptions& with, vec3 direction) {
  Random random(5);
  Particles particles;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x)
      add(particles,
          kSpacing * pitch * (vec3{x, y, 0} - vec3{11.5f, 11.5f, 0}) + kSpacing * jitter * random.in_cube(1.0f));
  const View view = looking_at(particles.bounds(), direction, Projection::perspective, 200, 160);
  const SurfaceBuffers seen = make_raycast_surface(particles, with)->see(view);
  int holes = 0, looked = 0;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const Ray ray = pixel_ray(view, x, y);
      const vec3 at = ray.origin - ray.origin.z / ray.direction.z * ray.direction;
      if (std::max(std::abs(at.x), std::abs(at.y)) > 11 * pitch * kSpacing) continue;
      ++looked;
      holes += !(seen.depth(x, y) < kInfinity);
    }
  EXPECT_GT(looked, 2000);
  return holes;
}

TEST(ThinSheet, StaysWhole) {
  for (const Kernel kernel : kKernels)
    for (const float pitch : {0.9f, 1.0f, 1.1f, 1.2f})
      for (const vec3 direction : {vec3{0, 0, 1}, vec3{1, 0.5f, 1}}) {
        RaycastOptions with = options();
        with.kernel = kernel;
        EXPECT_EQ(holes_in_sheet(pitch, 0, with, direction), 0)
            << surface_tests::name_of(kernel) << ", pitch " << pitch;
      }
  EXPECT_EQ(holes_in_sheet(1.0f, 0.15f, options(), {0.2f, 0.1f, 1}), 0);
}

TEST(ThinSheet, WouldTearWithUnitMassesWhenStretched) {
  RaycastOptions with = options();
  with.keep_thin = false;
  EXPECT_GT(holes_in_sheet(1.2f, 0, with, {0, 0, 1}), 100);
}

}  // namespace
}  // namespace meniscus
