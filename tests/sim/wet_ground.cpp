/// The ground's cells: materials, heights, wetness.
#include <gtest/gtest.h>

#include <limits>

#include "ground_scenes.h"
#include "sim/ground_constants.h"

namespace meniscus {
namespace {

using namespace test;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(WetGround, CoversItsRegionWithCells) {
  GroundOptions options;
  options.low = {1, 2};
  options.high = {2.005f, 2.5f};
  options.cell = 0.02f;
  options.up = Axis::z;
  options.level = 3;
  options.roughness = 0;
  const WetGround ground(options);
  EXPECT_EQ(ground.width(), 51);
  EXPECT_EQ(ground.height(), 25);
  for (std::size_t c : {std::size_t{0}, std::size_t{50}, std::size_t{51 * 24}, ground.size() - 1}) {
    EXPECT_EQ(ground.cell_at(ground.place(c)), c);
    EXPECT_FLOAT_EQ(ground.place(c).z, 3);
  }
  EXPECT_EQ(ground.cell_at({2.004f, 2.21f, -7}), 50u + 51u * 10u);
  EXPECT_FALSE(ground.cell_at({0.99f, 2.2f, 3}));
  EXPECT_FALSE(ground.cell_at({1.5f, 2.51f, 3}));
  EXPECT_FALSE(ground.cell_at({kNaN, 2.2f, 3}));
  EXPECT_FALSE(ground.cell_at({kInfinity, 2.2f, 3}));
}

TEST(WetGround, TakesMaterialsOfTheNearestPixelWithTheFirstRowAtTheFarEnd) {
  GroundOptions options;
  options.high = {0.04f, 0.04f};
  options.cell = 0.01f;
  options.materials = Image<GroundMaterial>(2, 2, GroundMaterial::asphalt);
  options.materials(0, 0) = GroundMaterial::steel;     // far, left
  options.materials(1, 1) = GroundMaterial::concrete;  // near, right
  const WetGround ground(options);
  EXPECT_EQ(ground.material(0), GroundMaterial::asphalt);
  EXPECT_EQ(ground.material(3), GroundMaterial::concrete);
  EXPECT_EQ(ground.material(4 + 2), GroundMaterial::concrete);
  EXPECT_EQ(ground.material(4 + 1), GroundMaterial::asphalt);
  EXPECT_EQ(ground.material(8), GroundMaterial::steel);
  EXPECT_EQ(ground.material(12 + 1), GroundMaterial::steel);
  EXPECT_EQ(ground.material(15), GroundMaterial::asphalt);
}

TEST(WetGround, TakesHeightsBetweenThePixelsOfAPicture) {
  GroundOptions options;
  options.high = {0.4f, 0.2f};
  options.cell = 0.05f;
  options.level = 10;
  options.roughness = 0;
  options.heights = Image<float>(2, 2);
  options.heights(0, 0) = 2;  // far, left
  options.heights(1, 0) = 4;
  options.heights(0, 1) = 0;
  options.heights(1, 1) = 1;
  const WetGround ground(options);  // 8 x 4 cells; the pixels' middles at 0.1 and 0.3 m, and at 0.05 and 0.15 m
  const auto bed = [&](std::size_t i, std::size_t j) { return ground.bed(i + 8 * j); };
  EXPECT_FLOAT_EQ(bed(0, 0), 10);  // beyond the middles: constant
  EXPECT_FLOAT_EQ(bed(7, 3), 14);
  // (0.175, 0.075): 3/8 and 1/4 of the way.
  EXPECT_FLOAT_EQ(bed(3, 1), 10 + 0.75f * 0.375f + 0.25f * (2 + 2 * 0.375f));
}

TEST(WetGround, IsAsRoughAsItsMaterial) {
  for (const auto& [material, roughness] :
       {std::pair{GroundMaterial::concrete, 0.0003}, std::pair{GroundMaterial::asphalt, 0.001},
        std::pair{GroundMaterial::steel, 0.00002}}) {
    for (float cell : {0.01f, 0.013f, 0.1f, 0.2f}) {
      GroundOptions options;
      options.cell = cell;
      options.high = vec2(400 * cell);
      options.roughness_length = 0.1f;
      options.material = material;
      const WetGround ground(options);
      double sum = 0, squares = 0;
      for (std::size_t c = 0; c < ground.size(); ++c) {
        sum += ground.bed(c);
        squares += static_cast<double>(ground.bed(c)) * ground.bed(c);
      }
      const double n = static_cast<double>(ground.size()), mean = sum / n;
      EXPECT_NEAR(mean, 0, 0.03 * roughness) << cell;
      EXPECT_NEAR(std::sqrt(squares / n - mean * mean), roughness, 0.03 * roughness) << cell;
    }
  }
}

TEST(WetGround, HasBumpsUpToTheirLengthAndNoLonger) {
  GroundOptions options;
  options.cell = 0.01f;
  options.high = vec2(4.0f);
  options.roughness = 0.001f;
  options.roughness_length = 0.08f;
  const WetGround ground(options);
  const auto correlation = [&](std::size_t apart) {
    double products = 0, squares = 0;
    for (std::size_t j = 0; j < 400; ++j)
      for (std::size_t i = 0; i + apart < 400; ++i) {
        products += static_cast<double>(ground.bed(i + 400 * j)) * ground.bed(i + apart + 400 * j);
        squares += static_cast<double>(ground.bed(i + 400 * j)) * ground.bed(i + 400 * j);
      }
    return products / squares;
  };
  EXPECT_GT(correlation(1), 0.6);
  EXPECT_LT(correlation(1), 0.95);
  EXPECT_GT(correlation(1), correlation(3));
  EXPECT_NEAR(correlation(20), 0, 0.03);
}

TEST(WetGround, HasOtherBumpsForAnotherSeedAndTheSameForTheSame) {
  const WetGround a(rough_ground(50, 1)), b(rough_ground(50, 1)), c(rough_ground(50, 2));
  std::size_t equal = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ASSERT_EQ(a.bed(k), b.bed(k));
    equal += a.bed(k) == c.bed(k);
  }
  EXPECT_LT(equal, 5u);
}

TEST(WetGround, SoaksUpWaterBeforeItIsWet) {
  for (GroundMaterial material : {GroundMaterial::concrete, GroundMaterial::asphalt}) {
    WetGround ground(ground_of({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, material));
    const double capacity = ground.capacity(4);
    EXPECT_GE(capacity, 0.0004);
    EXPECT_LE(capacity, 0.001);
    const double drop = capacity * area_of(ground) / 10;
    for (int k = 0; k < 9; ++k) {
      ground.add(4, drop);
      EXPECT_EQ(ground.wetness(4), Wetness::dry);
      EXPECT_EQ(ground.depth(4), 0);
    }
    EXPECT_NEAR(ground.soaked(4), 0.9 * capacity, 1e-15);
    EXPECT_EQ(ground.soaked(3), 0) << "a dry cell keeps all for itself";
    ground.add(4, drop * 1.5);
    EXPECT_EQ(ground.wetness(4), Wetness::wet);
    EXPECT_EQ(ground.soaked(4), capacity);
    EXPECT_NEAR(ground.soaked(3), 0.01 * capacity, 1e-12) << "a fifth of what was left";
  }
}

TEST(WetGround, IsDryOnSteelWhileDropsStandApart) {
  WetGround ground(ground_of({{0}}));
  EXPECT_EQ(ground.capacity(0), 0);
  EXPECT_EQ(ground.wetness(0), Wetness::dry);
  ground.rain(0.5 * kLeastFilm);
  EXPECT_EQ(ground.wetness(0), Wetness::dry);
  ground.rain(kLeastFilm);
  EXPECT_EQ(ground.wetness(0), Wetness::wet);
}

TEST(WetGround, GoesFromDryToTenMillimetresInSteadyRain) {
  // A box with a rim of 20 mm, from which the rain runs inwards too.
  const auto box = [](int i, int j) { return i == 0 || j == 0 || i == 8 || j == 8 ? 0.02 : 0.0; };
  for (GroundMaterial material : {GroundMaterial::concrete, GroundMaterial::asphalt, GroundMaterial::steel}) {
    WetGround ground(ground_from(9, 9, box, material));
    const std::size_t middle = 40;
    std::vector<std::pair<Wetness, double>> changes{{ground.wetness(middle), 0.0}};
    for (int k = 0; k < 1'200; ++k) {
      ground.rain(1e-5);
      ground.flow(0.1);
      if (ground.wetness(middle) != changes.back().first)
        changes.emplace_back(ground.wetness(middle), ground.depth(middle));
    }
    ASSERT_EQ(changes.size(), 5u) << name_of(material);
    const std::vector<Wetness> states{Wetness::dry, Wetness::wet, Wetness::puddle_3mm, Wetness::puddle_5mm,
                                      Wetness::puddle_10mm};
    const std::vector<double> depths{0, 0, 0.003, 0.005, 0.010};
    for (std::size_t k = 0; k < 5; ++k) {
      EXPECT_EQ(changes[k].first, states[k]) << name_of(material) << k;
      EXPECT_GE(changes[k].second, depths[k]);
      EXPECT_LT(changes[k].second, depths[k] + 4e-5);
    }
  }
}

TEST(WetGround, KnowsItsNames) {
  for (GroundMaterial material : {GroundMaterial::concrete, GroundMaterial::asphalt, GroundMaterial::steel})
    EXPECT_EQ(ground_material_of(name_of(material)), material);
  EXPECT_THROW(ground_material_of("mud"), Error);
  EXPECT_EQ(name_of(Wetness::puddle_3mm), "puddle_3mm");
}

TEST(WetGround, RefusesOptionsOutOfRange) {
  const auto refused = [](auto&& change, ErrorCode code = ErrorCode::invalid_argument) {
    GroundOptions options;
    options.high = vec2(0.1f);
    change(options);
    try {
      const WetGround ground(options);
    } catch (const Error& error) {
      return error.code() == code;
    }
    return false;
  };
  EXPECT_FALSE(refused([](GroundOptions&) {}));
  EXPECT_TRUE(refused([](GroundOptions& o) { o.high = o.low; }));
  EXPECT_TRUE(refused([](GroundOptions& o) { o.high.x = -1; }));
  for (float bad : {0.0f, -1.0f, kNaN, kInfinity}) {
    EXPECT_TRUE(refused([&](GroundOptions& o) { o.cell = bad; })) << bad;
    EXPECT_TRUE(refused([&](GroundOptions& o) { o.roughness_length = bad; })) << bad;
  }
  for (float bad : {kNaN, kInfinity}) {
    EXPECT_TRUE(refused([&](GroundOptions& o) { o.low.y = bad; })) << bad;
    EXPECT_TRUE(refused([&](GroundOptions& o) { o.high.y = bad; })) << bad;
    EXPECT_TRUE(refused([&](GroundOptions& o) { o.level = bad; })) << bad;
    EXPECT_TRUE(refused([&](GroundOptions& o) { o.roughness = bad; })) << bad;
    EXPECT_TRUE(refused([&](GroundOptions& o) { o.heights = Image<float>(2, 2, bad); })) << bad;
  }
  EXPECT_TRUE(refused([](GroundOptions& o) { o.material = static_cast<GroundMaterial>(3); }));
  EXPECT_TRUE(
      refused([](GroundOptions& o) { o.materials = Image<GroundMaterial>(1, 1, static_cast<GroundMaterial>(9)); }));
  EXPECT_TRUE(refused([](GroundOptions& o) { o.cell = 1e-6f; }, ErrorCode::limit_exceeded));
  EXPECT_TRUE(
      refused([](GroundOptions& o) { o.cell = std::numeric_limits<float>::denorm_min(); }, ErrorCode::limit_exceeded));
}

TEST(WetGround, RefusesWaterOutOfRange) {
  WetGround ground(ground_of({{0, 0}}));
  for (double bad : {-1e-9, 1e300, static_cast<double>(kNaN), static_cast<double>(kInfinity)}) {
    EXPECT_THROW(ground.add(0, bad), Error) << bad;
    EXPECT_THROW(ground.rain(bad), Error) << bad;
  }
  for (double bad : {-1.0, static_cast<double>(kNaN), static_cast<double>(kInfinity)})
    EXPECT_THROW(ground.flow(bad), Error) << bad;
  EXPECT_THROW(ground.add(2, 1e-9), Error);
  ground.flow(0);
  ground.add(0, 0);
  EXPECT_EQ(ground.budget().fallen, 0);
}

}  // namespace
}  // namespace meniscus
