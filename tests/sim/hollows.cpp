/// Water at rest in hollows, against the pouring of many small drops and against closed forms.
#include "sim/hollows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace meniscus {
namespace {

/// A terrain with what lies on it.
struct Terrain {
  int width, height;
  std::vector<double> ground, room, water;

  Terrain(int w, int h, std::vector<double> heights)
      : width(w), height(h), ground(std::move(heights)), room(ground.size(), 0.0), water(ground.size(), 0.0) {}
  double settle() { return settle_in_hollows(width, height, ground, room, water); }
  double total() const { return std::accumulate(water.begin(), water.end(), 0.0); }
};

/// Drops one by one: each runs down over ground and water, is spread over the lake that it comes to, and runs on from
/// the lake's lowest shore when the lake is full. Slow, and as different from the tree of hollows as can be.
class Pouring {
 public:
  explicit Pouring(const Terrain& terrain) : t_(terrain), depth_(terrain.ground.size(), 0.0) {}

  void drop(std::size_t cell, double volume) {
    std::size_t at = cell;
    for (int runs = 0; runs < 100'000; ++runs) {
      // Down the lowest neighbour, over the border if there is none.
      const std::vector<std::size_t> near = neighbours(at);
      if (depth_[at] == 0) {
        std::size_t lowest = at;
        for (std::size_t n : near)
          if (t_.ground[n] < t_.ground[lowest]) lowest = n;
        if (lowest != at) {
          at = lowest;
          continue;
        }
      }
      // The lake around: all cells of this level that water connects. It spills to the lowest of its lower neighbours.
      std::vector<std::size_t> lake{at};
      std::vector<char> seen(depth_.size(), 0);
      seen[at] = 1;
      double shore = 1e300;
      std::size_t exit = at;
      bool at_border = false;
      for (std::size_t k = 0; k < lake.size(); ++k) {
        const std::vector<std::size_t> around = neighbours(lake[k]);
        at_border |= around.size() < 4;
        for (std::size_t n : around) {
          if (seen[n]) continue;
          seen[n] = 1;
          if (level(n) < level(at) - kTiny) {
            if (exit == at || t_.ground[n] < t_.ground[exit]) exit = n;
          } else if (level(n) <= level(at) + kTiny) {
            lake.push_back(n);
          } else {
            shore = std::min(shore, level(n));
          }
        }
      }
      if (exit != at) {
        at = exit;
        continue;
      }
      if (at_border) {
        drained += volume;
        return;
      }
      const double raised = std::min(volume, (shore - level(at)) * static_cast<double>(lake.size()));
      for (std::size_t c : lake) depth_[c] += raised / static_cast<double>(lake.size());
      volume -= raised;
      if (volume <= 0) return;
    }
    FAIL() << "a drop does not come to rest";
  }

  const std::vector<double>& depths() const { return depth_; }
  double drained = 0;

 private:
  static constexpr double kTiny = 1e-12;
  double level(std::size_t c) const { return t_.ground[c] + depth_[c]; }
  std::vector<std::size_t> neighbours(std::size_t c) const {
    const auto w = static_cast<std::size_t>(t_.width), h = static_cast<std::size_t>(t_.height);
    std::vector<std::size_t> near;
    if (c / w > 0) near.push_back(c - w);
    if (c % w > 0) near.push_back(c - 1);
    if (c % w + 1 < w) near.push_back(c + 1);
    if (c / w + 1 < h) near.push_back(c + w);
    return near;
  }
  const Terrain& t_;
  std::vector<double> depth_;
};

TEST(Hollows, FillLevelByTheirVolume) {
  // One row between walls: the hollow is 3, 1, 0, 2 deep under a brim of 4, beyond which land falls off.
  Terrain t(6, 3, {9, 9, 9, 9, 9, 9, 4, 3, 1, 0, 2, 9, 9, 9, 9, 9, 9, 9});
  t.water[7] = 4.5;  // level: 0.. 1 takes 1, .. 2 takes 2 + 1 = 3, then 1.5 over three cells
  EXPECT_EQ(t.settle(), 0);
  EXPECT_NEAR(t.water[9], 2.5, 1e-12);
  EXPECT_NEAR(t.water[8], 1.5, 1e-12);
  EXPECT_NEAR(t.water[10], 0.5, 1e-12);
  EXPECT_EQ(t.water[7], 0);
}

TEST(Hollows, SpillOverTheLowestBrimAndOverTheBorder) {
  // Two hollows of 2 and 1 with a saddle of 3 between them, the brim of 4 at the left border.
  const std::vector<double> ground{9, 9, 9, 9, 9, 4, 2, 3, 1, 9, 9, 9, 9, 9, 9};
  const auto settled = [&](double water, std::size_t cell) {
    Terrain t(5, 3, ground);
    t.water[cell] = water;
    t.water[4] = 0;
    const double drained = t.settle();
    t.water[4] = drained;
    return t.water;
  };
  // In the right one: 1.5 stay.
  EXPECT_NEAR(settled(1.5, 8)[8], 1.5, 1e-12);
  // 2.5: 2 fill it, 0.5 go to the left one.
  EXPECT_NEAR(settled(2.5, 8)[8], 2, 1e-12);
  EXPECT_NEAR(settled(2.5, 8)[6], 0.5, 1e-12);
  // 3.6: both are full, 0.6 over three cells.
  EXPECT_NEAR(settled(3.6, 8)[8], 2.2, 1e-12);
  EXPECT_NEAR(settled(3.6, 8)[7], 0.2, 1e-12);
  EXPECT_NEAR(settled(3.6, 8)[6], 1.2, 1e-12);
  // 7: all full at 6, 1 over the border.
  EXPECT_NEAR(settled(7, 6)[4], 1, 1e-12);
  EXPECT_NEAR(settled(7, 6)[8], 3, 1e-12);
}

TEST(Hollows, PassWaterOnToHollowsThatReachTheBorderLower) {
  // A high hollow at the right spills into one at the left, whose brim at the border is lower.
  Terrain t(7, 3, {9, 9, 9, 9, 9, 9, 9, 2, 1, 3, 5, 4, 8, 9, 9, 9, 9, 9, 9, 9, 9});
  t.water[11] = 1 + 0.75;
  EXPECT_EQ(t.settle(), 0);
  EXPECT_NEAR(t.water[11], 1, 1e-12);
  EXPECT_NEAR(t.water[8], 0.75, 1e-12);
}

TEST(Hollows, SwallowBeforeTheyFill) {
  Terrain t(5, 3, {9, 9, 9, 9, 9, 9, 2, 1, 4, 3, 9, 9, 9, 9, 9});
  t.room = {0, 0, 0, 0, 0, 0, 0.5, 0.25, 0.125, 0, 0, 0, 0, 0, 0};
  t.water[8] = 1;  // 0.125 stay on the way, 0.25 go into the deepest cell, 0.625 stand on it
  EXPECT_EQ(t.settle(), 0);
  EXPECT_NEAR(t.water[8], 0.125, 1e-12);
  EXPECT_NEAR(t.water[7], 0.875, 1e-12);
  // Once more: the level stops at the height of a cell as long as that swallows.
  Terrain u(5, 3, t.ground);
  u.room = t.room;
  u.water[8] = 0.125 + 0.25 + 1 + 0.2;
  u.settle();
  EXPECT_NEAR(u.water[7], 1.25, 1e-12);
  EXPECT_NEAR(u.water[6], 0.2, 1e-12);
  // And rises when it has swallowed all.
  Terrain v(5, 3, t.ground);
  v.room = t.room;
  v.water[8] = 0.125 + 0.25 + 1 + 0.5 + 0.2;
  v.settle();
  EXPECT_NEAR(v.water[7], 1.35, 1e-12);
  EXPECT_NEAR(v.water[6], 0.6, 1e-12);
}

TEST(Hollows, DrainLevelGround) {
  Terrain t(20, 10, std::vector<double>(200, 1.0));
  std::fill(t.water.begin(), t.water.end(), 0.5);
  EXPECT_NEAR(t.settle(), 100, 1e-12);
  EXPECT_EQ(t.total(), 0);
}

TEST(Hollows, AreFilledAsByManyDrops) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 60; ++trial) {
    const int width = 5 + trial % 9, height = 4 + trial % 7;
    const auto cells = static_cast<std::size_t>(width * height);
    std::vector<double> ground(cells);
    std::uniform_real_distribution<double> heights(0, 1);
    for (double& g : ground) g = heights(random);
    if (trial % 3 == 0)  // steps: plateaus and saddles of one height
      for (double& g : ground) g = std::floor(g * 6) / 6;
    Terrain t(width, height, ground);
    // From a few places or from all, little or much.
    const double much = trial % 2 == 0 ? 0.1 : 0.5;
    for (double& w : t.water) w = heights(random) < 0.5 ? 0 : much * heights(random);
    Pouring pouring(t);
    const int parts = 500;
    for (int part = 0; part < parts; ++part)
      for (std::size_t c = 0; c < cells; ++c)
        if (t.water[c] > 0) pouring.drop(c, t.water[c] / parts);
    const double before = t.total(), drained = t.settle();
    EXPECT_NEAR(t.total() + drained, before, 1e-12 * before);
    if (trial % 3 == 0) continue;  // equal heights: where water parts is a matter of taste
    EXPECT_NEAR(drained, pouring.drained, 0.005 * before) << trial;
    for (std::size_t c = 0; c < cells; ++c) EXPECT_NEAR(t.water[c], pouring.depths()[c], 0.005) << trial << " " << c;
  }
}

TEST(Hollows, LeaveWaterAtRest) {
  // Whatever the terrain: no water stands higher than its neighbours' ground or water.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 20; ++trial) {
    const int width = 40, height = 30;
    std::vector<double> ground(static_cast<std::size_t>(width * height));
    for (std::size_t c = 0; c < ground.size(); ++c) {
      const double x = static_cast<double>(c % 40), y = static_cast<double>(c / 40);
      ground[c] = std::sin(0.3 * x) * std::cos(0.2 * y + trial) + 0.5 * unit(random);
      if (trial % 2 == 0) ground[c] = std::round(ground[c] * 5) / 5;
    }
    Terrain t(width, height, ground);
    for (double& w : t.water) w = 0.3 * unit(random);
    for (double& r : t.room) r = trial % 4 < 2 ? 0 : 0.1 * unit(random);
    const double before = t.total(), drained = t.settle();
    EXPECT_NEAR(t.total() + drained, before, 1e-11 * before);
    const auto standing = [&](std::size_t c) { return t.water[c] - t.room[c]; };
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i) {
        const auto c = static_cast<std::size_t>(i + width * j);
        ASSERT_GE(t.water[c], 0);
        if (standing(c) <= 1e-9) continue;
        ASSERT_TRUE(i > 0 && j > 0 && i + 1 < width && j + 1 < height) << "water on the border";
        for (std::size_t n : {c - 1, c + 1, c - 40, c + 40}) {
          const double level = ground[n] + std::max(standing(n), 0.0);
          ASSERT_GE(level, ground[c] + standing(c) - 1e-9) << trial << " " << i << " " << j;
          if (standing(n) < -1e-9) {
            ASSERT_GE(ground[n], ground[c] + standing(c) - 1e-9) << "it would swallow";
          }
        }
      }
    // At rest: once more changes nothing.
    Terrain again(width, height, ground);
    again.room = t.room;
    again.water = t.water;
    const double more = again.settle();
    EXPECT_NEAR(more, 0, 1e-9);
    for (std::size_t c = 0; c < ground.size(); ++c) ASSERT_NEAR(again.water[c], t.water[c], 1e-9);
  }
}

TEST(Hollows, ComeInLongChainsToo) {
  // A staircase of 50,000 hollows within hollows, all full, in a single row.
  const int width = 100'003;
  std::vector<double> ground(static_cast<std::size_t>(width) * 3, 1e9);
  for (int i = 0; i < width; ++i) ground[static_cast<std::size_t>(width + i)] = i % 2 == 0 ? 10.0 + i : i - 5.0;
  Terrain t(width, 3, ground);
  std::fill(t.water.begin() + width, t.water.begin() + 2 * width, 100.0);
  const double before = t.total(), drained = t.settle();
  EXPECT_NEAR((t.total() + drained) / before, 1, 1e-12);
  EXPECT_GT(drained, 0);
}

}  // namespace
}  // namespace meniscus
