#include "particles/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace meniscus {
namespace {

/// The last particle before a gap that no lattice has among so many: a drop's end, when other water is further off.
constexpr std::size_t kFirstGap = 9;
constexpr double kGap = 1.45;

/// Few enough neighbours not to reach around a bend, and the variance, as a part of the largest, below which they
/// lie in a sheet of one layer or a thread; in a body that many particles hardly ever lie so flat by chance.
constexpr std::size_t kFew = 24;
constexpr double kFlat = 0.1;

/// How much rounder than a box a neighbourhood that is as wide as it is long is taken to be. A ball would be by
/// 0.13, but few cubes are no ball. Measured: 0.98 to 1.03 inside lattices and at their surface, 1.07 among random
/// particles, 1.01 to 1.03 in sheets.
constexpr double kRounder = 0.03;

/// A neighbourhood fills a further dimension when its variance there is this part of the largest, as in half a
/// ball (0.30) or half a disc (0.28).
constexpr double kFilled = 0.25;

/// Eigenvalues of a symmetric matrix, largest first, by the trigonometric form of the cubic's roots.
std::array<double, 3> eigenvalues(double xx, double yy, double zz, double xy, double xz, double yz) {
  const double mean = (xx + yy + zz) / 3;
  const double a = xx - mean, b = yy - mean, c = zz - mean;
  const double p = std::sqrt((a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6);
  if (!(p > 0)) return {mean, mean, mean};
  const double determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
  const double angle = std::acos(std::clamp(determinant / (2 * p * p * p), -1.0, 1.0)) / 3;
  const double largest = mean + 2 * p * std::cos(angle);
  const double smallest = mean + 2 * p * std::cos(angle + 2.0943951023931953);
  return {std::max(largest, 0.0), std::max(3 * mean - largest - smallest, 0.0), std::max(smallest, 0.0)};
}

/// Solves n s^3 = c sqrt(product of (12 l + s^2)); the two sides cross once for n > c.
double solved(double n, double c, const std::array<double, 3>& l) {
  double low = 0, high = 4 * std::sqrt(12 * l[0]);
  for (int i = 0; i < 40; ++i) {
    const double s = 0.5 * (low + high);
    const double volume = c * std::sqrt((12 * l[0] + s * s) * (12 * l[1] + s * s) * (12 * l[2] + s * s));
    (n * s * s * s < volume ? low : high) = s;
  }
  return 0.5 * (low + high);
}

}  // namespace

Surroundings surroundings_of(const Moments& m) {
  if (m.n < 2) return {};
  const glm::dvec3 mean = m.sum / m.n;
  const glm::dvec3 square = m.square / m.n - mean * mean;
  const auto l = eigenvalues(square.x, square.y, square.z, m.mixed.x / m.n - mean.x * mean.y,
                             m.mixed.y / m.n - mean.x * mean.z, m.mixed.z / m.n - mean.y * mean.z);
  if (!(l[0] > 0)) return {};
  const double second = std::min(l[1] / (kFilled * l[0]), 1.0);
  const double third = std::min(l[2] / (kFilled * l[0]), 1.0);
  return {solved(m.n, 1 + kRounder * l[1] / l[0], l), 1 + second + third, l[2] / l[0]};
}

Surroundings surroundings_of(std::span<const Neighbour> nearest) {
  std::size_t count = nearest.size();
  for (std::size_t i = kFirstGap; i < nearest.size(); ++i) {
    if (nearest[i].distance2 > kGap * kGap * nearest[i - 1].distance2 && nearest[i - 1].distance2 > 0) {
      count = i;
      break;
    }
  }
  if (count < 2 || !(nearest[count - 1].distance2 > 0)) return {};

  Moments moments;
  for (std::size_t i = 0; i < count; ++i) {
    moments.add(nearest[i].offset);
    if (i + 1 != kFew) continue;
    const Surroundings few = surroundings_of(moments);
    if (few.spacing > 0 && few.flatness < kFlat) return few;
  }
  return surroundings_of(moments);
}

}  // namespace meniscus
