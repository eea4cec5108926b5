#include "fixtures.h"

namespace meniscus::surface_tests {
namespace {

SurfelOptions surfel_options() {
  SurfelOptions result;
  result.spacing = kSpacing;
  return result;
}

RaycastOptions same_surface() {
  RaycastOptions result = options();
  result.kernel = Kernel::wyvill;
  result.refinement_steps = 8;
  return result;
}

/// Density and its gradient at one point in double precision, by differences.
struct Field {
  double density;
  glm::dvec3 gradient;
};

Field field_at(const Particles& water, vec3 point, Kernel kernel) {
  DensityOptions by;
  by.spacing = kSpacing;
  by.kernel = kernel;
  // Exact in binary, so that the grid's points are where they are thought to be.
  constexpr float kStep = 0x1p-12f;
  const DensityGrid grid{point - kStep, vec3{kStep}, 3, 3, 3};
  const std::vector<double> rho = plain_density(water, by, grid);
  return {rho[13], glm::dvec3(rho[14] - rho[12], rho[16] - rho[10], rho[22] - rho[4]) / (2.0 * kStep)};
}

TEST(Surfels, LieOnTheIsoSurfaceWithItsNormals) {
  const Particles water = wavy_tank();
  for (const Kernel kernel : kKernels) {
    SurfelOptions by = surfel_options();
    by.kernel = kernel;
    const std::vector<Surfel> surfels = extract_surfels(water, by);
    ASSERT_GT(surfels.size(), 2000u);
    double worst_distance = 0, worst_angle = 0;
    for (std::size_t i = 0; i < surfels.size(); i += 97) {
      const Field field = field_at(water, surfels[i].position, kernel);
      const double slope = glm::length(field.gradient);
      worst_distance = std::max(worst_distance, std::abs(field.density - 0.5) / slope / kSpacing);
      worst_angle = std::max(worst_angle, degrees_between(surfels[i].normal, vec3(-field.gradient / slope)));
    }
    EXPECT_LT(worst_distance, 1e-3) << name_of(kernel);
    EXPECT_LT(worst_angle, 1.0) << name_of(kernel);
  }
}

TEST(Surfels, LeaveNoHoleInRandomViewsOfTheRaycastSurface) {
  Random random(11);
  std::size_t pixels = 0, holes = 0, extra = 0;
  const Particles clouds[] = {wavy_tank(), clumped_cloud(1500, 16, 4), lattice_box(16, 16, 1, 0.2f),
                              random_cloud(300, 8, 9)};
  for (const Particles& water : clouds) {
    const auto surfels = make_surfel_surface(water, surfel_options());
    const auto raycast = make_raycast_surface(water, same_surface());
    for (int i = 0; i < 6; ++i) {
      const View view = looking_at(raycast->bounds(), random.direction(), kProjections[i % 2], 160, 120);
      const SurfaceBuffers seen = surfels->see(view), truth = raycast->see(view);
      expect_consistent(seen);
      for (std::size_t p = 0; p < seen.depth.size(); ++p) {
        pixels += truth.depth[p] < kInfinity;
        holes += truth.depth[p] < kInfinity && !(seen.depth[p] < kInfinity);
        extra += seen.depth[p] < kInfinity && !(truth.depth[p] < kInfinity);
      }
    }
  }
  RecordProperty("holes", static_cast<int>(holes));
  EXPECT_LE(static_cast<double>(holes), 2e-4 * static_cast<double>(pixels)) << holes << " of " << pixels;
  EXPECT_LE(static_cast<double>(extra), 0.02 * static_cast<double>(pixels)) << extra << " of " << pixels;
}

TEST(Surfels, DepthAndNormalsAreThoseOfTheRaycastSurface) {
  const Particles water = lattice_ball(7.0f, 0.1f);
  const View view = looking_at(water.bounds(), {0.3f, -1.0f, 0.5f}, Projection::perspective, 200, 200);
  const SurfaceBuffers seen = make_surfel_surface(water, surfel_options())->see(view),
                       truth = make_raycast_surface(water, same_surface())->see(view);
  // Away from the rim, where a ray grazes the surface and a small way across is a long way along it.
  std::vector<double> depths, normals;
  for_each_hit(view, truth, [&](int x, int y, const Ray& ray, vec3) {
    if (!(seen.depth(x, y) < kInfinity) || glm::dot(truth.normal(x, y), ray.direction) > -0.3f) return;
    depths.push_back(std::abs(seen.depth(x, y) - truth.depth(x, y)) / kSpacing);
    normals.push_back(degrees_between(seen.normal(x, y), truth.normal(x, y)));
  });
  ASSERT_GT(depths.size(), 8000u);
  EXPECT_LT(quantile(depths, 0.5), 0.01);
  EXPECT_LT(quantile(depths, 0.99), 0.05);
  EXPECT_LT(quantile(normals, 0.5), 2.0);
  EXPECT_LT(quantile(normals, 0.99), 8.0);
}

TEST(Surfels, CurvatureOfADropIsOneOverItsRadius) {
  Particles one;
  add(one, vec3{0.01f, 0.02f, 0.03f});
  for (const Kernel kernel : kKernels) {
    SurfelOptions by = surfel_options();
    by.kernel = kernel;
    by.grid_step = 0.25f * kSpacing;
    for (const Surfel& surfel : extract_surfels(one, by))
      EXPECT_NEAR(surfel.curvature * glm::length(surfel.position - one.position(0)), 1.0f, 1e-3f) << name_of(kernel);
  }
}

TEST(Surfels, OfAStraightJetBendAcrossItsAxisByOneOverItsRadius) {
  const vec3 axis = glm::normalize(vec3{0.6f, -0.7f, 0.3f});
  Particles jet;
  for (int i = -40; i <= 40; ++i) add(jet, 0.25f * kSpacing * static_cast<float>(i) * axis);
  for (const Kernel kernel : kKernels) {
    SurfelOptions by = surfel_options();
    by.kernel = kernel;
    by.keep_thin = false;
    by.grid_step = 0.25f * kSpacing;
    std::size_t count = 0;
    for (const Surfel& surfel : extract_surfels(jet, by)) {
      const float along = glm::dot(surfel.position, axis);
      if (std::abs(along) > 5 * kSpacing) continue;  // the ends are round
      const float radius = glm::length(surfel.position - along * axis), size = glm::length(surfel.bend);
      EXPECT_NEAR((surfel.curvature + size) * radius, 1.0f, 0.02f) << name_of(kernel);
      EXPECT_NEAR((surfel.curvature - size) * radius, 0.0f, 0.1f) << name_of(kernel);  // ripple of the particles
      EXPECT_NEAR(glm::dot(surfel.bend, axis) / size, 0.0f, 0.02f);
      EXPECT_NEAR(glm::dot(surfel.bend, surfel.normal) / size, 0.0f, 1e-3f);
      ++count;
    }
    EXPECT_GT(count, 300u);
  }
}

TEST(Surfels, HaveTheSameBitsForAnyNumberOfThreads) {
  const Particles water = wavy_tank();
  const View view = looking_at(water.bounds(), {1, -1, 0.4f}, Projection::perspective, 150, 130);
  std::vector<Surfel> first;
  SurfaceBuffers first_seen;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const std::vector<Surfel> surfels = extract_surfels(water, surfel_options());
    const SurfaceBuffers seen = make_surfel_surface(water, surfel_options())->see(view);
    if (threads == 1) {
      first = surfels;
      first_seen = seen;
    }
    ASSERT_EQ(first.size(), surfels.size());
    EXPECT_EQ(std::memcmp(first.data(), surfels.data(), surfels.size() * sizeof(Surfel)), 0) << threads;
    EXPECT_TRUE(same_bits(first_seen, seen)) << threads;
  }
}

TEST(Surfels, PointsAtPixelCentresSeeWhatThePictureSees) {
  const Particles water = wavy_tank();
  SurfelOptions by = surfel_options();
  by.filter_radius = 0;
  const auto surface = make_surfel_surface(water, by);
  for (const Projection projection : kProjections) {
    const View view = looking_at(surface->bounds(), {1, -0.7f, 0.5f}, projection, 90, 70);
    const SurfaceBuffers picture = surface->see(view);
    std::vector<vec2> points;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x)
        points.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    const SurfaceBuffers list = surface->see(view, points);
    ASSERT_EQ(list.depth.width(), view.width * view.height);
    EXPECT_EQ(std::memcmp(list.depth.data(), picture.depth.data(), points.size() * sizeof(float)), 0);
    EXPECT_EQ(std::memcmp(list.normal.data(), picture.normal.data(), points.size() * sizeof(vec3)), 0);
  }
}

TEST(Surfels, ACubeViewIsItsSixFaces) {
  const auto surface = make_surfel_surface(wavy_tank(), surfel_options());
  const View cube = cube_view(vec3{0.1f, 0.2f, 0.35f}, 40);
  const SurfaceBuffers whole = surface->see(cube);
  ASSERT_EQ(whole.depth.width(), 240);
  for (int face = 0; face < 6; ++face) {
    const SurfaceBuffers part = surface->see(cube.face(face));
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) EXPECT_EQ(part.depth(x, y), whole.depth(face * 40 + x, y));
  }
  EXPECT_GT(hits(whole), 1000u);
}

TEST(Surfels, AnEyeInTheWaterSeesWhereRaysLeaveIt) {
  const Particles water = lattice_ball(6.0f);
  const auto surface = make_surfel_surface(water, surfel_options());
  View view = perspective_view(vec3{0}, vec3{1, 0, 0}, vec3{0, 0, 1}, 1.2f, 60, 60);
  const SurfaceBuffers seen = surface->see(view);
  EXPECT_TRUE(seen.eye_in_water);
  EXPECT_EQ(hits(seen), 3600u);
  for_each_hit(view, seen, [&](int, int, const Ray& ray, vec3 point) {
    EXPECT_NEAR(glm::length(point) / kSpacing, 6.2, 1.0);
    EXPECT_GT(glm::dot(ray.direction, glm::normalize(point)), 0.0f);
  });
  for (std::size_t i = 0; i < seen.normal.size(); ++i) EXPECT_GT(glm::dot(seen.normal[i], view.forward), 0.0f);
}

TEST(Surfels, APlaneThroughTheWaterShowsItsCut) {
  const Particles water = lattice_box(10, 10, 10);
  const auto surface = make_surfel_surface(water, surfel_options());
  const View view = orthographic_view(vec3{0}, vec3{0, 0, -1}, vec3{0, 1, 0}, 6 * kSpacing, 32, 32);
  const SurfaceBuffers seen = surface->see(view);
  for (const float depth : seen.depth) EXPECT_EQ(depth, 0.0f);
  for (const vec3 normal : seen.normal) EXPECT_LT(glm::length(normal - vec3(0, 0, 1)), 1e-6f);
}

TEST(Surfels, GivenOnesAreDrawnByEquationTwo) {
  // Two discs over each other within epsilon and one behind: at a place, depths and normals are the Gaussian means.
  const vec3 tilted = glm::normalize(vec3{0.1f, 0, 1});
  const std::vector<Surfel> surfels{
      {{0, 0, 0}, {0, 0, 1}, 1.0f}, {{0.5f, 0, -0.02f}, tilted, 1.0f}, {{0, 0, -1}, {0, 0, 1}, 1.0f}};
  const auto surface = make_surfel_surface(surfels, 0.2f);
  const View view = orthographic_view(vec3{0, 0, 5}, vec3{0}, vec3{0, 1, 0}, 4, 100, 100);
  const vec2 middle[] = {{50 + 25 * 0.2f, 50}};  // x = 0.2 m
  const SurfaceBuffers seen = surface->see(view, middle);
  const double plane_z = -0.02 + (0.5 - 0.2) * 0.1;  // of the tilted disc at x = 0.2
  const double r2 = 0.3 * 0.3 + std::pow(plane_z + 0.02, 2);
  const double w1 = std::exp(-2 * 0.04), w2 = std::exp(-2 * r2);
  EXPECT_NEAR(seen.depth[0], (w1 * 5 + w2 * (5 - plane_z)) / (w1 + w2), 1e-5);
  const vec3 normal = glm::normalize(static_cast<float>(w1) * vec3{0, 0, 1} + static_cast<float>(w2) * tilted);
  EXPECT_LT(degrees_between(seen.normal[0], normal), 0.01);
  EXPECT_NEAR(seen.exit[0], 6, 1e-5);
  // From behind all of them are culled.
  const View behind = orthographic_view(vec3{0, 0, -5}, vec3{0}, vec3{0, 1, 0}, 4, 100, 100);
  EXPECT_EQ(hits(surface->see(behind)), 0u);
  EXPECT_FALSE(surface->can_march());
}

TEST(Surfels, AddPointsWhereNeighboursAreFartherApartThanTheThreshold) {
  SurfelOptions few = surfel_options(), many = surfel_options();
  few.gap_threshold = 10 * kSpacing;
  many.gap_threshold = 0.1f * kSpacing;
  const Particles water = lattice_ball(5.0f, 0.1f);
  const std::size_t least = extract_surfels(water, few).size();
  EXPECT_GT(extract_surfels(water, surfel_options()).size(), least);
  EXPECT_GT(extract_surfels(water, many).size(), extract_surfels(water, surfel_options()).size());
}

TEST(Surfels, DropsThatFlewFarAwayCostWhatTheyWeigh) {
  Particles water = lattice_ball(4.0f);
  const std::size_t alone = extract_surfels(water, surfel_options()).size();
  add(water, vec3{3000, 2000, -1000});
  const std::vector<Surfel> both = extract_surfels(water, surfel_options());
  EXPECT_GT(both.size(), 9 * alone / 10);  // the grid stands elsewhere
  EXPECT_LT(both.size(), 11 * alone / 10 + 100);
  EXPECT_TRUE(std::any_of(both.begin(), both.end(), [](const Surfel& surfel) { return surfel.position.x > 2999; }));
}

TEST(Surfels, NoParticlesAreNoSurface) {
  const auto surface = make_surfel_surface(Particles{}, surfel_options());
  const View view = perspective_view(vec3{0, 0, 5}, vec3{0}, vec3{0, 1, 0}, 0.7f, 20, 20);
  EXPECT_EQ(hits(surface->see(view)), 0u);
  EXPECT_TRUE(surface->bounds().empty());
}

TEST(Surfels, RefuseOptionsOutsideTheirRange) {
  const Particles one = lattice_box(1, 1, 1);
  const auto refused = [&](auto change) {
    SurfelOptions by = surfel_options();
    change(by);
    EXPECT_THROW(extract_surfels(one, by), Error);
    EXPECT_THROW(make_surfel_surface(one, by), Error);
  };
  refused([](SurfelOptions& o) { o.spacing = 0; });
  refused([](SurfelOptions& o) { o.grid_step = -1; });
  refused([](SurfelOptions& o) { o.grid_step = 1e-9f; });
  refused([](SurfelOptions& o) { o.iso = 1.5f; });
  refused([](SurfelOptions& o) { o.epsilon = std::nanf(""); });
  refused([](SurfelOptions& o) { o.gap_threshold = -1; });
  EXPECT_THROW(make_surfel_surface(std::vector<Surfel>{}, 0.0f), Error);
}

}  // namespace
}  // namespace meniscus::surface_tests
