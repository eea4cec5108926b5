#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "base/random.h"
#include "fixtures.h"
#include "shading/draw_rain_light.h"

namespace meniscus::tests {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kPi = std::numbers::pi;

WaterPiece ball(vec3 centre, float radius) {
  return {WaterPiece::Kind::sphere, centre, vec3{0.0f}, vec3{0.0f}, radius, 1};
}
WaterPiece streak(vec3 from, vec3 to, float radius) {
  return {WaterPiece::Kind::streak, from, to, vec3{0.0f}, radius, 1};
}
WaterPiece disk(vec3 centre, vec3 normal, float radius) {
  return {WaterPiece::Kind::disk, centre, vec3{0.0f}, normal, radius, 1};
}
/// With half a diagonal across its base.
WaterPiece pile(vec3 base, vec3 tip, float half) {
  const vec3 axis = glm::normalize(tip - base);
  const vec3 hint = std::abs(axis.z) < 0.9f ? vec3{0, 0, 1} : vec3{1, 0, 0};
  return {WaterPiece::Kind::pyramid, base, tip, half * glm::normalize(glm::cross(axis, hint)), 0, 1};
}

/// Along -z; a pixel is 1 m wide, the picture's middle is the origin, 100 m away.
View plain_view(int width = 40, int height = 40) {
  return orthographic_view({0, 0, 100}, vec3{0.0f}, {0, 1, 0}, static_cast<float>(height), width, height);
}

Image<vec3> drawn(const View& view, const std::vector<WaterPiece>& pieces, const Surroundings& around,
                  const RainLook& look = {}, vec3 background = vec3{0.0f}, float depth = kInfinity) {
  Image<vec3> radiance(view.width, view.height, background);
  draw_rain(view, pieces, around, look, Image<float>(view.width, view.height, depth), radiance);
  return radiance;
}

/// sRGB's curve in steps of 8 bits, not rounded.
double eight_bit(double linear) {
  return 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

double sum_of(const Image<vec3>& picture) {
  double sum = 0;
  for (const vec3 radiance : picture) sum += radiance.x;
  return sum;
}

const Surroundings& white() {
  static const Surroundings around(without_ground(uniform_environment()), vec3{0.0f}, 16);
  return around;
}
const Scene& half_lit_scene() {
  static const Scene scene = without_ground(half_lit_environment());
  return scene;
}
const Surroundings& half_lit() {
  static const Surroundings around(half_lit_scene(), vec3{0.0f}, 32);
  return around;
}

/// A bit of everything, in front of a perspective eye at the origin that looks along -z.
std::vector<WaterPiece> shower(std::size_t count, float nearest = 1) {
  std::vector<WaterPiece> pieces;
  for (std::size_t i = 0; i < count; ++i) {
    Draws draws(7, i);
    const auto number = [&](double low, double high) { return static_cast<float>(draws.between(low, high)); };
    const float z = -nearest - number(0, 6);
    const vec3 from{number(-0.5, 0.5) * z, number(-0.4, 0.4) * z, z};
    const vec3 to = from + vec3{number(-0.1, 0.1), number(-0.3, 0.1), number(-0.1, 0.1)};
    const float radius = number(0.0005, 0.02);
    switch (i % 4) {
      case 0:
        pieces.push_back(ball(from, radius));
        break;
      case 1:
        pieces.push_back(streak(from, to, 0.3f * radius));
        break;
      case 2:
        pieces.push_back(pile(from, to, radius));
        break;
      default:
        pieces.push_back(disk(from, to - from, radius));
        break;
    }
    pieces.back().opacity = number(0.2, 1);
  }
  return pieces;
}

View eye_view(int width = 96, int height = 64) {
  return perspective_view(vec3{0.0f}, {0, 0, -1}, {0, 1, 0}, 0.8f, width, height);
}

// --- Coverage ----------------------------------------------------------------------------------------------------

TEST(DrawRain, BallsCoverTheirAreaWhereverTheyStandInAPixel) {
  const Surroundings& around = white();
  for (const float radius : {0.02f, 0.2f, 0.56f, 0.8f, 0.99f, 1.01f, 1.3f, 2.0f, 3.7f, 10.0f})
    for (int k = 0; k < 25; ++k) {
      const vec3 shift{0.2f * static_cast<float>(k % 5), 0.2f * static_cast<float>(k / 5), 0};
      const double area = kPi * radius * radius;
      EXPECT_NEAR(sum_of(drawn(plain_view(), {ball(shift, radius)}, around)), area, 0.035 * area) << radius << " " << k;
    }
}

TEST(DrawRain, StreaksSpreadTheAreaOfTheirDropOverTheirWay) {
  const Surroundings& around = white();
  for (const float radius : {0.05f, 0.3f, 0.7f})
    for (const float length : {0.3f, 2.0f, 15.0f})
      for (int k = 0; k < 12; ++k) {
        const float turn = 0.7f * static_cast<float>(k);
        const vec3 from{0.09f * static_cast<float>(k), 0.23f * static_cast<float>(k), 0};
        const vec3 to = from + length * vec3{std::cos(turn), std::sin(turn), 0};
        const double area = kPi * radius * radius;
        EXPECT_NEAR(sum_of(drawn(plain_view(), {streak(from, to, radius)}, around)), area, 0.03 * area)
            << radius << " " << length << " " << k;
      }
}

TEST(DrawRain, StreaksAreAsStrongAsAsked) {
  const std::vector<WaterPiece> pieces{streak({-6, 3, 0}, {5, -4, 0}, 0.4f), streak({-9, -8, 0}, {3, 9, 0}, 2.0f)};
  for (const WaterPiece& piece : pieces) {
    const double whole = sum_of(drawn(plain_view(), {piece}, white()));
    for (const float strength : {0.0f, 0.5f, 2.0f}) {
      RainLook look;
      look.streak_strength = strength;
      EXPECT_NEAR(sum_of(drawn(plain_view(), {piece}, white(), look)), strength * whole, 1e-3 * whole) << strength;
    }
  }
}

TEST(DrawRain, WideStreaksFadeOverTheirDropsWidthAtBothEnds) {
  // A drop of radius 4 goes from -10 to 10 along x: a point is covered for the share of the time that the drop is on
  // it.
  const Image<vec3> picture = drawn(plain_view(), {streak({-10, 0.5f, 0}, {10, 0.5f, 0}, 4)}, white());
  for (int x = 0; x < 40; ++x) {
    const double place = x + 0.5 - 20;
    const double covered = std::max(0.0, std::min(place + 4, 10.0) - std::max(place - 4, -10.0)) / 20;
    EXPECT_NEAR(picture(x, 19).x, covered, 0.01) << x;
  }
  const double area = kPi * 16;
  EXPECT_NEAR(sum_of(picture), area, 0.015 * area);
}

TEST(DrawRain, ThinPilesCoverTheirShadow) {
  const Surroundings& around = white();
  for (const float half : {0.05f, 0.4f, 1.0f})
    for (const float height : {2.0f, 9.0f})
      for (int k = 0; k < 8; ++k) {
        const float turn = 0.8f * static_cast<float>(k);
        const vec3 from{0.13f * static_cast<float>(k), 0.31f * static_cast<float>(k), 0};
        const vec3 to = from + height * vec3{std::cos(turn), std::sin(turn), 0};
        const double area = height * half;  // a triangle, one diagonal wide
        EXPECT_NEAR(sum_of(drawn(plain_view(), {pile(from, to, half)}, around)), 0.85 * area, 0.85 * 0.04 * area)
            << half << " " << height << " " << k;
      }
}

TEST(DrawRain, WidePilesCoverTheirFacesButForTheirFeet) {
  // At the height s, of one, is 2 (1 - s) ds of the area; feet come out of the picture by smoothstep(s / 0.15).
  double left = 0;
  for (double s = 0.5e-4; s < 1; s += 1e-4) {
    const double u = std::min(s / 0.15, 1.0);
    left += 2 * (1 - s) * u * u * (3 - 2 * u) * 1e-4;
  }
  const Surroundings& around = white();
  const View view = plain_view(60, 60);
  // Seen along a diagonal: a triangle of the width of the other.
  WaterPiece piece = pile({0.3f, -14, 0}, {0.3f, 14, 0}, 8);
  piece.across = {8, 0, 0};
  const double side = 0.85 * 0.5 * 28 * 16 * left;
  EXPECT_NEAR(sum_of(drawn(view, {piece}, around)), side, 0.02 * side);
  // From above: the square of the base, once.
  const double above = 0.85 * 200 * left;
  EXPECT_NEAR(sum_of(drawn(view, {pile({0.3f, 0, 0}, {0.3f, 0, 6}, 10)}, around)), above, 0.02 * above);
  // The base stands in the water.
  EXPECT_NEAR(sum_of(drawn(view, {pile({0.3f, 0, 0}, {0.3f, 0, -6}, 10)}, around)), 0, 0.01);
}

TEST(DrawRain, PerspectiveBallsCoverTheirSolidAngle) {
  const Surroundings& around = white();
  const View view = eye_view(160, 120);
  for (const float radius : {0.002f, 0.012f})
    for (const vec3 centre : {vec3{0.01f, 0.02f, -2}, vec3{0.7f, 0.4f, -2}}) {
      const Image<vec3> picture = drawn(view, {ball(centre, radius)}, around);
      double covered = 0;
      for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
          const float cosine =
              glm::dot(view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}).direction, view.forward);
          covered += picture(x, y).x * std::pow(view.pixel_size(1), 2) * std::pow(cosine, 3);
        }
      const double sine = radius / glm::length(centre);
      const double expected = 2 * kPi * (1 - std::sqrt(1 - sine * sine));
      EXPECT_NEAR(covered, expected, 0.035 * expected) << radius << " " << centre.x;
    }
}

TEST(DrawRain, PerspectiveBallsEndWhereTheirRaysDo) {
  const View view = eye_view(160, 120);
  const vec3 centre{0.7f, 0.4f, -2};
  const double radius = std::asin(0.3 / glm::length(centre)), pixel = view.pixel_size(1);
  const Image<vec3> picture = drawn(view, {ball(centre, 0.3f)}, white(), {}, vec3{7.0f});
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const vec3 direction = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}).direction;
      const double angle = std::acos(std::min(1.0f, glm::dot(direction, glm::normalize(centre))));
      if (angle < radius - pixel) {
        EXPECT_LT(picture(x, y).x, 6.9f) << x << " " << y;
      }
      if (angle > radius + pixel) {
        EXPECT_EQ(picture(x, y).x, 7.0f) << x << " " << y;
      }
    }
}

// --- Light -------------------------------------------------------------------------------------------------------

TEST(DrawRain, ClearDropsTakeAndAddNothingInEvenLight) {
  const Surroundings& around = white();
  for (const bool detail : {true, false}) {
    RainLook look;
    look.level_of_detail = detail;
    const Image<vec3> picture = drawn(eye_view(), shower(400, 0.5f), around, look, vec3{1.0f}, 20.0f);
    for (const vec3 radiance : picture) ASSERT_NEAR(radiance.x, 1, 0.01);
  }
}

TEST(DrawRain, DropsShowTheWorldUpsideDown) {
  const Image<vec3> picture = drawn(plain_view(), {ball({0, 0, 0}, 12)}, half_lit());
  EXPECT_GT(picture(20, 28).x, 0.9f);  // the lower part shows the white sky
  EXPECT_LT(picture(20, 12).x, 0.15f);
}

TEST(DrawRain, BallsMirrorTheSkyByFresnel) {
  // In the upper half what goes through shows the black below; what is mirrored shows the white above.
  const Image<vec3> picture = drawn(plain_view(), {ball({0.5f, 0.5f, 0}, 15)}, half_lit());
  for (int k = 9; k <= 13; ++k) {
    EXPECT_NEAR(picture(20, 19 - k).x, reflectance(std::asin(k / 15.0), 1.333), 0.008) << k;
  }
}

TEST(DrawRain, BallsBendLightAsTwoInterfacesDo) {
  const double ior = 1.333;
  const BallOptics optics(static_cast<float>(ior));
  for (double i = 0.05; i < 1.5; i += 0.1) {
    const double turn = 2 * (i - std::asin(std::sin(i) / ior));
    const BallOptics::Bend bend = optics.at(static_cast<float>(std::cos(i)));
    EXPECT_NEAR(bend.sine, std::sin(turn), 1e-5) << i;
    EXPECT_NEAR(bend.cosine, std::cos(turn), 1e-5) << i;
    EXPECT_NEAR(bend.mirrored, reflectance(i, ior), 1e-5) << i;
  }
}

TEST(DrawRain, ALampsLightInABallGoesSomewhere) {
  const BallOptics optics(1.333f);
  double sum = 0;
  constexpr int kSteps = 20000;
  for (int k = 0; k < kSteps; ++k)
    sum += 2 * kPi * optics.phase(static_cast<float>((2 * k + 1.0) / kSteps - 1)) * 2 / kSteps;
  EXPECT_NEAR(sum, 1, 0.01);
}

TEST(DrawRain, SmallBallsShowTheMeanOfLargeOnes) {
  const Surroundings& around = half_lit();
  for (const vec3 towards : {vec3{0, 0, -1}, vec3{0, -0.7f, -1}}) {
    const View view = orthographic_view(-100.0f * glm::normalize(towards), vec3{0.0f}, {0, 1, 0}, 60, 60, 60);
    const double large = sum_of(drawn(view, {ball(vec3{0.0f}, 25)}, around)) / (kPi * 625);
    const double small = sum_of(drawn(view, {ball(vec3{0.0f}, 0.4f)}, around)) / (kPi * 0.16);
    EXPECT_NEAR(small, large, 0.03);
  }
}

TEST(DrawRain, HazeDimsByItsExtinction) {
  RainLook look;
  look.haze = 0.1f;
  look.haze_radiance = {0, 1, 0};
  const Image<vec3> picture = drawn(plain_view(), {}, white(), look, {1, 0, 0.5f}, 7.0f);
  const double left = std::exp(-0.7);
  EXPECT_NEAR(picture(3, 3).x, left, 1e-5);
  EXPECT_NEAR(picture(3, 3).y, 1 - left, 1e-5);
  EXPECT_NEAR(picture(3, 3).z, 0.5 * left, 1e-5);
  EXPECT_EQ(drawn(plain_view(), {}, white(), look, {1, 0, 0.5f})(3, 3), (vec3{1, 0, 0.5f}));  // the sky stays
}

// --- Order -------------------------------------------------------------------------------------------------------

TEST(DrawRain, NothingIsSeenBehindAWall) {
  const View view = eye_view();
  for (const bool detail : {true, false}) {
    RainLook look;
    look.level_of_detail = detail;
    for (const vec3 radiance : drawn(view, shower(200, 2), white(), look, vec3{0.25f}, 1.0f))
      ASSERT_EQ(radiance, vec3{0.25f});
  }
}

TEST(DrawRain, BallsSinkIntoTheGroundGradually) {
  const View view = plain_view();
  const Surroundings& around = white();
  double before = -1;
  for (float z = -2; z <= 2; z += 0.1f) {
    const double sum = sum_of(drawn(view, {ball({0, 0, z}, 1)}, around, {}, vec3{0.0f}, 100.0f));
    if (before >= 0) {
      EXPECT_GE(sum, before - 1e-6);
      EXPECT_LT(sum - before, 0.2);
    }
    before = sum;
  }
  EXPECT_NEAR(before, kPi, 0.1);
}

TEST(DrawRain, GrazingGroundDoesNotHideWhatStandsOnIt) {
  // Ground 1 m under the eye: at 20 m a row of pixels spans more than a metre of it.
  const View view = eye_view(160, 120);
  const Surroundings& around = white();
  Image<float> depth(view.width, view.height, kInfinity);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const Ray ray = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      if (ray.direction.y < -1e-4f) depth(x, y) = -1.0f / ray.direction.y;
    }
  for (float z = -20; z > -22; z -= 0.23f) {
    const WaterPiece drop = ball({0.1f, -0.99f, z}, 0.01f);
    Image<vec3> hidden(view.width, view.height, vec3{0.0f});
    draw_rain(view, std::vector{drop}, around, {}, depth, hidden);
    const double whole = sum_of(drawn(view, {drop}, around));
    EXPECT_NEAR(sum_of(hidden), whole, 0.05 * whole) << z;
  }
}

TEST(DrawRain, NearPiecesCoverFarOnes) {
  const View view = plain_view();
  const Surroundings& around = half_lit();
  const WaterPiece near = ball({0, 0, 5}, 8), far = ball({0, 3, -5}, 2);
  const Image<vec3> alone = drawn(view, {near}, around);
  EXPECT_EQ(drawn(view, {near, far}, around)(20, 17), alone(20, 17));
  EXPECT_EQ(drawn(view, {far, near}, around)(20, 17), alone(20, 17));
  EXPECT_NE(drawn(view, {near, ball({0, 3, 14}, 2)}, around)(20, 18), alone(20, 18));
}

TEST(DrawRain, DoesNotDependOnTheOrderOfPiecesAtDifferentDepths) {
  std::vector<WaterPiece> pieces = shower(300);
  const Surroundings& around = half_lit();
  const Image<vec3> picture = drawn(eye_view(), pieces, around, {}, vec3{0.3f}, 5.0f);
  std::reverse(pieces.begin(), pieces.end());
  const Image<vec3> turned = drawn(eye_view(), pieces, around, {}, vec3{0.3f}, 5.0f);
  EXPECT_TRUE(std::equal(picture.begin(), picture.end(), turned.begin()));
}

TEST(DrawRain, GivesTheSameBitsOnAnyNumberOfThreads) {
  const std::vector<WaterPiece> pieces = shower(3000, 0.3f);
  const auto picture = [&](int threads) {
    const ThreadLimit limit(threads);
    return drawn(eye_view(200, 150), pieces, Surroundings(half_lit_scene(), vec3{0.0f}, 16), {}, vec3{0.3f}, 5.0f);
  };
  const Image<vec3> one = picture(1);
  for (const int threads : {2, 5}) {
    const Image<vec3> many = picture(threads);
    EXPECT_TRUE(std::equal(one.begin(), one.end(), many.begin())) << threads;
  }
}

// --- Detail ------------------------------------------------------------------------------------------------------

TEST(DrawRain, SmallPiecesLookAsIfDrawnWhole) {
  const Surroundings& around = half_lit();
  RainLook whole;
  whole.level_of_detail = false;
  const View view = plain_view(9, 9);
  const float turn = 0.6f;
  const vec3 lean{std::cos(turn), std::sin(turn), 0.2f};
  const std::vector<WaterPiece> pieces{ball({0, 0, 0}, 0.3f), ball({0, 0, 0}, 0.5f),
                                       pile({0, 0, 0}, 0.7f * lean, 0.12f), disk({0, 0, 0}, {0, 1, 0.3f}, 0.45f)};
  for (const WaterPiece& piece : pieces) {
    const Image<vec3> full = drawn(view, {piece}, around, whole, vec3{0.2f}),
                      part = drawn(view, {piece}, around, {}, vec3{0.2f});
    // The light of the pixels together, as a step of sRGB at this brightness is about 0.004 / 1.3.
    EXPECT_NEAR(sum_of(full), sum_of(part), 2 * 0.0035) << static_cast<int>(piece.kind) << " " << piece.radius;
  }
}

TEST(DrawRain, MergedSplashesCannotBeToldFromWholeOnes) {
  const vec3 dark{0.1f};
  RainLook whole;
  whole.level_of_detail = false;
  double most = 0;
  for (const Wetness wetness : {Wetness::wet, Wetness::puddle_5mm, Wetness::puddle_10mm})
    for (std::uint64_t id = 0; id < 8; ++id) {
      Splashes splashes{SplashOptions{}};
      Impact impact;
      impact.id = id;
      impact.velocity = {0, -6.5f, 0};
      impact.wetness = wetness;
      splashes.add(impact);
      for (const double time : {0.005, 0.02, 0.05}) {
        std::vector<WaterPiece> all, merged;
        splashes.pieces(time, nullptr, all);
        if (all.size() < 2) continue;
        // The finest picture in which it is merged.
        View view;
        for (float pixel = 0.005f; merged.size() != 1; pixel *= 1.1f) {
          ASSERT_LT(pixel, 1);
          view = orthographic_view({0.3f * pixel, 1, 3}, {0.3f * pixel, 0, 0}, {0, 1, 0}, 9 * pixel, 9, 9);
          merged.clear();
          splashes.pieces(time, &view, merged);
        }
        const Image<vec3> full = drawn(view, all, half_lit(), whole, dark);
        const Image<vec3> part = drawn(view, merged, half_lit(), {}, dark);
        const auto step = [](vec3 radiance) { return eight_bit(radiance.x); };
        for (std::size_t i = 0; i < full.size(); ++i) {
          ASSERT_NEAR(step(full[i]), step(part[i]), 5) << static_cast<int>(wetness) << " " << id << " " << time;
          most = std::max(most, std::abs(step(full[i]) - step(dark)));
        }
      }
    }
  EXPECT_GT(most, 2);  // there was something to see
}

// --- Degenerate input --------------------------------------------------------------------------------------------

TEST(DrawRain, LeavesOutWhatIsNotThere) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const vec3 at{0, 0, -2}, up{0, 1, 0};
  std::vector<WaterPiece> pieces{ball(at, 0),
                                 ball(at, -1),
                                 ball(at, nan),
                                 ball({nan, 0, -2}, 0.1f),
                                 ball({0, 0, 2}, 0.1f),
                                 ball(vec3{0.0f}, 0.1f),
                                 ball({0, 0, -0.1f}, 0.2f),
                                 streak(at, {nan, 0, 0}, 0.01f),
                                 streak(at, at, 0),
                                 streak({0, 0, 1}, {0, 1, 2}, 0.01f),
                                 pile(at, at + up, 0),
                                 disk(at, vec3{0.0f}, 0.1f),
                                 disk(at, up, 0),
                                 disk(at, {nan, 0, 0}, 0.1f),
                                 disk(at, {0, 1, 0}, 0.1f)};
  WaterPiece flat = pile(at, at + up, 0.1f);
  flat.to = flat.from;
  pieces.push_back(flat);
  flat = pile(at, at + up, 0.1f);
  flat.across = {0, 0.1f, 0};
  flat.opacity = 0;
  pieces.push_back(flat);
  for (const bool detail : {true, false}) {
    RainLook look;
    look.level_of_detail = detail;
    for (const WaterPiece& piece : pieces)
      for (const vec3 radiance : drawn(eye_view(), {piece}, white(), look, vec3{0.25f}, 5.0f))
        ASSERT_EQ(radiance, vec3{0.25f}) << static_cast<int>(piece.kind);
  }
}

TEST(DrawRain, StaysFiniteWithStrangePieces) {
  const vec3 at{0, 0, -2}, up{0, 1, 0};
  WaterPiece leaning = pile(at, at + up, 0.1f);
  leaning.across = {0, 0.1f, 0};  // along its axis
  const std::vector<WaterPiece> pieces{streak(at, at, 0.05f),
                                       streak({0, 0, 5}, {0, 0.3f, -5}, 0.02f),
                                       streak(at, {0, 3e30f, -2}, 0.01f),
                                       ball({0, 0, -1}, 0.9f),
                                       ball({0, 0, -1e20f}, 1e19f),
                                       ball(at, 1e-30f),
                                       pile(at, {0, 1e20f, -2}, 0.1f),
                                       leaning,
                                       pile({0, -0.1f, -0.3f}, {0, 0.2f, -0.2f}, 0.1f),
                                       disk({0, 0, -1}, {0, 1, 0}, 0.9f),
                                       disk(at, up, 1e-20f)};
  for (const bool detail : {true, false}) {
    RainLook look;
    look.level_of_detail = detail;
    for (const View& view : {eye_view(), plain_view()})
      for (const WaterPiece& piece : pieces)
        for (const float depth : {0.0f, 1.9f, kInfinity})
          for (const vec3 radiance : drawn(view, {piece}, half_lit(), look, vec3{0.25f}, depth)) {
            ASSERT_TRUE(std::isfinite(radiance.x)) << static_cast<int>(piece.kind);
            ASSERT_GE(radiance.x, 0);
          }
  }
}

TEST(DrawRain, RefusesWhatDoesNotFit) {
  Image<vec3> radiance(8, 8);
  EXPECT_THROW(draw_rain(plain_view(9, 8), {}, white(), {}, Image<float>(9, 8), radiance), Error);
  EXPECT_THROW(draw_rain(plain_view(8, 8), {}, white(), {}, Image<float>(9, 8), radiance), Error);
  Image<vec3> faces(48, 8);
  EXPECT_THROW(draw_rain(cube_view(vec3{0.0f}, 8), {}, white(), {}, Image<float>(48, 8), faces), Error);
  RainLook look;
  look.streak_strength = -1;
  EXPECT_THROW(draw_rain(plain_view(8, 8), {}, white(), look, Image<float>(8, 8), radiance), Error);
  look = {};
  look.haze = -1;
  EXPECT_THROW(draw_rain(plain_view(8, 8), {}, white(), look, Image<float>(8, 8), radiance), Error);
}

}  // namespace
}  // namespace meniscus::tests
