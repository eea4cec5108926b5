// Rays into height fields by sixteens, against the same rays one after another.
#include "surface/height_field_packet.h"
#include "surface/fixtures.h"
#include "surface/height_field_grid.h"
#include "surface/packet_rays.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// A field of 2 x 2 m over heights h(a, b), floor 0.
template <class F>
HeightField field_of(int points, F h, Axis up = Axis::y) {
  HeightField field = blank_field(up, {vec3{0.0f}, vec3{2.0f}}, 2.0f / static_cast<float>(points - 1));
  for (int j = 0; j < field.height.height(); ++j)
    for (int i = 0; i < field.height.width(); ++i)
      field.height(i, j) = h(static_cast<float>(i) * field.step.x, static_cast<float>(j) * field.step.y);
  find_normals(field);
  return field;
}

float flat(float, float) { return 0.5f; }
float bumpy(float x, float z) { return 0.5f + 0.1f * std::sin(5 * x + z) + 0.05f * std::cos(9 * z - 2 * x); }
float rough(float x, float z) { return 0.5f + 0.2f * std::sin(70 * x) * std::cos(50 * z + 3 * x); }
float holed(float x, float z) { return std::hypot(x - 1.2f, z - 0.7f) < 0.3f ? -kInfinity : bumpy(x, z); }
float islands(float x, float z) { return std::sin(9 * x) * std::sin(7 * z) > 0.2f ? bumpy(z, x) : -kInfinity; }

struct Seen {
  std::size_t rays = 0, hits = 0, unsettled = 0, other = 0;
  std::vector<double> depth, normal, thickness;  ///< differences: steps, radians, m
};

/// All rays of a picture by sixteens and one by one.
void compare(const HeightFieldRays& water, const View& view, Seen& seen) {
  PacketRays rays;
  FieldHits hits;
  const double step = static_cast<double>(water.field().step.x);
  for (int y = 0; y < view.height; y += kPacketHeight)
    for (int x = 0; x < view.width; x += kPacketWidth) {
      const PacketMask mask = picture_rays(view, x, y, rays);
      enter_packet(water, rays, mask, true, hits);
      EXPECT_EQ((hits.hit | hits.unsettled) & ~mask, 0u);
      EXPECT_EQ(hits.hit & hits.unsettled, 0u);
      for (int l = 0; l < kPacket; ++l) {
        if (!((mask >> l) & 1u)) continue;
        ++seen.rays;
        if ((hits.unsettled >> l) & 1u) {
          ++seen.unsettled;
          continue;
        }
        const Ray ray{{rays.ox[l], rays.oy[l], rays.oz[l]}, {rays.dx[l], rays.dy[l], rays.dz[l]}};
        const FieldRay in_field = water.body().field_ray(ray);
        const FieldStretch stretch = water.body().clipped(in_field, 0, static_cast<double>(kInfinity));
        const FieldChange change = stretch.found() ? water.enter(in_field, stretch, 1e30) : FieldChange{};
        if (change.found() != (((hits.hit >> l) & 1u) != 0)) {
          ++seen.other;
          continue;
        }
        if (!change.found()) continue;
        ++seen.hits;
        seen.depth.push_back(std::abs(change.t - static_cast<double>(hits.depth[l])) / step);
        const vec3 normal{hits.normal[3 * l], hits.normal[3 * l + 1], hits.normal[3 * l + 2]};
        seen.normal.push_back(static_cast<double>(glm::length(normal - water.normal(ray, in_field, change, true))));
        if (!((hits.unmeasured >> l) & 1u))
          seen.thickness.push_back(
              std::abs(water.body().length(in_field, change.t, stretch.end) - static_cast<double>(hits.thickness[l])));
      }
    }
}

View usual(const HeightField& field, int width, int height) {
  return looking_at(field.bounds(), {0.3f, 0.6f, 1}, Projection::perspective, width, height);
}

TEST(HeightFieldPacket, MeetsWhatSingleRaysMeetWithEveryInstructionSet) {
  for (const std::string& set : instruction_sets()) {
    use_instruction_set(set);
    for (const auto shape : {flat, bumpy, rough, holed, islands})
      for (const Axis up : {Axis::y, Axis::z}) {
        const HeightField field = field_of(shape == rough ? 65 : 24, shape, up);
        const HeightFieldRays water(field, true);
        Seen seen;
        Random random(17);
        for (int n = 0; n < 10; ++n)
          compare(water, looking_at(field.bounds(), random.direction(), kProjections[n % 2], 67, 51), seen);
        const double rays = static_cast<double>(seen.rays);
        EXPECT_GT(seen.hits, shape == islands ? 100u : seen.rays / 8) << set;
        EXPECT_LT(static_cast<double>(seen.other), 1e-4 * rays) << set;
        EXPECT_LT(static_cast<double>(seen.unsettled), (shape == holed || shape == islands ? 0.4 : 0.01) * rays) << set;
        // A float holds a distance of a few metres to 3e-7 m, which is 1e-5 of these steps.
        EXPECT_LT(quantile(seen.depth, 0.999), 1e-5) << set;
        EXPECT_LT(quantile(seen.depth, 1), 1e-4) << set;
        EXPECT_LT(quantile(seen.normal, 0.999), 1e-5) << set;
        EXPECT_LT(quantile(seen.thickness, 0.99), 1e-5) << set;
        EXPECT_LT(quantile(seen.thickness, 1), 1e-2 * static_cast<double>(field.step.x)) << set;
      }
  }
  use_instruction_set("best");
}

TEST(HeightFieldPacket, LeavesHardlyAnyUsualRayToBeFollowedAlone) {
  const HeightField field = field_of(129, bumpy);
  Seen seen;
  compare(HeightFieldRays(field, true), usual(field, 200, 160), seen);
  EXPECT_GT(seen.hits, 8'000u);
  EXPECT_EQ(seen.other, 0u);
  EXPECT_LT(static_cast<double>(seen.unsettled), 1e-3 * static_cast<double>(seen.rays));
}

TEST(HeightFieldPacket, PassesSidesThatAreNoSurface) {
  const HeightField field = field_of(33, bumpy);
  const HeightFieldRays water(field, false);
  Seen seen;
  compare(water, usual(field, 90, 70), seen);
  EXPECT_EQ(seen.other, 0u);
  EXPECT_GT(seen.hits, 1000u);
  EXPECT_GT(seen.unsettled, 100u);
}

TEST(HeightFieldPacket, HasTheRaysOfTheView) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic, Projection::cube}) {
    const View view = projection == Projection::cube
                          ? cube_view({0.3f, 0.2f, 0.7f}, 13)
                          : looking_at({vec3{0.0f}, vec3{1.0f}}, {1, 0.7f, -0.4f}, projection, 37, 23);
    PacketRays rays;
    for (int y = 0; y < view.height; y += kPacketHeight)
      for (int x = 0; x < view.width; x += kPacketWidth) {
        const PacketMask mask = picture_rays(view, x, y, rays);
        for (int l = 0; l < kPacket; ++l) {
          const int px = x + l % kPacketWidth, py = y + l / kPacketWidth;
          ASSERT_EQ((mask >> l) & 1u, px < view.width && py < view.height ? 1u : 0u);
          if (!((mask >> l) & 1u)) continue;
          const Ray ray = pixel_ray(view, px, py);
          ASSERT_EQ(ray.origin, (vec3{rays.ox[l], rays.oy[l], rays.oz[l]}));
          ASSERT_EQ(ray.direction, (vec3{rays.dx[l], rays.dy[l], rays.dz[l]}));
        }
      }
  }
}

TEST(HeightField, IsTheSameWithEveryInstructionSet) {
  const Particles water = wavy_tank();
  HeightFieldOptions options;
  options.spacing = kSpacing;
  options.up = Axis::z;
  use_instruction_set("best");
  const HeightField best = height_field(water, options);
  for (const std::string& set : instruction_sets()) {
    use_instruction_set(set);
    const HeightField field = height_field(water, options);
    ASSERT_EQ(field.height.size(), best.height.size());
    for (std::size_t i = 0; i < field.height.size(); ++i) {
      EXPECT_EQ(field.height[i] > -kInfinity, best.height[i] > -kInfinity);
      if (best.height[i] > -kInfinity) {
        EXPECT_NEAR(field.height[i], best.height[i], 1e-3f * kSpacing) << set;
      }
    }
  }
  use_instruction_set("best");
}

TEST(HeightFieldSurface, LeavesTheThicknessOutWhereItIsNotWanted) {
  for (const auto shape : {bumpy, holed}) {
    const HeightField field = field_of(33, shape);
    const View view = usual(field, 61, 47);
    const SurfaceBuffers with = make_height_field_surface(field)->see(view);
    const auto surface = make_height_field_surface(field, true, false);
    const SurfaceBuffers without = surface->see(view);
    EXPECT_TRUE(same_bits(with.depth, without.depth));
    EXPECT_TRUE(same_bits(with.normal, without.normal));
    EXPECT_TRUE(same_bits(without.thickness, Image<float>(61, 47, 0.0f)));
    const Image<float> thickness = surface->thickness(view);
    for (std::size_t i = 0; i < thickness.size(); ++i) {
      if (with.coverage[i] > 0) {
        EXPECT_NEAR(with.thickness[i], thickness[i], 1e-4f);
      }
    }
  }
}

TEST(HeightFieldSurface, SeesTheSameAtPointsAsInThePicture) {
  const HeightField field = field_of(33, holed);
  const auto surface = make_height_field_surface(field);
  const View view = usual(field, 45, 31);
  std::vector<vec2> points;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      points.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  const SurfaceBuffers picture = surface->see(view), listed = surface->see(view, points);
  ASSERT_EQ(listed.depth.size(), picture.depth.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(listed.coverage[i], picture.coverage[i]);
    if (picture.coverage[i] > 0) {
      EXPECT_NEAR(listed.depth[i], picture.depth[i], 1e-6f);
    }
  }
}

}  // namespace
}  // namespace meniscus
