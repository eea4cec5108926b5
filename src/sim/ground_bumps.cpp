/// The ground's small bumps: value noise.
#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "sim/ground_cells.h"

namespace meniscus {
namespace {

/// Uniform with mean 0 and standard deviation 1, of a corner of an octave's lattice.
double corner(std::uint64_t octave, std::int64_t i, std::int64_t j) {
  const std::uint64_t bits =
      mixed(mixed(octave ^ static_cast<std::uint64_t>(i)) ^ static_cast<std::uint64_t>(j) * 0x9e3779b97f4a7c15u);
  return (static_cast<double>(bits >> 11) * 0x1p-53 - 0.5) * std::sqrt(12.0);
}

double smooth(double t) { return t * t * (3 - 2 * t); }

/// Variance, over all places, of values of variance 1 at the corners of a lattice and blended between them by smooth():
/// in each direction the mean of s^2 + (1 - s)^2, 26/35.
constexpr double kBlended = (26.0 / 35.0) * (26.0 / 35.0);

struct Octave {
  double length;  ///< m, between corners
  double height;  ///< standard deviation at the corners, before all are scaled
  std::uint64_t seed;
};

}  // namespace

std::vector<float> ground_bumps(GroundSize size, double cell, double length, std::uint64_t seed) {
  // Halving lengths down to two cells, then one value a cell.
  std::vector<Octave> octaves;
  double height = 1, variance = 0;
  for (double l = length; l >= 2 * cell && octaves.size() < 32; l /= 2, height /= 2) {
    octaves.push_back({l, height, mixed(mixed(seed) ^ octaves.size())});
    variance += height * height * kBlended;
  }
  const std::uint64_t cells_seed = mixed(mixed(seed) ^ 0x63656c6cu);
  variance += height * height;
  const double scale = 1 / std::sqrt(variance);

  const auto width = static_cast<std::size_t>(size.width);
  std::vector<float> bumps(width * static_cast<std::size_t>(size.height));
  parallel_for(static_cast<std::size_t>(size.height), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<double> row(width);
    for (std::size_t j = begin; j < end; ++j) {
      for (std::size_t i = 0; i < width; ++i)
        row[i] = height * corner(cells_seed, static_cast<std::int64_t>(i), static_cast<std::int64_t>(j));
      for (const Octave& octave : octaves) {
        const double y = (static_cast<double>(j) + 0.5) * cell / octave.length;
        const auto y0 = static_cast<std::int64_t>(y);
        const double v = smooth(y - static_cast<double>(y0));
        // Corners are asked for once for all cells between them.
        std::int64_t at = -1;
        double left = 0, right = 0;
        const auto column = [&](std::int64_t x0) {
          return corner(octave.seed, x0, y0) * (1 - v) + corner(octave.seed, x0, y0 + 1) * v;
        };
        for (std::size_t i = 0; i < width; ++i) {
          const double x = (static_cast<double>(i) + 0.5) * cell / octave.length;
          const auto x0 = static_cast<std::int64_t>(x);
          if (x0 != at) {
            left = x0 == at + 1 && at >= 0 ? right : column(x0);
            right = column(x0 + 1);
            at = x0;
          }
          row[i] += octave.height * (left + (right - left) * smooth(x - static_cast<double>(x0)));
        }
      }
      for (std::size_t i = 0; i < width; ++i) bumps[i + width * j] = static_cast<float>(scale * row[i]);
    }
  });
  return bumps;
}

}  // namespace meniscus
