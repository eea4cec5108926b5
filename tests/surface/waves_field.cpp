// Superposed waves against their closed forms.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

WaveFieldOptions field_with(std::vector<WaveTrain> waves) {
  WaveFieldOptions options;
  options.waves = std::move(waves);
  options.step = 0.05f;
  return options;
}

WaveTrain train(WaveTrain::Kind kind, float amplitude, float length, float direction, float phase = 0) {
  WaveTrain wave;
  wave.kind = kind;
  wave.amplitude = amplitude;
  wave.wavelength = length;
  wave.direction_deg = direction;
  wave.phase_deg = phase;
  return wave;
}

TEST(WaveField, SumsSinesThatRunAtTheSpeedOfGravityWaves) {
  const auto sine = WaveTrain::Kind::sine;
  const double time = 1.7;
  const HeightField field =
      height_field(field_with({train(sine, 0.03f, 0.6f, 30, 40), train(sine, 0.02f, 0.9f, 200)}), time);
  for (int j = 0; j < field.height.height(); ++j)
    for (int i = 0; i < field.height.width(); ++i) {
      const glm::dvec3 p(field.point(static_cast<float>(i), static_cast<float>(j), 0));
      double height = 0.5, by_x = 0, by_z = 0;
      for (const auto [amplitude, length, direction, phase] :
           {std::array{0.03, 0.6, 30.0, 40.0}, std::array{0.02, 0.9, 200.0, 0.0}}) {
        const double degree = std::numbers::pi / 180, k = 2 * std::numbers::pi / length;
        const double omega = std::sqrt(9.81 * k * std::tanh(k * 0.5));
        const double kx = k * std::cos(direction * degree), kz = k * std::sin(direction * degree);
        const double theta = kx * p.x + kz * p.z - omega * time + phase * degree;
        height += amplitude * std::cos(theta);
        by_x -= amplitude * kx * std::sin(theta);
        by_z -= amplitude * kz * std::sin(theta);
      }
      EXPECT_NEAR(field.height(i, j), height, 1e-6);
      EXPECT_LT(degrees_between(field.normal(i, j), vec3(glm::dvec3{-by_x, 1, -by_z})), 0.01);
    }
}

TEST(WaveField, GerstnerWavesAreTrochoids) {
  for (const float steepness : {0.0f, 0.5f, 0.95f, 1.0f}) {
    WaveTrain wave = train(WaveTrain::Kind::gerstner, 0.05f, 0.8f, 0);
    wave.steepness = steepness;
    const HeightField field = height_field(field_with({wave}), 0.0);
    // Points of the trochoid lie on the field: x = x0 - q / k sin(k x0), y = a cos(k x0).
    const double k = 2 * std::numbers::pi / 0.8;
    for (int i = 0; i < field.height.width(); ++i) {
      const double x = static_cast<double>(field.point(static_cast<float>(i), 0, 0).x);
      double low = x - 0.4, high = x + 0.4;
      for (int n = 0; n < 80; ++n) {
        const double middle = 0.5 * (low + high);
        (middle - static_cast<double>(steepness) / k * std::sin(k * middle) < x ? low : high) = middle;
      }
      EXPECT_NEAR(field.height(i, 5), 0.5 + 0.05 * std::cos(k * low), 2e-5) << steepness << " " << x;
      EXPECT_NEAR(glm::length(field.normal(i, 5)), 1.0f, 1e-5f);
      EXPECT_GE(field.normal(i, 5).y, 0.0f);
    }
  }
}

TEST(WaveField, RefusesWavesOutOfRange) {
  EXPECT_THROW(height_field(field_with({train(WaveTrain::Kind::sine, 0.02f, 0, 0)}), 0), Error);
  EXPECT_THROW(height_field(field_with({train(WaveTrain::Kind::sine, 0.7f, 1, 0)}), 0), Error);
  EXPECT_THROW(height_field(field_with({train(WaveTrain::Kind::sine, -0.1f, 1, 0)}), 0), Error);
  EXPECT_THROW(height_field(field_with({train(WaveTrain::Kind::sine, 0.01f, 1e-4f, 0)}), 0),
               Error);  // no columns for it
}

}  // namespace
}  // namespace meniscus
