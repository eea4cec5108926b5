#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>

#include "sim/splash_cases.h"
#include "sim/splash_view.h"

namespace meniscus {
namespace {

using Kind = WaterPiece::Kind;

Splashes all(const std::vector<Impact>& impacts) {
  Splashes splashes({});
  for (const Impact& impact : impacts) splashes.add(impact);
  return splashes;
}
std::vector<WaterPiece> pieces(const Splashes& splashes, double time, const View* view = nullptr) {
  std::vector<WaterPiece> pieces;
  splashes.pieces(time, view, pieces);
  return pieces;
}
bool same(const WaterPiece& a, const WaterPiece& b) {
  return a.kind == b.kind && a.from == b.from && a.to == b.to && a.across == b.across && a.radius == b.radius &&
         a.opacity == b.opacity;
}
bool same(const std::vector<WaterPiece>& a, const std::vector<WaterPiece>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) { return same(p, q); });
}
View street_view(int width, int height, float distance = 4) {
  return perspective_view({0, 1.7f, distance}, {0, 0, 0}, {0, 1, 0}, 0.7f, width, height);
}

TEST(SplashPieces, AreThoseOfEachImpactWhateverElseIsThereAndInWhateverOrder) {
  std::vector<Impact> impacts = all_kinds_of_impacts(600, 2);
  const std::vector<WaterPiece> together = pieces(all(impacts), -0.4);
  std::vector<WaterPiece> one_by_one;
  for (const Impact& impact : impacts) {
    const std::vector<WaterPiece> own = pieces(all({impact}), -0.4);
    one_by_one.insert(one_by_one.end(), own.begin(), own.end());
  }
  EXPECT_GT(together.size(), 1000u);
  EXPECT_TRUE(same(together, one_by_one));
  std::reverse(impacts.begin(), impacts.end());
  EXPECT_EQ(pieces(all(impacts), -0.4).size(), together.size());
}

TEST(SplashPieces, HaveTheSameBitsOnAnyNumberOfThreads) {
  const Splashes splashes = all(all_kinds_of_impacts(5000, 10));
  const View view = street_view(320, 240);
  std::vector<WaterPiece> whole, seen;
  {
    const ThreadLimit one(1);
    whole = pieces(splashes, -0.3);
    seen = pieces(splashes, -0.3, &view);
  }
  for (const int threads : {2, 5}) {
    const ThreadLimit limit(threads);
    EXPECT_TRUE(same(pieces(splashes, -0.3), whole));
    EXPECT_TRUE(same(pieces(splashes, -0.3, &view), seen));
  }
  EXPECT_LT(seen.size(), whole.size());
}

TEST(SplashPieces, AreAppendedAndDoNotDependOnWhatWasForgotten) {
  const std::vector<Impact> impacts = all_kinds_of_impacts(4000, 10);
  Splashes splashes = all(impacts);
  const std::vector<WaterPiece> before = pieces(splashes, 0.05);
  const std::size_t droplets = splashes.droplets();
  for (double t = -0.5; t <= 0.05; t += 0.01) splashes.retire(t);
  EXPECT_LT(splashes.droplets(), droplets);
  EXPECT_TRUE(same(pieces(splashes, 0.05), before));
  std::vector<WaterPiece> more(3);
  splashes.pieces(0.05, nullptr, more);
  EXPECT_EQ(more.size(), before.size() + 3);
  splashes.retire(10);
  EXPECT_EQ(splashes.size(), 0u);
  EXPECT_EQ(splashes.droplets(), 0u);
  EXPECT_TRUE(pieces(splashes, 0.05).empty());
}

/// Whether any of some hundred points of the piece is in the picture.
bool is_in(const View& view, const WaterPiece& p) {
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; j < 24; ++j) {
      vec3 point;
      if (p.kind == Kind::pyramid) {
        const float part = 0.25f * static_cast<float>(i), turn = static_cast<float>(j) * 0.2617994f;
        const vec3 axis = p.to - p.from, b = glm::cross(axis / std::max(glm::length(axis), 1e-9f), p.across);
        point = p.from + axis * part + (1 - part) * (std::cos(turn) * p.across + std::sin(turn) * b) * 0.7f;
      } else {
        const float z = 0.5f * static_cast<float>(i) - 1, turn = static_cast<float>(j) * 0.2617994f;
        const float r = std::sqrt(std::max(0.0f, 1 - z * z));
        point = p.from + p.radius * vec3(r * std::cos(turn), z, r * std::sin(turn));
        if (p.kind == Kind::disk) point = p.from;
      }
      const vec3 at = view.project(point);
      const auto width = static_cast<float>(view.width), height = static_cast<float>(view.height);
      if (at.z > 0 && at.x >= 0 && at.x <= width && at.y >= 0 && at.y <= height) return true;
    }
  return false;
}

TEST(SplashPieces, LeaveOutNothingThatIsSeen) {
  const Splashes splashes = all(all_kinds_of_impacts(3000, 6));
  // So many pixels that nothing is smaller than one.
  const View views[] = {street_view(40000, 30000, 2), street_view(30000, 60000, 0.5f),
                        orthographic_view({0, 3, 0}, {0.1f, 0, 0}, {0, 0, 1}, 2, 60000, 40000)};
  const std::vector<WaterPiece> whole = pieces(splashes, -0.3);
  for (const View& view : views) {
    const std::vector<WaterPiece> kept = pieces(splashes, -0.3, &view);
    EXPECT_LT(kept.size(), whole.size());
    std::size_t next = 0, seen = 0;  // kept pieces are in the same order
    for (const WaterPiece& piece : whole) {
      const bool is_kept = next < kept.size() && same(kept[next], piece);
      next += is_kept;
      if (is_kept || !is_in(view, piece)) continue;
      ++seen;
    }
    EXPECT_EQ(next, kept.size());
    EXPECT_EQ(seen, 0u);
  }
  const View cube = cube_view({0, 1, 0}, 20000);
  EXPECT_EQ(pieces(splashes, -0.3, &cube).size(), whole.size());
}

TEST(MayShow, IsTrueForEveryBallOfWhichAPointIsInThePictureAndFalseForMostOthers) {
  Draws draws(3);
  const auto any = [&](double low, double high) { return static_cast<float>(draws.between(low, high)); };
  const View views[] = {perspective_view({0, 0, 0}, {0.2f, -0.1f, -1}, {0, 1, 0}, 1.6f, 800, 500),
                        orthographic_view({0, 0, 0}, {0.2f, -0.1f, -1}, {0, 1, 0}, 2, 800, 500)};
  for (const View& view : views) {
    int hidden = 0, kept_hidden = 0;
    for (int i = 0; i < 20000; ++i) {
      const vec3 centre(any(-6, 6), any(-6, 6), any(-6, 2));
      const float radius = any(0.1, 1.5);
      bool seen = false;
      for (int k = 0; k < 60 && !seen; ++k) {
        const vec3 point = centre + radius * glm::normalize(vec3(any(-1, 1), any(-1, 1), any(-1, 1)));
        const vec3 at = view.project(point);
        seen = at.z > 0 && at.x >= 0 && at.x <= 800 && at.y >= 0 && at.y <= 500;
      }
      const bool may = may_show(view, centre, radius);
      if (seen) {
        ASSERT_TRUE(may) << i;
      }
      hidden += !seen;
      kept_hidden += !seen && may;
    }
    EXPECT_LT(kept_hidden, 0.1 * hidden);
  }
}

/// Area of the outline of points in the plane: around the hull by the leftmost turns.
double hull_area(std::vector<glm::dvec2> points) {
  std::sort(points.begin(), points.end(), [](auto a, auto b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  const auto cross = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
  double area = 0;
  for (const bool lower : {true, false}) {
    std::vector<glm::dvec2> chain;
    for (const glm::dvec2 p : points) {
      while (chain.size() > 1) {
        const double turn = cross(chain.back() - chain[chain.size() - 2], p - chain.back());
        if (lower ? turn > 0 : turn < 0) break;
        chain.pop_back();
      }
      chain.push_back(p);
    }
    for (std::size_t i = 1; i < chain.size(); ++i) area += (lower ? 0.5 : -0.5) * cross(chain[i - 1], chain[i]);
  }
  return area;
}

TEST(CoveredArea, IsThatOfThePiecesOutline) {
  const Splashes splashes = all(all_kinds_of_impacts(100, 1));
  const vec3 direction = glm::normalize(vec3(0.3f, -0.5f, -1));
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(direction), glm::dvec3(0, 1, 0)));
  const glm::dvec3 up = glm::cross(right, glm::dvec3(direction));
  int pyramids = 0;
  for (const WaterPiece& p : pieces(splashes, -0.3)) {
    if (p.kind != Kind::pyramid) continue;
    const glm::dvec3 axis(p.to - p.from), a(p.across), b = glm::cross(glm::normalize(axis), a);
    std::vector<glm::dvec2> outline;
    for (const glm::dvec3& corner : {axis, a, b, -a, -b})
      outline.push_back({glm::dot(corner, right), glm::dot(corner, up)});
    const double expected = hull_area(outline);
    EXPECT_NEAR(covered_area(p, direction), expected, 1e-5 * expected + 1e-13);
    ++pyramids;
  }
  EXPECT_GT(pyramids, 50);
  WaterPiece ball;
  ball.radius = 2;
  ball.opacity = 0.25f;
  EXPECT_NEAR(covered_area(ball, direction), 3.14159265, 1e-6);
  ball.kind = Kind::disk;
  ball.across = {0, 1, 0};
  EXPECT_NEAR(covered_area(ball, direction), 3.14159265 * std::abs(direction.y), 1e-6);
}

TEST(SplashPieces, OfSplashesBelowAPixelBecomeOneSphereThatCoversAsMuch) {
  const std::vector<Impact> impacts = all_kinds_of_impacts(500, 3);
  const View view = street_view(64, 48, 900);
  std::size_t merged_splashes = 0;
  for (const Impact& impact : impacts) {
    const Splashes one = all({impact});
    const std::vector<WaterPiece> whole = pieces(one, -0.4), seen = pieces(one, -0.4, &view);
    if (whole.size() < 2) continue;
    ASSERT_EQ(seen.size(), 1u);
    ASSERT_EQ(seen[0].kind, Kind::sphere);
    double area = 0;
    for (const WaterPiece& p : whole) area += covered_area(p, glm::normalize(p.from - view.eye));
    EXPECT_NEAR(covered_area(seen[0], view.forward) / area, 1, 1e-3);
    EXPECT_LT(glm::distance(seen[0].from, impact.point), view.pixel_size(890));
    ++merged_splashes;
  }
  EXPECT_GT(merged_splashes, 40u);
  // Near, they are whole.
  const View near = street_view(640, 480, 4);
  for (const Impact& impact : impacts) {
    const Splashes one = all({impact});
    const std::vector<WaterPiece> seen = pieces(one, -0.4, &near);
    if (seen.size() > 1) {
      EXPECT_TRUE(same(seen, pieces(one, -0.4)));
    }
  }
}

TEST(Landings, BringAllWaterDownInOrderOfTimeHoweverTheyAreAskedFor) {
  const std::vector<Impact> impacts = all_kinds_of_impacts(2000, 3);
  Splashes splashes({});
  double flying = 0;
  for (const Impact& impact : impacts) flying += splashes.add(impact);
  const std::vector<Landing> whole = splashes.landings(-2, 3);
  double landed = 0, last = -2;
  for (const Landing& landing : whole) {
    landed += landing.volume;
    EXPECT_LE(last, landing.time);
    last = landing.time;
    EXPECT_GE(landing.speed, 0);
    EXPECT_NEAR(landing.volume / (4 * 3.14159265358979 / 3 * std::pow(static_cast<double>(landing.radius), 3)), 1,
                1e-9);
  }
  EXPECT_GT(flying, 0);
  EXPECT_NEAR(landed / flying, 1, 1e-12);

  std::size_t next = 0;
  for (int i = 0; i < 500; ++i) {  // with what is over forgotten meanwhile
    const double from = -2 + 0.01 * i, until = -2 + 0.01 * (i + 1);
    for (const Landing& landing : splashes.landings(from, until)) {
      ASSERT_LT(next, whole.size());
      EXPECT_EQ(landing.time, whole[next].time);
      EXPECT_EQ(landing.point, whole[next].point);
      ++next;
    }
    splashes.retire(until);
  }
  EXPECT_EQ(next, whole.size());
  EXPECT_EQ(splashes.size(), 0u);
}

TEST(Landings, AreOnLevelGroundAtItsHeight) {
  for (const Impact& impact : all_kinds_of_impacts(500, 3, true)) {
    Splashes one({});
    one.add(impact);
    for (const Landing& landing : one.landings(-2, 3)) {
      EXPECT_NEAR(landing.point.y, impact.point.y, 1e-5f);
      EXPECT_GT(landing.time, impact.time);
      EXPECT_LE(landing.time, impact.time + SplashOptions{}.most_time);
    }
  }
}

TEST(Landings, OfACrownConeAreOneDropWhereItWentUp) {
  Impact impact = impact_on(GroundMaterial::concrete, Wetness::puddle_10mm);
  impact.point = {1, 2, 3};
  impact.wind = {9, 0, 4};
  Splashes one({});
  one.add(impact);
  const std::vector<Landing> landings = one.landings(0, 2);
  ASSERT_EQ(landings.size(), 1u);
  EXPECT_LT(glm::distance(landings[0].point, impact.point), 1e-5f);
  const MadeSplash m = made(impact);
  EXPECT_LT(landings[0].speed, m.droplets[0].velocity.y);  // the air has taken its part
  EXPECT_GT(landings[0].speed, 0.9f * m.droplets[0].velocity.y);
}

TEST(Landings, FromAWallAreHandedBackWhenTheTimeIsUp) {
  Impact impact = impact_on(GroundMaterial::asphalt, Wetness::puddle_3mm);
  impact.normal = {1, 0, 0};
  Splashes one({});
  const double flying = one.add(impact);
  double landed = 0;
  for (const Landing& landing : one.landings(0, 2)) {
    EXPECT_LT(landing.point.y, -3);
    landed += landing.volume;
  }
  EXPECT_NEAR(landed / flying, 1, 1e-12);
}

TEST(Splashes, RefuseWhatIsNoImpactAndNoOption) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const Impact good = impact_on(GroundMaterial::asphalt, Wetness::wet);
  Splashes splashes({});
  for (const float bad : {nan, infinity, -infinity}) {
    Impact i = good;
    EXPECT_THROW((i.point.x = bad, splashes.add(i)), Error);
    i = good;
    EXPECT_THROW((i.velocity.y = bad, splashes.add(i)), Error);
    i = good;
    EXPECT_THROW((i.normal.z = bad, splashes.add(i)), Error);
    i = good;
    EXPECT_THROW((i.wind.x = bad, splashes.add(i)), Error);
    i = good;
    EXPECT_THROW((i.diameter = bad, splashes.add(i)), Error);
    i = good;
    EXPECT_THROW((i.time = static_cast<double>(bad), splashes.add(i)), Error);
    SplashOptions o;
    EXPECT_THROW((o.most_time = bad, Splashes(o)), Error);
    o = {};
    EXPECT_THROW((o.gravity.x = bad, Splashes(o)), Error);
    o = {};
    EXPECT_THROW((o.growth_length = bad, Splashes(o)), Error);
  }
  for (const float bad : {0.0f, -1.0f, 5.0f}) {
    Impact i = good;
    EXPECT_THROW((i.diameter = bad, splashes.add(i)), Error);
  }
  Impact no_normal = good;
  EXPECT_THROW((no_normal.normal = vec3(0.0f), splashes.add(no_normal)), Error);
  SplashOptions o;
  EXPECT_THROW((o.growth_time = 0, Splashes(o)), Error);
  o = {};
  EXPECT_THROW((o.up = vec3(0, 2, 0), Splashes(o)), Error);
  EXPECT_EQ(splashes.size(), 0u);
}

TEST(Splashes, StandOddConditions) {
  SplashOptions options;
  options.most_time = 0.1f;
  for (const vec3 gravity : {vec3(0.0f), vec3(0, 9, 0), vec3(0, -900, 0)}) {
    options.gravity = gravity;
    Splashes splashes(options);
    double flying = 0;
    for (Impact impact : all_kinds_of_impacts(300, 1)) {
      if (impact.id % 2) impact.velocity = vec3(0.0f);
      if (impact.id % 5 == 0) impact.diameter = impact.id % 2 ? 1e-6f : 1.0f;
      if (impact.id % 7 == 0) impact.wind = {1000, 0, 0};
      flying += splashes.add(impact);
    }
    double landed = 0;
    for (const Landing& landing : splashes.landings(-2, 2)) landed += landing.volume;
    EXPECT_NEAR(landed / flying, 1, 1e-12);
    for (double t = -1; t < 0.2; t += 0.01)
      for (const WaterPiece& p : pieces(splashes, t))
        ASSERT_TRUE(
            std::isfinite(p.from.x + p.from.y + p.to.x + p.to.y + glm::length(p.across) + p.radius + p.opacity));
    splashes.retire(0.11);
    EXPECT_EQ(splashes.size(), 0u);
  }
}

}  // namespace
}  // namespace meniscus
