// Height fields: found in particles, sampled, smoothed, seen and marched.
#include "surface/fixtures.h"
#include "surface/height_field_body.h"
#include "surface/height_field_grid.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// A calm tank, y up: nx x layers x nz particles from the origin on.
Particles calm(int nx, int layers, int nz, float jitter = 0) {
  Random random(5);
  Particles result;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < layers; ++y)
      for (int x = 0; x < nx; ++x) add(result, kSpacing * (vec3{x, y, z} + 0.5f + random.in_cube(jitter)));
  return result;
}

HeightFieldOptions tank_options(int nx, int nz) {
  HeightFieldOptions result;
  result.spacing = kSpacing;
  result.region = {vec3{0.0f}, kSpacing * vec3{nx, 40, nz}};
  return result;
}

/// A field of 2 x 2 m over heights h(x, z), y up, floor 0.
template <class F>
HeightField field_of(int points, F h) {
  HeightField field = blank_field(Axis::y, {vec3{0.0f}, vec3{2.0f}}, 2.0f / static_cast<float>(points - 1));
  for (int j = 0; j < field.height.height(); ++j)
    for (int i = 0; i < field.height.width(); ++i) {
      const vec3 p = field.point(static_cast<float>(i), static_cast<float>(j), 0);
      field.height(i, j) = h(p.x, p.z);
    }
  find_normals(field);
  return field;
}

float bumpy(float x, float z) { return 0.5f + 0.1f * std::sin(5 * x + z) + 0.05f * std::cos(9 * z - 2 * x); }

bool is_hole(float x, float z) { return std::hypot(x - 1.2f, z - 0.7f) < 0.3f; }
float holed(float x, float z) { return is_hole(x, z) ? -kInfinity : bumpy(x, z); }

/// Membership in the body, from its definition.
bool in_body(const HeightField& field, glm::dvec3 p) {
  const double a = (p.x - static_cast<double>(field.low.x)) / static_cast<double>(field.step.x),
               b = (p.z - static_cast<double>(field.low.y)) / static_cast<double>(field.step.y);
  const int width = field.height.width(), height = field.height.height();
  if (!(a >= 0 && b >= 0 && a <= width - 1 && b <= height - 1 && p.y >= static_cast<double>(field.floor))) return false;
  const int i = std::min(static_cast<int>(a), width - 2), j = std::min(static_cast<int>(b), height - 2);
  double wet = 0, level = 0;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x) {
      const double weight = (x ? a - i : 1 - a + i) * (y ? b - j : 1 - b + j);
      double here = static_cast<double>(field.height(i + x, j + y));
      if (here > -1e30) {
        wet += weight;
      } else {
        double sum = 0;
        int count = 0;
        for (int q = std::max(j + y - 1, 0); q <= std::min(j + y + 1, height - 1); ++q)
          for (int r = std::max(i + x - 1, 0); r <= std::min(i + x + 1, width - 1); ++r)
            if (field.height(r, q) > -1e30f) sum += static_cast<double>(field.height(r, q)), ++count;
        here = count > 0 ? static_cast<double>(static_cast<float>(sum / count)) : 0;
      }
      level += weight * here;
    }
  return wet >= 0.5 && p.y <= level;
}

TEST(HeightField, KeepsTheLevelOfStillWaterUpToItsWalls) {
  for (const int layers : {1, 2, 5})
    for (const float jitter : {0.0f, 0.2f}) {
      const HeightField field = height_field(calm(14, layers, 11, jitter), tank_options(14, 11));
      const float level = static_cast<float>(layers) * kSpacing;
      EXPECT_FLOAT_EQ(field.point(0, 0, 0).x, 0.0f);
      EXPECT_NEAR(field.point(static_cast<float>(field.height.width() - 1), 0, 0).x, 14 * kSpacing, 1e-5f);
      double mean = 0;
      for (const float height : field.height) {
        EXPECT_NEAR(height, level, (jitter > 0 ? 0.35f : 0.1f) * kSpacing);
        mean += static_cast<double>(height) / static_cast<double>(field.height.size());
      }
      EXPECT_NEAR(mean, static_cast<double>(level), 0.05 * static_cast<double>(kSpacing));
    }
}

TEST(HeightField, LiesWithinHalfASpacingOfTheRayCastSurface) {
  const Particles water = calm(16, 8, 16, 0.15f);
  const HeightField field = height_field(water, tank_options(16, 16));
  const auto cast = make_raycast_surface(water, options());
  const HeightField other = height_field_of(*cast, Axis::y, {vec3{0.0f}, kSpacing * vec3{16, 20, 16}}, 0.5f * kSpacing);
  ASSERT_EQ(field.height.size(), other.height.size());
  for (std::size_t i = 0; i < field.height.size(); ++i) {
    // The ray-cast surface is rounded at walls, as it knows of none: there the level is what is to be met.
    const int x = static_cast<int>(i) % field.height.width(), y = static_cast<int>(i) / field.height.width();
    const bool wall = std::min({x, y, field.height.width() - 1 - x, field.height.height() - 1 - y}) < 3;
    EXPECT_NEAR(field.height[i], wall ? 8 * kSpacing : other.height[i], 0.5f * kSpacing) << x << " " << y;
  }
}

TEST(HeightField, FindsWhereThePotentialFallsThroughTheIsoValue) {
  const Particles water = calm(8, 4, 8, 0.2f);
  HeightFieldOptions options = tank_options(8, 8);
  options.smoothing = 0;
  const HeightField field = height_field(water, options);
  const double reach = 2.0 * static_cast<double>(kSpacing), iso = 8 * 1.2337006;
  // In the middle, where no wall mirrors anything: the sum of eq. 5 over all particles and those under the floor.
  for (int j = 6; j <= 10; ++j)
    for (int i = 6; i <= 10; ++i) {
      const vec3 p = field.point(static_cast<float>(i), static_cast<float>(j), field.height(i, j));
      double sum = 0;
      for (std::size_t k = 0; k < water.size(); ++k) {
        const glm::dvec3 off = glm::dvec3(water.position(k)) - glm::dvec3(p);
        sum += std::sqrt(std::max(0.0, 1 - glm::dot(off, off) / (reach * reach)));
      }
      EXPECT_NEAR(sum, iso, 0.01 * iso);
    }
}

TEST(HeightField, LeavesOutDropsInTheAir) {
  const Particles water = calm(14, 4, 14);
  const HeightField still = height_field(water, tank_options(14, 14));
  Particles splashed = water;
  for (int i = 0; i < 5; ++i) add(splashed, {0.1f + 0.1f * static_cast<float>(i), 0.6f, 0.3f});
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z) add(splashed, vec3{0.3f, 0.9f, 0.3f} + kSpacing * vec3{x, y, z});
  const HeightField field = height_field(splashed, tank_options(14, 14));
  for (std::size_t i = 0; i < field.height.size(); ++i) EXPECT_NEAR(field.height[i], still.height[i], 1e-5f);
}

TEST(HeightField, HasHolesWhereThereIsNoWater) {
  Particles water;
  const Particles all = calm(20, 4, 12);
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all.x[i] < 8 * kSpacing) add(water, all.position(i));
  const HeightField field = height_field(water, tank_options(20, 12));
  for (int i = 0; i < field.height.width(); ++i) {
    const float x = field.point(static_cast<float>(i), 0, 0).x / kSpacing;
    if (x < 6.5f) {
      EXPECT_NEAR(field.height(i, 8), 4 * kSpacing, 0.3f * kSpacing) << x;
    }
    if (x > 9.5f) {
      EXPECT_EQ(field.height(i, 8), -kInfinity) << x;
    }
  }
}

TEST(HeightField, GoesOnThroughSolidsWithoutADip) {
  Particles water;
  const Particles all = calm(20, 6, 20);
  const vec2 centre{10 * kSpacing, 9 * kSpacing};
  const auto solid = [&](vec3 p) { return std::hypot(p.x - centre.x, p.z - centre.y) < 3 * kSpacing; };
  for (std::size_t i = 0; i < all.size(); ++i)
    if (!solid(all.position(i))) add(water, all.position(i));
  HeightFieldOptions options = tank_options(20, 20);
  const HeightField dented = height_field(water, options);
  options.in_solid = solid;
  const HeightField field = height_field(water, options);
  const vec2 at = field.grid_point({centre.x, 0, centre.y});
  EXPECT_FALSE(dented.at(at.x, at.y).water());
  for (const float height : field.height) EXPECT_NEAR(height, 6 * kSpacing, 0.15f * kSpacing);
}

TEST(HeightField, SmoothingKeepsPlanesAndBorders) {
  HeightField field =
      field_of(41, [](float x, float z) { return is_hole(x, z) ? -kInfinity : 0.3f + 0.2f * x - 0.1f * z; });
  const Image<float> before = field.height;
  smooth_heights(field, 0.15f);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i] == -kInfinity) {
      EXPECT_EQ(field.height[i], -kInfinity);
    }
    if (before[i] > -kInfinity) {
      EXPECT_NEAR(field.height[i], before[i], 1e-6f);
    }
  }
}

TEST(HeightField, SmoothingDoesNotReachAcrossHoles) {
  HeightField field = field_of(41, [](float x, float) { return x < 0.98f ? 0.2f : x > 1.06f ? 0.9f : -kInfinity; });
  smooth_heights(field, 0.2f);
  for (const float height : field.height) {
    if (height > -kInfinity) {
      EXPECT_TRUE(height == 0.2f || height == 0.9f) << height;
    }
  }
}

TEST(HeightField, IsTheSameOnAnyNumberOfThreads) {
  const Particles water = wavy_tank();
  HeightFieldOptions options;
  options.spacing = kSpacing;
  options.up = Axis::z;
  const auto on = [&](int threads) {
    const ThreadLimit limit(threads);
    HeightField field = height_field(water, options);
    const View view = looking_at(field.bounds(), {1, 0.5f, 0.8f}, Projection::perspective, 90, 70);
    return std::pair{field.height, make_height_field_surface(field)->see(view)};
  };
  const auto one = on(1), three = on(3);
  EXPECT_TRUE(same_bits(one.first, three.first));
  EXPECT_TRUE(same_bits(one.second, three.second));
}

TEST(HeightField, RefusesWhatItCannotUse) {
  HeightFieldOptions bad;
  EXPECT_THROW(height_field(calm(3, 3, 3), bad), Error);
  bad = tank_options(3, 3);
  bad.step = 1e-6f;
  EXPECT_THROW(height_field(calm(3, 3, 3), bad), Error);
  bad = tank_options(3, 3);
  bad.iso = -1;
  EXPECT_THROW(height_field(calm(3, 3, 3), bad), Error);
  bad = tank_options(3, 3);
  bad.iso_radius = 100 * bad.spacing;
  EXPECT_THROW(height_field(calm(3, 3, 3), bad), Error);
  HeightField field = field_of(5, bumpy);
  field.height(2, 2) = std::nanf("");
  EXPECT_THROW(make_height_field_surface(field), Error);
  EXPECT_EQ(
      hits(make_height_field_surface(HeightField{})->see(perspective_view({0, 1, 3}, {0, 0, 0}, {0, 1, 0}, 1, 8, 8))),
      0u);
  EXPECT_TRUE(height_field(Particles{}, tank_options(3, 3)).at(1, 1).height == -kInfinity);
}

TEST(HeightFieldSurface, MeetsAPlaneExactly) {
  const auto plane = [](float x, float z) { return 0.4f + 0.15f * x - 0.1f * z; };
  const HeightField field = field_of(33, plane);
  const auto surface = make_height_field_surface(field);
  for (const Projection projection : kProjections) {
    const View view = looking_at(field.bounds(), {0.4f, 1, 0.7f}, projection, 60, 50);
    const SurfaceBuffers seen = surface->see(view);
    expect_consistent(seen);
    std::size_t tops = 0;
    for_each_hit(view, seen, [&](int x, int y, const Ray&, vec3 p) {
      if (!(p.x > 1e-3f && p.z > 1e-3f && p.x < 1.999f && p.z < 1.999f)) return;
      ++tops;
      EXPECT_NEAR(p.y, plane(p.x, p.z), 2e-6f);
      EXPECT_LT(degrees_between(seen.normal(x, y), {-0.15f, 1, 0.1f}), 0.05);
    });
    EXPECT_GT(tops, 500u);
  }
}

TEST(HeightFieldSurface, AgreesWithAFineMarchOfItsDefinition) {
  for (const auto& shape : {&bumpy, &holed}) {
    const HeightField field = field_of(21, *shape);
    const HeightFieldBody body(field);
    Random random(11);
    int met = 0;
    for (int n = 0; n < 400; ++n) {
      const vec3 target{random.between(0, 2), random.between(0, 0.7f), random.between(0, 2)};
      const vec3 direction = random.direction();
      const FieldRay ray = body.field_ray({target - 3.0f * direction, direction});
      const glm::dvec3 origin(target - 3.0f * direction), along(direction);
      const double step = 2e-4;
      double first = 1e30, length = 0;
      for (double t = 0; t < 6; t += step)
        if (in_body(field, origin + t * along)) {
          first = std::min(first, t);
          length += step;
        }
      const FieldStretch stretch = body.clipped(ray, 0, 6);
      const FieldChange found = stretch.found() ? body.first(ray, stretch.begin, stretch.end, true) : FieldChange{};
      const double water = stretch.found() ? body.length(ray, stretch.begin, stretch.end) : 0;
      EXPECT_NEAR(water, length, 6 * step);
      if (length < 10 * step) continue;
      ++met;
      EXPECT_NEAR(found.t, first, 2 * step) << n;
    }
    EXPECT_GT(met, 200);
  }
}

TEST(HeightFieldSurface, IsWatertight) {
  const HeightField field = field_of(17, bumpy);
  const auto surface = make_height_field_surface(field);
  // Rays at the field's own lines and corners, straight down and along both axes.
  std::vector<Ray> rays;
  for (int j = 0; j < 17; ++j)
    for (int i = 0; i < 17; ++i) {
      const vec3 p = field.point(static_cast<float>(i), static_cast<float>(j), 0.2f);
      rays.push_back({{p.x, 5, p.z}, {0, -1, 0}});
      rays.push_back({{p.x, 0.2f, -3}, {0, 0, 1}});
      rays.push_back({{-3, 0.2f, p.z}, {1, 0, 0}});
      rays.push_back({p + 4.0f * vec3{0.6f, 0.8f, 0}, {-0.6f, -0.8f, 0}});
    }
  Random random(7);
  for (int n = 0; n < 3000; ++n) {
    const vec3 target{random.between(0, 2), random.between(0.01f, 0.3f), random.between(0, 2)};
    const vec3 direction = random.direction();
    rays.push_back({target - 4.0f * direction, direction});
  }
  const std::vector<float> from(rays.size(), 0.0f), limit(rays.size(), 100.0f);
  const std::vector<std::uint8_t> outside(rays.size(), 0), inside(rays.size(), 1);
  std::vector<Crossing> in(rays.size()), out(rays.size());
  surface->crossings(rays, from, limit, outside, in);
  std::vector<float> begun;
  for (const Crossing& crossing : in) begun.push_back(crossing.distance);
  surface->crossings(rays, begun, limit, inside, out);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_LT(in[i].distance, 100.0f) << i;
    ASSERT_LT(out[i].distance, 100.0f) << i;
    EXPECT_GE(out[i].distance, in[i].distance);
    EXPECT_NEAR(glm::length(in[i].normal), 1.0f, 1e-4f);
    EXPECT_LT(glm::dot(in[i].normal, rays[i].direction), 1e-3f);
    EXPECT_GT(glm::dot(out[i].normal, rays[i].direction), -1e-3f);
  }
}

TEST(HeightFieldSurface, IsSeenFromInsideAndFromBelow) {
  const auto surface = make_height_field_surface(field_of(33, [](float, float) { return 0.5f; }));
  const SurfaceBuffers inside = surface->see(perspective_view({1, 0.2f, 1}, {1, 0.5f, 1.05f}, {0, 1, 0}, 0.5f, 20, 20));
  EXPECT_TRUE(inside.eye_in_water);
  EXPECT_EQ(hits(inside), 400u);
  EXPECT_GT(inside.normal(10, 10).y, 0.99f);
  EXPECT_NEAR(inside.thickness(10, 10), inside.depth(10, 10), 1e-5f);
  const SurfaceBuffers below = surface->see(perspective_view({1, -1, 1}, {1, 0, 1.01f}, {0, 1, 0}, 0.5f, 20, 20));
  EXPECT_FALSE(below.eye_in_water);
  EXPECT_EQ(hits(below), 400u);
  EXPECT_LT(below.normal(10, 10).y, -0.99f);
  expect_consistent(below);
}

TEST(HeightFieldSurface, FillsCubesLikeTheirFaces) {
  const auto surface = make_height_field_surface(field_of(33, holed));
  const View cube = cube_view({0.9f, 0.9f, 1.1f}, 24);
  const SurfaceBuffers whole = surface->see(cube);
  expect_consistent(whole);
  for (int face = 0; face < 6; ++face) {
    const SurfaceBuffers part = surface->see(cube.face(face));
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) EXPECT_EQ(part.depth(x, y), whole.depth(24 * face + x, y));
  }
}

TEST(HeightFieldSurface, HasSidesOnlyWhereTheyAreWanted) {
  const HeightField field = field_of(33, [](float, float) { return 0.5f; });
  const std::vector<Ray> rays{{{-1, 0.25f, 1}, {1, 0, 0}}, {{-0.5f, 1, 1}, glm::normalize(vec3{1, -0.5f, 0})}};
  const std::vector<float> from(2, 0.0f), limit(2, 10.0f);
  const std::vector<std::uint8_t> outside(2, 0);
  std::vector<Crossing> found(2);
  make_height_field_surface(field, true)->crossings(rays, from, limit, outside, found);
  EXPECT_FLOAT_EQ(found[0].distance, 1.0f);
  EXPECT_FLOAT_EQ(found[0].normal.x, -1.0f);
  make_height_field_surface(field, false)->crossings(rays, from, limit, outside, found);
  EXPECT_EQ(found[0].distance, kInfinity);
  EXPECT_NEAR(found[1].distance, std::sqrt(1.25f), 1e-5f);
}

TEST(HeightFieldSurface, ShowsItsSidesUpright) {
  const auto surface = make_height_field_surface(field_of(33, [](float, float) { return 0.5f; }));
  const SurfaceBuffers seen = surface->see(perspective_view({-2, 0.3f, 1}, {0, 0.25f, 1}, {0, 1, 0}, 0.1f, 8, 8));
  for (const vec3 normal : seen.normal) EXPECT_LT(degrees_between(normal, {-1, 0, 0}), 0.01);
}

TEST(HeightFieldOf, FindsAHeightFieldAgain) {
  const HeightField field = field_of(41, bumpy);
  const auto surface = make_height_field_surface(field);
  const HeightField again = height_field_of(*surface, Axis::y, {vec3{0.0f}, vec3{2.0f}}, 0.05f);
  ASSERT_EQ(again.height.width(), 41);
  for (std::size_t i = 0; i < field.height.size(); ++i) EXPECT_NEAR(again.height[i], field.height[i], 2e-4f);
}

TEST(HeightFieldOfAPicture, LiesAsThePictureSays) {
  Image<float> picture(3, 2, 0.0f);
  picture(2, 0) = 1;
  const HeightField field = height_field(picture, Axis::z, {{0, 0, 1}, {2, 1, 3}});
  EXPECT_FLOAT_EQ(field.height(2, 1), 3.0f);
  EXPECT_FLOAT_EQ(field.height(2, 0), 1.0f);
  EXPECT_FLOAT_EQ(field.point(2, 1, 0).y, 1.0f);
}

}  // namespace
}  // namespace meniscus
