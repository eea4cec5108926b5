#include "sim/wall_kernel.h"

#include <gtest/gtest.h>
#include <cmath>

#include "box_boundary.h"
#include "meniscus/formulas/fluids.h"
#include "meniscus/formulas/kernels.h"

namespace meniscus {
namespace {

/// Integral over the solid beyond `distance` of a radial function of support h: shells, of which 2 pi r^2 (1 - d / r)
/// lies beyond the plane.
template <class F>
double over_solid(double distance, double h, F f) {
  constexpr int kShells = 20000;
  double sum = 0;
  for (int i = 0; i < kShells; ++i) {
    const double r = h * (i + 0.5) / kShells;
    const double beyond = std::clamp(0.5 * (1 - distance / r), 0.0, 1.0);
    sum += beyond * 4 * M_PI * r * r * f(static_cast<float>(r)) * h / kShells;
  }
  return sum;
}

TEST(WallKernel, IsTheKernelIntegratedOverAHalfSpace) {
  const float h = 0.3f;
  for (const float d : {-0.25f, -0.1f, 0.0f, 0.05f, 0.15f, 0.29f}) {
    EXPECT_NEAR(formulas::spiky_beyond(d, h), over_solid(d, h, [&](float r) { return formulas::spiky(r, h); }), 1e-5);
    EXPECT_NEAR(formulas::poly6_beyond(d, h), over_solid(d, h, [&](float r) { return formulas::poly6(r, h); }), 1e-5);
    EXPECT_NEAR(formulas::viscosity_laplacian_beyond(d, h) * h * h,
                over_solid(d, h, [&](float r) { return formulas::viscosity_laplacian(r, h); }) * h * h, 1e-3);
    EXPECT_NEAR(formulas::poly6_laplacian_beyond(d, h) * h * h,
                over_solid(d, h, [&](float r) { return formulas::poly6_laplacian(r, h); }) * h * h, 2e-3);
  }
}

TEST(WallKernel, OverThePlaneIsTheSlopeBeyondIt) {
  const float h = 0.3f, step = 1e-3f;
  for (const float d : {-0.2f, -0.05f, 0.02f, 0.1f, 0.25f}) {
    const auto slope = [&](auto f) { return (f(d - step, h) - f(d + step, h)) / (2 * step); };
    EXPECT_NEAR(formulas::spiky_over_plane(d, h), slope(formulas::spiky_beyond), 2e-3f);
    EXPECT_NEAR(formulas::poly6_over_plane(d, h), slope(formulas::poly6_beyond), 2e-3f);
  }
}

Wall wall_of(float distance, vec3 normal) { return {distance, normalize(normal), vec3{0.0f}, -1}; }

TEST(WallShares, CountAnEdgeAndACornerOnce) {
  const Wall walls[] = {wall_of(0, {1, 0, 0}), wall_of(0, {0, 1, 0}), wall_of(0, {0, 0, 1})};
  const float distance[] = {0, 0, 0};
  EXPECT_NEAR(wall_shares({walls, 1}, distance, 0.1f).solid, 0.5f, 1e-6f);
  EXPECT_NEAR(wall_shares({walls, 2}, distance, 0.1f).solid, 0.75f, 1e-6f);
  EXPECT_NEAR(wall_shares({walls, 3}, distance, 0.1f).solid, 0.875f, 1e-6f);
}

TEST(WallShares, OfAWedgeAreItsAngle) {
  for (const float angle : {0.3f, 1.0f, 2.0f, 2.8f}) {  // between the normals: the solid takes pi + angle of 2 pi
    const Wall walls[] = {wall_of(0, {1, 0, 0}), wall_of(0, {std::cos(angle), std::sin(angle), 0})};
    const float distance[] = {0, 0};
    EXPECT_NEAR(wall_shares(walls, distance, 0.1f).solid, 0.5f + angle / (2 * 3.14159265f), 1e-5f) << angle;
  }
}

TEST(WallShares, CountTheSameWallOnceAndTwoSidesOfASlitBoth) {
  const float d = 0.03f, h = 0.1f;
  const float one = formulas::spiky_beyond(d, h);
  const float distance[] = {d, d};
  const Wall same[] = {wall_of(d, {1, 0, 0}), wall_of(d, {1, 0, 0})};
  EXPECT_NEAR(wall_shares(same, distance, h).solid, one, 1e-6f);
  const Wall slit[] = {wall_of(d, {1, 0, 0}), wall_of(d, {-1, 0, 0})};
  EXPECT_NEAR(wall_shares(slit, distance, h).solid, 2 * one, 1e-6f);
}

TEST(WallShares, WeightsAreTheSlopesOfTheSolidPart) {
  const float h = 0.1f, step = 1e-4f;
  const Wall walls[] = {wall_of(0, {1, 0, 0}), wall_of(0, {0, 1, 0})};
  const float distance[] = {0.02f, 0.01f};
  const WallShares shares = wall_shares(walls, distance, h);
  for (int w = 0; w < 2; ++w) {
    float nearer[] = {0.02f, 0.01f}, farther[] = {0.02f, 0.01f};
    nearer[w] -= step;
    farther[w] += step;
    const float slope = (wall_shares(walls, nearer, h).solid - wall_shares(walls, farther, h).solid) / (2 * step);
    EXPECT_NEAR(shares.weight[w] * formulas::spiky_over_plane(distance[w], h), slope, 0.01f);
  }
}

}  // namespace
}  // namespace meniscus
