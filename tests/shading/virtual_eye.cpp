// What is seen through still water by virtual eyes, against Snell's law solved by Fermat's principle.
#include <gtest/gtest.h>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "fixtures.h"
#include "shading/virtual_eye.h"

namespace meniscus {
namespace {

using namespace tests;

constexpr float kLevel = 0.5f, kIor = 1.333f;
constexpr int kSize = 400;

HeightField still_field() {
  HeightField field;
  field.low = {-2, -2};
  field.step = {0.125f, 0.125f};
  field.height = Image<float>(33, 33, kLevel);
  field.normal = Image<vec3>(33, 33, vec3{0, 1, 0});
  return field;
}

/// The level surface everywhere; rays can be followed through it.
class StillWater : public Surface {
 public:
  SurfaceBuffers see(const View& view, std::span<const vec2>, StageTimes*) const override {
    SurfaceBuffers seen = even(view.width, view.height, std::numeric_limits<float>::infinity(), vec3{0}, 0);
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        const float t = (kLevel - ray.origin.y) / ray.direction.y;
        seen.coverage(x, y) = t > 0 ? 1.0f : 0.0f;
        if (t > 0) {
          seen.depth(x, y) = t;
          seen.normal(x, y) = {0, 1, 0};
        }
      }
    seen.eye_in_water = view.eye.y < kLevel;
    return seen;
  }
  Image<float> thickness(const View& view, std::span<const vec2>, StageTimes*) const override {
    return Image<float>(view.width, view.height, 0.0f);
  }
  bool can_march() const override { return true; }
  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      found[i] = {};
      const float t = (kLevel - rays[i].origin.y) / rays[i].direction.y;
      if ((rays[i].direction.y > 0) == (inside[i] != 0) && t > from[i] + 1e-4f && t <= limit[i])
        found[i] = {t, {0, 1, 0}};
    }
  }
  Bounds bounds() const override { return {vec3{-2, 0, -2}, vec3{2, kLevel, 2}}; }
};

/// Where light from a point on the other side passes through the surface on its way to the eye: the least time, by
/// golden section.
glm::dvec3 fermat(glm::dvec3 eye, glm::dvec3 target, double n_eye, double n_target) {
  const glm::dvec3 a{eye.x, static_cast<double>(kLevel), eye.z}, b{target.x, static_cast<double>(kLevel), target.z};
  const auto time = [&](double s) {
    const glm::dvec3 p = a + s * (b - a);
    return n_eye * glm::length(p - eye) + n_target * glm::length(target - p);
  };
  const double golden = 0.5 * (std::sqrt(5.0) - 1);
  double low = 0, high = 1;
  for (int i = 0; i < 90; ++i) {
    const double x = high - golden * (high - low), y = low + golden * (high - low);
    (time(x) < time(y) ? high : low) = time(x) < time(y) ? y : x;
  }
  return a + 0.5 * (low + high) * (b - a);
}

vec2 pictured(const View& view, glm::dvec3 point) {
  const vec3 at = view.project(vec3(point));
  return {at.x, at.y};
}

/// A black pole under an even sky: where it is seen it is dark.
struct Pole {
  glm::dvec3 top, end;
  Scene scene = without_ground(uniform_environment());
  HeightField field = still_field();
  Material material = clear(kIor);

  Pole(glm::dvec3 a, glm::dvec3 b, float radius = 0.012f) : top(a), end(b) {
    material.specular = 0;  // no mirror image
    scene.set_solids({{make_solid(cylinder_mesh(vec3(end), vec3(top), radius)), glm::mat4(1.0f),
                       SolidMaterial{vec3{0.0f}, "", 1, 1.5f}}});
  }
  Image<vec3> picture(const View& view, const OpticsOptions& options) const {
    const StillWater water;
    const auto objects = water_objects(field, scene, options.eyes);
    const auto eyes = make_virtual_eyes(view, field, scene, objects, material, options.eyes);
    return shade(view, {}, water.see(view, {}, nullptr), scene, material, {options, nullptr, &water, eyes.get()});
  }
  /// A point of the pole under water; 0 at the surface, 1 at its end.
  glm::dvec3 under(double share) const {
    const double t = (static_cast<double>(kLevel) - top.y) / (end.y - top.y);
    return top + (t + share * (1 - t)) * (end - top);
  }
};

Pole oblique() { return Pole({-0.25, 0.9, 0.1}, {0.2, 0.05, -0.1}); }

View from_height(float height, int size = kSize) {
  return perspective_view({0.3f, height, 2.0f}, {0, 0.35f, 0}, {0, 1, 0}, 0.5f, size, size);
}

/// As published: objects are looked up by direction.
OpticsOptions by_eyes() {
  OpticsOptions options;
  options.refraction = RefractionMethod::virtual_eye;
  options.eyes.object_position = options.eyes.static_position = false;
  return options;
}

/// The largest distance, px across, between the dark line of the picture and where the pole's points should be seen.
float largest_error(const Pole& pole, const View& view, const Image<vec3>& picture) {
  float worst = 0;
  for (double share = 0.1; share < 0.9; share += 0.01) {
    const glm::dvec3 point = pole.under(share);
    const vec2 expected = pictured(view, fermat(glm::dvec3(view.eye), point, 1, static_cast<double>(kIor)));
    const int y = static_cast<int>(expected.y);
    // The place of the line in this row: that of the point of the pole which is expected in the row's middle.
    const vec2 next =
        pictured(view, fermat(glm::dvec3(view.eye), pole.under(share + 0.01), 1, static_cast<double>(kIor)));
    const float slope = (next.x - expected.x) / (next.y - expected.y);
    const float x = expected.x + slope * (static_cast<float>(y) + 0.5f - expected.y);
    float sum = 0, weight = 0;
    for (int px = std::max(0, static_cast<int>(x) - 30); px < std::min(view.width, static_cast<int>(x) + 31); ++px) {
      const float dark = 1.0f - picture(px, y).y;
      sum += dark * (static_cast<float>(px) + 0.5f);
      weight += dark;
    }
    worst = std::max(worst, weight > 0.5f ? std::abs(sum / weight - x) : 1e3f);
  }
  return worst;
}

/// The lowest row in which something dark is seen, px.
float lowest_dark(const Image<vec3>& picture) {
  for (int y = picture.height() - 1; y >= 0; --y)
    for (int x = 0; x < picture.width(); ++x)
      if (picture(x, y).y < 0.5f) return static_cast<float>(y) + 0.5f;
  return -1;
}

TEST(VirtualEye, ShowsAnObliquePoleBentBySnellsLawToAPixel) {
  const Pole pole = oblique();
  for (const float height : {1.0f, 1.5f, 2.5f, 4.0f}) {
    const View view = from_height(height);
    OpticsOptions options = by_eyes();
    options.eyes.per_point = true;
    // Seen at a grazing angle the directions of a map lie far apart on the surface.
    if (height < 1.2f) options.eyes.map_size = 4096;
    EXPECT_LT(largest_error(pole, view, pole.picture(view, options)), 1.0f) << height;
    options.eyes.map_size = 0;
    options.eyes.per_point = false;
    options.eyes.object_position = options.eyes.static_position = true;
    EXPECT_LT(largest_error(pole, view, pole.picture(view, options)), 1.0f) << height;
    options.refraction = RefractionMethod::ray_traced;
    EXPECT_LT(largest_error(pole, view, pole.picture(view, options)), 1.0f) << height;
  }
}

TEST(VirtualEye, AsPublishedIsExactAtTheSurfaceAndTheEndOfAThinUprightPole) {
  const Pole pole({0, 0.9, 0}, {0, 0.05, 0});
  for (const float height : {1.0f, 1.5f, 2.5f}) {
    const View view = from_height(height);
    const Image<vec3> picture = pole.picture(view, by_eyes());
    RecordProperty("error_px_at_" + std::to_string(height), std::to_string(largest_error(pole, view, picture)));
    const vec2 end = pictured(view, fermat(glm::dvec3(view.eye), pole.under(1), 1, static_cast<double>(kIor)));
    EXPECT_NEAR(lowest_dark(picture), end.y, 2.0f) << height;
    EXPECT_LT(largest_error(pole, view, picture), 4.0f) << height;
  }
}

TEST(VirtualEye, AsPublishedKeepsTheWidthOfAPoleAtTheSurface) {
  for (const double lean : {0.0, 0.2}) {
    const Pole pole({lean, 0.9, 0}, {-lean, 0.05, 0}, 0.05f);
    const View view = from_height(1.5f);
    const Image<vec3> picture = pole.picture(view, by_eyes());
    const auto width = [&](int row) {
      float sum = 0;
      for (int x = 0; x < view.width; ++x) sum += 1.0f - picture(x, row).y;
      return sum;
    };
    // The waterline's nearest point, and rows above and below of the whole ellipse around it.
    const int row = static_cast<int>(pictured(view, pole.under(0) + glm::dvec3(0, 0, 0.05)).y);
    EXPECT_NEAR(width(row + 6) / width(row - 25), 1.0f, 0.12f) << lean;
  }
}

TEST(VirtualEye, WithoutScaleCorrectionTheLengthUnderWaterIsWrong) {
  const Pole pole({0, 0.9, 0}, {0, 0.05, 0});
  const View view = from_height(1.5f);
  OpticsOptions options = by_eyes();
  options.eyes.scale_correction = false;
  const vec2 end = pictured(view, fermat(glm::dvec3(view.eye), pole.under(1), 1, static_cast<double>(kIor)));
  EXPECT_GT(std::abs(lowest_dark(pole.picture(view, options)) - end.y), 8.0f);
}

TEST(VirtualEye, FromTheEyeItselfThePoleIsBrokenAtTheSurface) {
  // Just below the surface the dark line goes on where that above ends, unless the map is drawn from the eye.
  const Pole pole({0, 0.9, 0}, {0, 0.05, 0});
  const View view = from_height(1.5f);
  const int row = static_cast<int>(pictured(view, pole.under(0)).y) + 3;
  const auto dark = [&](const OpticsOptions& options) {
    const Image<vec3> picture = pole.picture(view, options);
    float sum = 0;
    const int x = static_cast<int>(pictured(view, pole.under(0)).x);
    for (int px = x - 2; px <= x + 2; ++px) sum += 1.0f - picture(px, row).y;
    return sum;
  };
  OpticsOptions options = by_eyes();
  EXPECT_GT(dark(options), 2.0f);
  options.eyes.displaced_eye = false;
  EXPECT_LT(dark(options), 0.5f);
}

TEST(VirtualEye, ShowsAWidePlateAsRaysDoWithAnEyeForEachPoint) {
  Pole plate({0, 0.9, 0}, {0, 0.05, 0});
  plate.scene.set_solids({{make_solid(box_mesh({-0.5f, 0.1f, -0.1f}, {0.5f, 0.8f, 0.1f})), glm::mat4(1.0f),
                           SolidMaterial{vec3{0.0f}, "", 1, 1.5f}}});
  const View view = from_height(1.5f, 200);
  OpticsOptions options = by_eyes();
  options.refraction = RefractionMethod::ray_traced;
  const Image<vec3> traced = plate.picture(view, options);
  const auto different = [&](const OpticsOptions& other) {
    const Image<vec3> picture = plate.picture(view, other);
    int count = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) count += std::abs(picture[i].y - traced[i].y) > 0.6f;
    return count;
  };
  options.refraction = RefractionMethod::virtual_eye;
  const int published = different(options);
  options.eyes.per_point = true;
  const int per_point = different(options);
  RecordProperty("different_pixels", std::to_string(published) + " as published, " + std::to_string(per_point));
  EXPECT_GT(published, 300);
  EXPECT_LT(per_point, 60);
}

TEST(VirtualEye, TheReflectedEyeMirrorsAPoleToAPixel) {
  Pole pole({0, 0.9, 0.0}, {0.1, 0.55, 0.05});
  pole.material.specular = 1;
  const View view = from_height(1.2f);
  const Image<vec3> picture = pole.picture(view, by_eyes());
  // The mirror image of a point is seen in the direction of the point mirrored by the surface.
  for (double share = 0.1; share < 0.95; share += 0.05) {
    glm::dvec3 point = glm::mix(pole.top, pole.end, share);
    point.y = 2 * static_cast<double>(kLevel) - point.y;
    const vec2 at = pictured(view, point);
    EXPECT_LT(picture(static_cast<int>(at.x), static_cast<int>(at.y)).y, 0.99f) << share;
    EXPECT_GT(picture(static_cast<int>(at.x) + 8, static_cast<int>(at.y)).y, 0.999f) << share;
  }
}

TEST(VirtualEye, SeesThroughSnellsWindowFromBelowAsRaysDo) {
  Pole pole({0.1, 1.0, -0.3}, {0.1, 0.2, -0.3}, 0.05f);
  pole.material.specular = 1;
  const View view = perspective_view({0, 0.1f, 0.5f}, {0.05f, 0.6f, -0.1f}, {0, 1, 0}, 1.4f, 120, 120);
  OpticsOptions options = by_eyes();
  options.refraction = RefractionMethod::ray_traced;
  const Image<vec3> traced = pole.picture(view, options);
  options.refraction = RefractionMethod::virtual_eye;
  options.eyes.per_point = true;
  const Image<vec3> picture = pole.picture(view, options);
  int dark = 0, different = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    dark += traced[i].y < 0.5f;
    different += std::abs(picture[i].y - traced[i].y) > 0.5f;
  }
  EXPECT_GT(dark, 300);
  EXPECT_LT(different, dark / 10);
}

TEST(VirtualEye, DrawsTheSameBitsWithAnyNumberOfThreads) {
  const Pole pole = oblique();
  const View view = from_height(1.5f, 120);
  Image<vec3> first, second;
  {
    const ThreadLimit limit(1);
    first = pole.picture(view, by_eyes());
  }
  {
    const ThreadLimit limit(5);
    second = pole.picture(view, by_eyes());
  }
  ASSERT_EQ(first.size(), second.size());
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(vec3)), 0);
}

/// A lit tank with a post through waves.
struct LitTank {
  Scene scene{Environment{EnvironmentOptions{}}, Ground{}};
  HeightField field;
  Material material = material_preset("water", 1.0f);

  LitTank() {
    Tank tank;
    tank.style = TankStyle::tiled;
    tank.inside = {{0, 0, 0}, {1, 0.6f, 1}};
    scene.set_tank(tank);
    scene.set_solids({{make_solid(cylinder_mesh({0.5f, 0, 0.5f}, {0.55f, 0.5f, 0.45f}, 0.06f)), glm::mat4(1.0f),
                       SolidMaterial{vec3{0.7f, 0.3f, 0.1f}, "", 1, 1.5f}}});
    WaveFieldOptions waves;
    waves.region = {{0, 0, 0}, {1, 0.3f, 1}};
    waves.step = 1.0f / 64;
    waves.waves.resize(1);
    waves.waves[0].amplitude = 0.01f;
    waves.waves[0].wavelength = 0.4f;
    field = height_field(waves, 0);
  }
  Image<vec3> picture(const View& view, const OpticsOptions& options) const {
    HeightField bent = field;
    const auto objects = water_objects(bent, scene, options.eyes);
    adapt(bent, adaptations(objects, options.eyes));
    const auto surface = make_height_field_surface(std::move(bent));
    const auto eyes = make_virtual_eyes(view, *surface->height_field(), scene, objects, material, options.eyes);
    return shade(view, {}, surface->see(view), scene, material, {options, nullptr, surface.get(), eyes.get()});
  }
};

View over_tank(int size) {
  return perspective_view({0.6f, 1.3f, 2.0f}, {0.5f, 0.25f, 0.5f}, {0, 1, 0}, 0.45f, size, size);
}

TEST(VirtualEye, ShowsWhatStandsStillAsSingleRaysDo) {
  LitTank tank;
  tank.scene.set_solids({});
  OpticsOptions options;
  options.refraction = RefractionMethod::ray_traced;
  options.bounces = 1;
  const Image<vec3> traced = tank.picture(over_tank(160), options);
  options.refraction = RefractionMethod::virtual_eye;
  const Image<vec3> picture = tank.picture(over_tank(160), options);
  double sum = 0;
  int far_off = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const float difference = std::abs(picture[i].y - traced[i].y);
    sum += static_cast<double>(difference);
    far_off += difference > 0.1f;
  }
  RecordProperty("mean_difference", std::to_string(sum / static_cast<double>(picture.size())));
  // Shadows have edges as wide as the tables' steps.
  EXPECT_LT(sum / static_cast<double>(picture.size()), 0.015);
  EXPECT_LT(far_off, static_cast<int>(picture.size() / 40));
}

TEST(VirtualEye, KeepsAPostWholeThroughWavesByDefault) {
  // The picture with its object differs little from single rays into the whole scene.
  const LitTank tank;
  OpticsOptions options;
  options.refraction = RefractionMethod::ray_traced;
  options.bounces = 1;
  const Image<vec3> traced = tank.picture(over_tank(160), options);
  options.refraction = RefractionMethod::virtual_eye;
  const auto far_off = [&] {
    const Image<vec3> picture = tank.picture(over_tank(160), options);
    int count = 0;
    for (std::size_t i = 0; i < picture.size(); ++i) count += std::abs(picture[i].z - traced[i].z) > 0.1f;
    return count;
  };
  const int by_default = far_off();
  options.eyes.object_position = false;
  const int published = far_off();
  RecordProperty("far_off", std::to_string(by_default) + " of 25600, as published " + std::to_string(published));
  EXPECT_LT(by_default, 800);
  EXPECT_LT(by_default, published);
}

TEST(VirtualEye, ShowsABallBehindAnotherAsSingleRaysDo) {
  // From above, under waves; balls of different colours, the second beside, half behind and behind the first.
  LitTank tank;
  const auto ball = [](vec3 centre, float radius, vec3 colour) {
    return PlacedSolid{make_solid(sphere_mesh(centre, radius)), glm::mat4(1.0f), SolidMaterial{colour, "", 1, 1.5f}};
  };
  OpticsOptions options;
  for (const float side : {0.0f, 0.08f, 0.16f, 0.3f}) {
    tank.scene.set_solids({ball({0.45f, 0.12f, 0.65f}, 0.1f, {0.9f, 0.05f, 0.05f}),
                           ball({0.45f + side, 0.1f, 0.3f}, 0.09f, {0.05f, 0.05f, 0.9f})});
    options.refraction = RefractionMethod::ray_traced;
    options.bounces = 1;
    const View view = perspective_view({0.6f, 0.9f, 1.6f}, {0.5f, 0.15f, 0.45f}, {0, 1, 0}, 0.3f, 160, 160);
    const Image<vec3> traced = tank.picture(view, options);
    options.refraction = RefractionMethod::virtual_eye;
    ASSERT_EQ(water_objects(tank.field, tank.scene, options.eyes).size(), 2U);
    const Image<vec3> picture = tank.picture(view, options);
    int blue = 0, red = 0, wrong = 0;
    const auto colour = [](vec3 c) { return c.z > 6.0f * c.x ? 1 : c.x > 2.5f * c.z ? 2 : 0; };
    for (std::size_t i = 0; i < picture.size(); ++i) {
      blue += colour(traced[i]) == 1;
      red += colour(traced[i]) == 2;
      wrong += colour(picture[i]) != colour(traced[i]);
    }
    RecordProperty("wrong_at_" + std::to_string(static_cast<int>(side * 100)),
                   std::to_string(wrong) + " blue " + std::to_string(blue) + " red " + std::to_string(red));
    EXPECT_GT(blue, 100);
    EXPECT_GT(red, 500);
    EXPECT_LT(wrong, (blue + red) / 20) << side;
  }
}

TEST(VirtualEye, ObjectsShareAMapOnlyWhereTheyDoNotMeet) {
  const auto cone = [](float angle, float half) { return Cone{{std::sin(angle), 0, std::cos(angle)}, half}; };
  const std::vector<Cone> cones{cone(0, 0.1f), cone(0.15f, 0.1f), cone(0.3f, 0.1f), cone(0.16f, 0.3f), cone(1, 0.1f)};
  EXPECT_EQ(map_layers(cones), (std::vector<std::size_t>{0, 1, 0, 2, 0}));
  EXPECT_TRUE(map_layers({}).empty());
}

TEST(VirtualEye, DrawsTheSameBitsOfALitTankWithAnyNumberOfThreads) {
  const LitTank tank;
  OpticsOptions options;
  options.refraction = RefractionMethod::virtual_eye;
  Image<vec3> first, second;
  {
    const ThreadLimit limit(1);
    first = tank.picture(over_tank(90), options);
  }
  {
    const ThreadLimit limit(5);
    second = tank.picture(over_tank(90), options);
  }
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(vec3)), 0);
}

TEST(VirtualEye, RefusesWhatItCannotDo) {
  const Pole pole = oblique();
  VirtualEyeOptions options;
  const View flat = orthographic_view({0, 2, 0}, {0, 0, 0}, {0, 0, 1}, 2, 10, 10);
  EXPECT_THROW(make_virtual_eyes(flat, pole.field, pole.scene, {}, pole.material, options), Error);
  for (const float bad : {-1.0f, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    VirtualEyeOptions wrong;
    wrong.trapezium_a = bad;
    EXPECT_THROW(water_objects(pole.field, pole.scene, wrong), Error);
  }
  options.map_size = 7;
  EXPECT_THROW(adaptations({}, options), Error);
  EXPECT_THROW(make_virtual_eyes(from_height(1, 8), HeightField{}, pole.scene, {}, pole.material, {}), Error);
}

}  // namespace
}  // namespace meniscus
