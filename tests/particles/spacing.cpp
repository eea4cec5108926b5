#include <gtest/gtest.h>

#include <string>

#include "clouds.h"
#include "meniscus/particles.h"

namespace meniscus {
namespace {

using namespace clouds;

/// A cloud whose particles stand for cubes of a known edge.
struct Case {
  std::string name;
  std::function<Particles()> cloud;
  double spacing = 1;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Spacing : public testing::TestWithParam<Case> {};

TEST_P(Spacing, IsTheEdgeOfTheCubeThatAParticleStandsFor) {
  const SpacingEstimate estimate = estimate_spacing(GetParam().cloud());
  EXPECT_NEAR(estimate.spacing / GetParam().spacing, 1, 0.15) << estimate.reasoning;
}

Particles scaled(const Particles& particles, double factor, glm::dvec3 offset = {}) {
  return moved(particles, [&](glm::dvec3 p) { return p * factor + offset; });
}

Particles drop(double radius) {
  Particles result;
  add_drop(result, {}, radius);
  return result;
}

Particles repeated(const Particles& particles, int times) {
  Particles result;
  for (int i = 0; i < times; ++i) result = joined(std::move(result), particles);
  return result;
}

Particles spread(const Particles& particles, double sigma) {
  Random random(11);
  return moved(particles, [&](glm::dvec3 p) { return p + random.normal(sigma); });
}

INSTANTIATE_TEST_SUITE_P(
    Bodies, Spacing,
    testing::Values(Case{"cubic", [] { return cubic(30, 30, 30); }}, Case{"cubic_small", [] { return cubic(8, 8, 8); }},
                    Case{"cubic_27", [] { return cubic(3, 3, 3); }}, Case{"cubic_8", [] { return cubic(2, 2, 2); }},
                    Case{"face_centred", [] { return face_centred(22); }},
                    Case{"hexagonal", [] { return hexagonal(22); }},
                    Case{"jittered_quarter", [] { return cubic(25, 25, 25, 0.25); }},
                    Case{"jittered_half", [] { return cubic(25, 25, 25, 0.5); }},
                    Case{"gaussian_half", [] { return spread(cubic(25, 25, 25), 0.5); }},
                    Case{"flip_seeds", [] { return flip_seeds(14, 14, 14); }},
                    Case{"flip_seeds_1000", [] { return flip_seeds(5, 5, 5); }},
                    Case{"flip_in_pairs", [] { return pairs(14); }},
                    Case{"flip_clumped_little", [] { return advected(14, 0.2); }},
                    Case{"flip_clumped", [] { return advected(14, 0.4); }},
                    Case{"three_in_each_place", [] { return repeated(cubic(10, 10, 10), 3); }, std::cbrt(1 / 3.0)},
                    Case{"a_hundred_in_each_place", [] { return repeated(cubic(6, 6, 6), 100); }, std::cbrt(0.01)}),
    [](const auto& info) { return info.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Sheets, Spacing,
    testing::Values(Case{"one_layer", [] { return cubic(50, 1, 50); }},
                    Case{"two_layers", [] { return cubic(50, 2, 50); }},
                    Case{"three_layers", [] { return cubic(50, 3, 50); }},
                    Case{"one_layer_of_25", [] { return cubic(5, 1, 5); }},
                    Case{"one_layer_tilted", [] { return tilted_sheet(50, 1, 0.2); }},
                    Case{"two_layers_tilted", [] { return tilted_sheet(50, 2, 0.2); }},
                    Case{"three_layers_tilted", [] { return tilted_sheet(50, 3, 0.2); }},
                    Case{"one_layer_bent_to_5", [] { return cylinder(5, 40, 1); }},
                    Case{"one_layer_bent_to_12", [] { return cylinder(12, 40, 1); }},
                    Case{"two_layers_bent_to_5", [] { return cylinder(5, 40, 2); }},
                    Case{"two_layers_bent_to_12", [] { return cylinder(12, 40, 2); }},
                    Case{"flip_of_one_cell", [] { return flip_seeds(30, 30, 1); }},
                    Case{"with_spray_about",
                         [] {
                           return joined(cubic(50, 1, 50), spray(300, {-40, -40, -40}, {40, 40, 40}));
                         }},
                    Case{"with_more_spray_about",
                         [] {
                           return joined(cubic(50, 1, 50), spray(2500, {-40, -40, -40}, {40, 40, 40}));
                         }}),
    [](const auto& info) { return info.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Pieces, Spacing,
    testing::Values(Case{"splash", [] { return splash(); }}, Case{"drop_of_33", [] { return drop(2); }},
                    Case{"drop_of_257", [] { return drop(4); }}, Case{"drops_of_33", [] { return drops(10); }},
                    Case{"thread", [] { return cubic(200, 1, 1); }},
                    Case{"thread_jittered", [] { return cubic(300, 1, 1, 0.2); }},
                    Case{"thread_two_wide", [] { return cubic(200, 2, 2); }},
                    Case{"thread_three_wide", [] { return cubic(200, 3, 3); }},
                    Case{"body_in_as_much_spray",
                         [] {
                           return joined(cubic(15, 15, 15), spray(3375, {-40, -40, -40}, {40, 40, 40}));
                         }},
                    Case{"body_in_twice_as_much_spray",
                         [] {
                           return joined(cubic(15, 15, 15), spray(8000, {-40, -40, -40}, {40, 40, 40}));
                         }},
                    Case{"body_with_many_in_one_point", [] { return joined(cubic(20, 20, 20), spray(20000, {}, {})); }},
                    Case{"body_and_one_very_far",
                         [] { return joined(cubic(20, 20, 20), spray(1, glm::dvec3(1e7), glm::dvec3(1e7))); }},
                    Case{"two_bodies_far_apart",
                         [] {
                           return joined(cubic(20, 20, 20), scaled(cubic(20, 20, 20), 1, {1000, 0, 0}));
                         }},
                    Case{"two_particles", [] { return cubic(2, 1, 1); }},
                    Case{"three_particles", [] { return cubic(3, 1, 1); }}),
    [](const auto& info) { return info.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Scales, Spacing,
    testing::Values(Case{"a_tenth_of_a_millimetre", [] { return scaled(cubic(15, 15, 15, 0.2), 1e-4); }, 1e-4},
                    Case{"a_kilometre", [] { return scaled(cubic(15, 15, 15, 0.2), 1e3); }, 1e3},
                    Case{"far_from_the_origin",
                         [] {
                           return scaled(cubic(15, 15, 15, 0.2), 0.01, {100, -50, 20});
                         },
                         0.01},
                    Case{"next_to_nothing", [] { return scaled(cubic(15, 15, 15), 1e-20); }, 1e-20},
                    Case{"next_to_everything", [] { return scaled(cubic(15, 15, 15), 1e30); }, 1e30}),
    [](const auto& info) { return info.param.name; });

// More particles than are searched among: only some blocks of them are.
INSTANTIATE_TEST_SUITE_P(Blocks, Spacing,
                         testing::Values(Case{"body_of_729000", [] { return cubic(90, 90, 90, 0.2); }},
                                         Case{"sheet_of_640000", [] { return cubic(800, 1, 800); }}),
                         [](const auto& info) { return info.param.name; });

TEST(SpacingEstimate, TellsBodiesFromSheetsAndThreads) {
  EXPECT_NEAR(estimate_spacing(cubic(15, 15, 15, 0.2)).dimension, 3, 0.1);
  EXPECT_NEAR(estimate_spacing(tilted_sheet(40, 1)).dimension, 2, 0.1);
  EXPECT_NEAR(estimate_spacing(cubic(100, 1, 1)).dimension, 1, 0.1);
}

TEST(SpacingEstimate, DoesNotDependOnTheOrderOfTheParticles) {
  const Particles cloud = splash();
  EXPECT_NEAR(estimate_spacing(shuffled(cloud, 1)).spacing / estimate_spacing(cloud).spacing, 1, 0.01);
}

TEST(SpacingEstimate, DoesNotDependOnHowTheWaterIsTurned) {
  const Particles cloud = splash();
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Particles turned = moved(
      cloud, [&](glm::dvec3 p) { return glm::dvec3(c * p.x - s * p.y, s * p.x + c * p.y, p.z) + glm::dvec3(3, 5, 7); });
  EXPECT_NEAR(estimate_spacing(turned).spacing / estimate_spacing(cloud).spacing, 1, 0.01);
}

TEST(SpacingEstimate, HasTheSameBitsForAnyNumberOfThreads) {
  const Particles cloud = splash();
  const SpacingEstimate all = estimate_spacing(cloud);
  for (const int threads : {1, 5}) {
    const ThreadLimit limit(threads);
    const SpacingEstimate estimate = estimate_spacing(cloud);
    EXPECT_EQ(estimate.spacing, all.spacing);
    EXPECT_EQ(estimate.dimension, all.dimension);
    EXPECT_EQ(estimate.reasoning, all.reasoning);
  }
}

TEST(SpacingEstimate, OfNoParticlesIsZero) {
  const SpacingEstimate estimate = estimate_spacing({});
  EXPECT_EQ(estimate.spacing, 0);
  EXPECT_EQ(estimate.reasoning, "no particles");
}

TEST(SpacingEstimate, OfOnePlaceIsPositiveAndSaysThatItIsTaken) {
  for (const std::size_t count : std::initializer_list<std::size_t>{1, 2, 1000, 20000}) {
    const SpacingEstimate estimate = estimate_spacing(spray(count, {1, 2, 3}, {1, 2, 3}));
    EXPECT_GT(estimate.spacing, 0) << count;
    EXPECT_NE(estimate.reasoning.find("taken"), std::string::npos) << estimate.reasoning;
  }
}

TEST(SpacingEstimate, OfStretchedCloudsIsFinite) {
  for (const double stretch : {1e3, 1e6, 1e12}) {
    const SpacingEstimate estimate = estimate_spacing(
        moved(flip_seeds(10, 10, 10), [&](glm::dvec3 p) { return p * glm::dvec3(1, stretch, 1 / stretch); }));
    EXPECT_TRUE(std::isfinite(estimate.spacing) && estimate.spacing > 0) << stretch;
  }
}

TEST(SpacingEstimate, TakesWhatTheFileTellsIfItFits) {
  Particles cloud = cubic(10, 10, 10);
  cloud.spacing = 0.93f;
  EXPECT_EQ(estimate_spacing(cloud).spacing, 0.93f);
  cloud.spacing = 40.0f;
  EXPECT_NEAR(estimate_spacing(cloud).spacing, 1, 0.15);
  EXPECT_NE(estimate_spacing(cloud).reasoning.find("does not fit"), std::string::npos);

  Particles alone = cubic(1, 1, 1);
  alone.spacing = 40.0f;
  EXPECT_EQ(estimate_spacing(alone).spacing, 40.0f);
}

}  // namespace
}  // namespace meniscus
