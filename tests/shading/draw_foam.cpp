// Discs of foam: where they are seen, what hides them, how much of a pixel they cover.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "meniscus/shading.h"

namespace meniscus {
namespace {

constexpr int kWidth = 160, kHeight = 120;
const vec3 kUp{0, 1, 0};

struct Picture {
  View view;
  SurfaceBuffers water;
  Image<float> solids;
  Image<vec3> radiance;
};

/// Nothing but black, seen from above at a slant.
Picture empty_picture(vec3 eye = {0, 2, 3}, int scale = 1) {
  Picture p;
  p.view = perspective_view(eye, {0, 0, 0}, kUp, 0.7f, kWidth * scale, kHeight * scale);
  const float infinity = std::numeric_limits<float>::infinity();
  p.water.depth = Image<float>(p.view.width, p.view.height, infinity);
  p.water.normal = Image<vec3>(p.view.width, p.view.height, vec3(0));
  p.water.coverage = Image<float>(p.view.width, p.view.height, 0.0f);
  p.solids = Image<float>(p.view.width, p.view.height, infinity);
  p.radiance = Image<vec3>(p.view.width, p.view.height, vec3(0));
  return p;
}

/// The same with still water up to y = 0 everywhere.
Picture over_water() {
  Picture p = empty_picture();
  for (int y = 0; y < p.view.height; ++y)
    for (int x = 0; x < p.view.width; ++x) {
      const Ray ray = p.view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      if (ray.direction.y >= 0) continue;
      p.water.depth(x, y) = -ray.origin.y / ray.direction.y;
      p.water.normal(x, y) = kUp;
      p.water.coverage(x, y) = 1;
    }
  return p;
}

void draw(Picture& p, std::vector<vec3> places, FoamLook look = {0.02f}, const Material& material = {},
          const Environment& environment = Environment{EnvironmentOptions{}}) {
  draw_foam(p.view, places, look, environment, material, kUp, p.water, p.solids, p.radiance);
}

/// The middle of what is not black, weighted by brightness, px.
vec2 middle_of(const Image<vec3>& picture) {
  vec2 sum(0);
  float weight = 0;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      sum += picture(x, y).y * vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      weight += picture(x, y).y;
    }
  return sum / weight;
}

float light_of(const Image<vec3>& picture) {
  float sum = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) sum += picture[i].y;
  return sum;
}

TEST(Foam, IsSeenWhereItIs) {
  Picture p = empty_picture();
  const vec3 place{0.3f, 0.2f, -0.1f};
  draw(p, {place});
  const vec3 at = p.view.project(place);
  EXPECT_LT(glm::length(middle_of(p.radiance) - vec2(at.x, at.y)), 0.1f);
}

TEST(Foam, IsBrighterWithTheSunInTheBack) {
  EnvironmentOptions behind_the_eye, behind_the_foam;
  behind_the_eye.sun_direction = {0, 2, 3};
  behind_the_foam.sun_direction = {0, 0.3f, -3};
  float light[2];
  int i = 0;
  for (const EnvironmentOptions& options : {behind_the_eye, behind_the_foam}) {
    Picture p = empty_picture();
    draw(p, {vec3(0)}, {0.02f}, {}, Environment(options));
    light[i++] = light_of(p.radiance);
  }
  EXPECT_GT(light[0], 2 * light[1]);
  EXPECT_GT(light[1], 0);
}

TEST(Foam, CoversAsMuchHoweverSmallItIsInThePicture) {
  // One disc, its light times the area of a pixel, in pictures of which the first is far too coarse to show it.
  float light[3];
  for (const int scale : {1, 2, 8}) {
    Picture p = empty_picture({0, 2, 3}, scale);
    draw(p, {vec3(0.004f, 0.003f, 0)}, {0.01f});
    light[scale / 3 + (scale == 2 ? 1 : 0)] = light_of(p.radiance) / static_cast<float>(scale * scale);
  }
  EXPECT_NEAR(light[0] / light[2], 1, 0.25f);
  EXPECT_NEAR(light[1] / light[2], 1, 0.15f);
}

TEST(Foam, IsHiddenBySolidsBeforeItOnly) {
  const vec3 place(0);
  Picture open = empty_picture(), hidden = empty_picture(), before = empty_picture();
  const float distance = glm::length(place - open.view.eye);
  hidden.solids = Image<float>(kWidth, kHeight, distance - 0.1f);
  before.solids = Image<float>(kWidth, kHeight, distance + 0.1f);
  for (Picture* p : {&open, &hidden, &before}) draw(*p, {place});
  EXPECT_EQ(light_of(hidden.radiance), 0);
  EXPECT_EQ(light_of(before.radiance), light_of(open.radiance));
}

/// Where the ray from the eye meets the surface y = 0 on its way to a point under it, by Snell's law: bisection in
/// double precision in the plane that holds both.
vec3 refracted_place(vec3 eye, vec3 under, double ior) {
  const double run = std::hypot(under.x - eye.x, under.z - eye.z), high = eye.y, deep = -under.y;
  double low = 0, far = run;
  for (int i = 0; i < 200; ++i) {
    const double s = 0.5 * (low + far);
    const double sine_above = s / std::hypot(s, high), sine_below = (run - s) / std::hypot(run - s, deep);
    (sine_above < ior * sine_below ? low : far) = s;
  }
  const double part = low / run;
  return {static_cast<float>(eye.x + part * (under.x - eye.x)), 0.0f,
          static_cast<float>(eye.z + part * (under.z - eye.z))};
}

TEST(Foam, UnderTheSurfaceIsSeenWhereSnellsLawSaysAndDimmer) {
  const vec3 place{0.25f, -0.4f, -0.3f};
  Material water;
  water.ior = 1.333f;
  Picture clear = over_water(), tinted = over_water(), in_air = empty_picture();
  draw(clear, {place}, {0.02f}, water);
  draw(in_air, {place}, {0.02f}, water);
  water.extinction = vec3(0, 1, 0);
  draw(tinted, {place}, {0.02f}, water);
  const vec3 surface = refracted_place(clear.view.eye, place, 1.333);
  const vec3 at = clear.view.project(surface), direct = clear.view.project(place);
  ASSERT_GT(glm::length(vec2(at.x, at.y) - vec2(direct.x, direct.y)), 5) << "the water must matter";
  EXPECT_LT(glm::length(middle_of(clear.radiance) - vec2(at.x, at.y)), 0.3f);
  EXPECT_LT(light_of(clear.radiance), light_of(in_air.radiance));
  EXPECT_GT(light_of(clear.radiance), 0.8f * light_of(in_air.radiance));
  const float path = glm::length(place - surface);
  EXPECT_NEAR(light_of(tinted.radiance) / light_of(clear.radiance), std::exp(-2 * path), 0.02f);
}

TEST(Foam, OnTheSurfaceIsNotTakenForUnder) {
  Picture on = over_water(), in_air = empty_picture();
  draw(on, {vec3(0.1f, 0.005f, 0)});
  draw(in_air, {vec3(0.1f, 0.005f, 0)});
  EXPECT_EQ(light_of(on.radiance), light_of(in_air.radiance));
}

TEST(Foam, BehindTheEyeOrBesideThePictureIsNotSeen) {
  Picture p = empty_picture();
  draw(p, {vec3(0, 2.5f, 4), vec3(50, 0, 0), p.view.eye});
  EXPECT_EQ(light_of(p.radiance), 0);
}

TEST(Foam, HasTheSameBitsForAnyNumberOfThreadsAndOrder) {
  std::vector<vec3> places;
  for (int i = 0; i < 3000; ++i) {
    const auto f = static_cast<float>(i);
    places.emplace_back(std::sin(f * 12.9f), 0.5f * std::sin(f * 3.7f), std::cos(f * 7.3f));
  }
  Image<vec3> first;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    Picture p = over_water();
    draw(p, places);
    if (first.empty()) first = p.radiance;
    EXPECT_EQ(std::memcmp(first.data(), p.radiance.data(), first.size() * sizeof(vec3)), 0) << threads;
  }
}

TEST(Foam, RefusesWhatCannotBeMeant) {
  Picture p = empty_picture();
  EXPECT_THROW(draw(p, {vec3(0)}, {0.0f}), Error);
  EXPECT_THROW(draw(p, {vec3(0)}, {0.01f, 2.0f}), Error);
  p.solids = Image<float>(3, 3, 1.0f);
  EXPECT_THROW(draw(p, {vec3(0)}), Error);
}

}  // namespace
}  // namespace meniscus
