#include "meniscus/formulas/eigen.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <random>

namespace meniscus::formulas {
namespace {

double uniform(std::mt19937& random) { return static_cast<double>(random()) / 2147483648.0 - 1.0; }

double size_of(const Symmetric3& a) {
  return std::sqrt(
      static_cast<double>(a.xx) * a.xx + static_cast<double>(a.yy) * a.yy + static_cast<double>(a.zz) * a.zz +
      2.0 * (static_cast<double>(a.xy) * a.xy + static_cast<double>(a.xz) * a.xz + static_cast<double>(a.yz) * a.yz));
}

/// det(A - lambda I) in double precision.
double characteristic(const Symmetric3& a, double lambda) {
  const double xx = a.xx - lambda, yy = a.yy - lambda, zz = a.zz - lambda, xy = a.xy, xz = a.xz, yz = a.yz;
  return xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
}

/// A v = lambda v, v unit, the values in order, roots of the characteristic polynomial, and their sum the trace.
void expect_solved(const Symmetric3& a) {
  const LeastEigen e = least_eigen(a);
  const double size = std::max(size_of(a), 1e-30);
  const glm::dvec3 v(e.direction);
  EXPECT_NEAR(v.x * v.x + v.y * v.y + v.z * v.z, 1.0, 2e-6);
  const glm::dvec3 image{a.xx * v.x + a.xy * v.y + a.xz * v.z, a.xy * v.x + a.yy * v.y + a.yz * v.z,
                         a.xz * v.x + a.yz * v.y + a.zz * v.z};
  const glm::dvec3 off = image - static_cast<double>(e.least) * v;
  EXPECT_LT(std::sqrt(off.x * off.x + off.y * off.y + off.z * off.z), 3e-6 * size);
  EXPECT_LE(e.least, e.middle + 2e-6 * size);
  EXPECT_LE(e.middle, e.largest + 2e-6 * size);
  EXPECT_NEAR((static_cast<double>(e.least) + e.middle + e.largest) / size,
              (static_cast<double>(a.xx) + a.yy + a.zz) / size, 3e-6);
  for (const float lambda : {e.least, e.middle, e.largest})
    EXPECT_LT(std::abs(characteristic(a, lambda)), 1e-5 * size * size * size);
}

/// Columns of a random rotation times the eigenvalues.
Symmetric3 with_eigenvalues(double l0, double l1, double l2, std::mt19937& random) {
  glm::dvec3 a{uniform(random), uniform(random), uniform(random)}, b{uniform(random), uniform(random), uniform(random)};
  const auto unit = [](glm::dvec3 v) { return v / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); };
  const auto cross = [](glm::dvec3 p, glm::dvec3 q) {
    return glm::dvec3{p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
  };
  a = unit(a);
  b = unit(cross(a, b));
  const glm::dvec3 c = cross(a, b);
  const auto entry = [&](int i, int j) {
    return static_cast<float>(l0 * a[i] * a[j] + l1 * b[i] * b[j] + l2 * c[i] * c[j]);
  };
  return {entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)};
}

TEST(LeastEigen, SolvesRandomMatrices) {
  std::mt19937 random(7);
  for (int i = 0; i < 2000; ++i) {
    const auto f = [&] { return static_cast<float>(uniform(random)); };
    expect_solved({f(), f(), f(), f(), f(), f()});
  }
}

TEST(LeastEigen, SolvesMatricesOfAnyScale) {
  std::mt19937 random(8);
  for (const float scale : {1e-12f, 1e-6f, 1e3f, 1e9f})
    for (int i = 0; i < 100; ++i) {
      const auto f = [&] { return scale * static_cast<float>(uniform(random)); };
      expect_solved({f(), f(), f(), f(), f(), f()});
    }
}

TEST(LeastEigen, FindsTheNormalOfAFlatCloud) {
  std::mt19937 random(9);
  for (int i = 0; i < 500; ++i) expect_solved(with_eigenvalues(1e-3, 0.2 + 0.1 * uniform(random), 0.3, random));
}

TEST(LeastEigen, SolvesMatricesWithRepeatedEigenvalues) {
  std::mt19937 random(10);
  for (int i = 0; i < 200; ++i) {
    expect_solved(with_eigenvalues(0.1, 0.3, 0.3, random));
    expect_solved(with_eigenvalues(0.1, 0.1, 0.3, random));
    expect_solved(with_eigenvalues(0.2, 0.2, 0.2, random));
    expect_solved(with_eigenvalues(-0.3, -0.3, 0.2, random));
  }
}

TEST(LeastEigen, LeavesDiagonalMatricesAsTheyAre) {
  for (int least = 0; least < 3; ++least) {
    Symmetric3 a{2, 2, 3, 0, 0, 0};
    (least == 0 ? a.xx : least == 1 ? a.yy : a.zz) = 1;
    const LeastEigen e = least_eigen(a);
    EXPECT_EQ(e.least, 1.0f);
    EXPECT_EQ(std::abs(e.direction[least]), 1.0f);
    expect_solved(a);
  }
}

TEST(LeastEigen, GivesAUnitVectorForTheZeroMatrix) { expect_solved({0, 0, 0, 0, 0, 0}); }

TEST(LeastEigen, FindsTheTwoNullDirectionsOfRankOne) {
  std::mt19937 random(11);
  for (int i = 0; i < 200; ++i) {
    const Symmetric3 a = with_eigenvalues(0, 0, 0.7, random);
    expect_solved(a);
    const LeastEigen e = least_eigen(a);
    EXPECT_NEAR(e.least, 0.0f, 2e-6f);
    EXPECT_NEAR(e.middle, 0.0f, 2e-6f);
    EXPECT_NEAR(e.largest, 0.7f, 2e-6f);
  }
}

}  // namespace
}  // namespace meniscus::formulas
