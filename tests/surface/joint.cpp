// Particle water beside and above puddles, against both by themselves.
#include "fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// A round puddle at (0.6, 0, 0), 4 mm deep over the level 0, that goes on under the ground around it.
HeightField puddle() {
  HeightField field;
  field.low = {0, -0.6f};
  field.step = vec2{0.02f};
  field.floor = -0.2f;
  field.height = Image<float>(61, 61, -kInfinity);
  for (int j = 0; j < 61; ++j)
    for (int i = 0; i < 61; ++i) {
      const float a = 0.02f * static_cast<float>(i) - 0.6f, b = 0.02f * static_cast<float>(j) - 0.6f;
      const float r = std::sqrt(a * a + b * b);
      if (r < 0.55f) field.height(i, j) = 0.004f - 0.01f * std::max(0.0f, r - 0.4f);
    }
  return field;
}

Particles drops() {
  Particles particles;
  add(particles, {-0.3f, 0.3f, 0});
  add(particles, {0.6f, 0.4f, 0.1f});  // over the puddle
  add(particles, {0.4f, 0.15f, -0.2f});
  return particles;
}

constexpr float kRadius = 0.12f;
std::unique_ptr<Surface> water() { return make_sphere_surface(drops(), kRadius); }

View view() { return perspective_view({0.5f, 0.9f, 1.6f}, {0.3f, 0.1f, 0}, {0, 1, 0}, 0.8f, 120, 90); }

TEST(JointSurface, ShowsTheNearerOfBoth) {
  const auto joint = make_joint_surface(water(), puddle());
  const SurfaceBuffers a = water()->see(view()), b = make_height_field_surface(puddle(), false)->see(view());
  const SurfaceBuffers seen = joint->see(view());
  std::size_t of_water = 0, of_puddle = 0;
  for (std::size_t i = 0; i < seen.depth.size(); ++i) {
    const bool puddle_nearer = b.depth[i] < a.depth[i];
    of_water += !puddle_nearer && a.depth[i] < kInfinity;
    of_puddle += puddle_nearer;
    EXPECT_EQ(seen.depth[i], std::min(a.depth[i], b.depth[i]));
    EXPECT_EQ(seen.normal[i], puddle_nearer ? b.normal[i] : a.normal[i]);
    EXPECT_EQ(seen.coverage[i], std::max(a.coverage[i], b.coverage[i]));
    EXPECT_EQ(seen.thickness[i], puddle_nearer ? b.thickness[i] : a.thickness[i]);
  }
  EXPECT_GT(of_water, 300u);
  EXPECT_GT(of_puddle, 300u);
}

TEST(JointSurface, RefinesAsItSees) {
  const auto joint = make_joint_surface(water(), puddle());
  const SurfaceBuffers coarse = joint->see(view());
  std::vector<vec2> points;
  for (int y = 1; y < 89; y += 2)
    for (int x = 1; x < 119; x += 2) points.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  const SurfaceBuffers fine = joint->refine(view(), coarse, points);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const std::size_t i = static_cast<std::size_t>(points[k].y) * 120 + static_cast<std::size_t>(points[k].x);
    if (!(coarse.depth[i] < kInfinity)) {
      EXPECT_FALSE(fine.depth[k] < kInfinity);
      continue;
    }
    EXPECT_NEAR(fine.depth[k], coarse.depth[i], 1e-4f);
    EXPECT_LT(glm::length(fine.normal[k] - coarse.normal[i]), 1e-2f);
    EXPECT_EQ(fine.coverage[k], 1.0f);
  }
}

/// In which water a point is: 0 none, 1 a drop, 2 the puddle.
int place_of(vec3 p) {
  static const Particles all = drops();
  static const HeightField field = puddle();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (glm::length(p - all.position(i)) < kRadius) return 1;
  if (p.y > 0.01f || p.y < field.floor) return 0;
  const vec2 at = field.grid_point(p);
  const HeightField::Sample sample = field.at(at.x, at.y);
  const float r = std::hypot(p.x - 0.6f, p.z);
  return r < 0.53f && sample.water() && p.y < sample.height && p.y > field.floor ? 2 : 0;
}

TEST(JointSurface, IsCrossedByRaysWhereTheySteppedThroughBoth) {
  const auto joint = make_joint_surface(water(), puddle());
  Random random(5);
  std::vector<Ray> rays;
  std::vector<float> from, limit;
  std::vector<std::uint8_t> inside;
  std::vector<int> starts;
  while (rays.size() < 600) {
    const bool low = rays.size() % 3 == 0;
    const vec3 start =
        low ? vec3{random.between(0.3f, 0.9f), random.between(-0.02f, 0.004f), random.between(-0.3f, 0.3f)}
            : vec3{random.between(-0.5f, 1.1f), random.between(0.02f, 0.6f), random.between(-0.4f, 0.4f)};
    const int place = place_of(start);
    // Nothing is asked of rays that begin under the ground beside the puddle.
    if (place == 0 && start.y < 0.01f) continue;
    // To where there is something.
    const vec3 aim{random.between(-0.4f, 0.9f), random.between(-0.05f, 0.45f), random.between(-0.3f, 0.3f)};
    if (glm::length(aim - start) < 0.05f) continue;
    rays.push_back({start, glm::normalize(aim - start)});
    from.push_back(0);
    limit.push_back(3);
    inside.push_back(place != 0);
    starts.push_back(place);
  }
  std::vector<Crossing> found(rays.size());
  joint->crossings(rays, from, limit, inside, found);
  int compared = 0, in_puddle = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    // Small steps until the place is no longer what it was; the sides and the floor of the puddle are no surface.
    float expected = kInfinity;
    int met = 0;
    constexpr float kStep = 2e-4f;
    for (float t = 0; t < 2.0f; t += kStep) {
      const vec3 p = rays[i].origin + t * rays[i].direction;
      met = place_of(p);
      if ((starts[i] == 0 && met != 0) || (starts[i] != 0 && met != starts[i])) {
        expected = t;
        break;
      }
    }
    if (expected == kInfinity) continue;
    const vec3 there = rays[i].origin + expected * rays[i].direction;
    // Through what is not surface, or too near to the puddle's rim to say.
    if ((starts[i] == 2 || met == 2) && (there.y < -0.01f || std::hypot(there.x - 0.6f, there.z) > 0.5f)) continue;
    ++compared;
    in_puddle += starts[i] == 2;
    EXPECT_NEAR(found[i].distance, expected, 2 * kStep) << i << " from " << starts[i] << " to " << met;
  }
  EXPECT_GT(compared, 150);
  EXPECT_GT(in_puddle, 20);
}

TEST(JointSurface, LetsRaysThatAreJustRefractedIntoAPuddleStayInIt) {
  const auto joint = make_joint_surface(water(), puddle());
  const auto alone = make_height_field_surface(puddle(), false);
  Random random(9);
  for (int k = 0; k < 200; ++k) {
    // A start on the surface as it is rounded, then down, up from the ground, and through the surface again.
    const Ray down{{random.between(0.3f, 0.9f), 0.3f, random.between(-0.25f, 0.25f)},
                   glm::normalize(vec3{random.between(-0.4f, 0.4f), -1, random.between(-0.4f, 0.4f)})};
    const float zero = 0, far = 5;
    std::uint8_t outside = 0, in = 1;
    Crossing top, bottom, alone_bottom;
    alone->crossings({&down, 1}, {&zero, 1}, {&far, 1}, {&outside, 1}, {&top, 1});
    if (!(top.distance < kInfinity)) continue;
    const Ray into{down.origin + top.distance * down.direction, down.direction};
    joint->crossings({&into, 1}, {&zero, 1}, {&far, 1}, {&in, 1}, {&bottom, 1});
    alone->crossings({&into, 1}, {&zero, 1}, {&far, 1}, {&in, 1}, {&alone_bottom, 1});
    EXPECT_EQ(bottom.distance, alone_bottom.distance);
  }
}

TEST(JointSurface, IsTheOtherWhereOneIsWithoutWater) {
  HeightField dry = puddle();
  for (float& height : dry.height) height = -kInfinity;
  EXPECT_EQ(make_joint_surface(water(), dry)->bounds().high, water()->bounds().high);
  EXPECT_EQ(make_joint_surface(nullptr, puddle())->bounds().high, puddle().bounds().high);
  EXPECT_EQ(make_joint_surface(make_sphere_surface(Particles{}, 0.1f), puddle())->bounds().high,
            puddle().bounds().high);
  const auto none = make_joint_surface(nullptr, HeightField{});
  EXPECT_TRUE(none->bounds().empty());
  EXPECT_FALSE(none->see(view()).depth[0] < kInfinity);
  Bounds both = water()->bounds();
  both.add(puddle().bounds());
  EXPECT_EQ(make_joint_surface(water(), puddle())->bounds().low, both.low);
  EXPECT_EQ(make_joint_surface(water(), puddle())->bounds().high, both.high);
}

}  // namespace
}  // namespace meniscus
