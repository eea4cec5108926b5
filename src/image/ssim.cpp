#include "image/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "image/luma.h"

namespace meniscus {
namespace {

constexpr std::size_t kRowsPerPiece = 8;
constexpr double kC1 = (0.01 * 255) * (0.01 * 255);
constexpr double kC2 = (0.03 * 255) * (0.03 * 255);

double luma(Rgb8 c) { return kLumaRed * c.r + kLumaGreen * c.g + kLumaBlue * c.b; }

/// One side of the window; the weights add up to 1.
std::vector<double> gaussian(int side) {
  constexpr int kSide = 11;
  constexpr double kSigma = 1.5;
  std::vector<double> weights(static_cast<std::size_t>(std::min(side, kSide)));
  const double centre = 0.5 * static_cast<double>(weights.size() - 1);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double t = (static_cast<double>(i) - centre) / kSigma;
    weights[i] = std::exp(-0.5 * t * t);
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Weighted sums of a, b, a^2, b^2 and a b.
struct Moments {
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  void add(double weight, const Moments& m) {
    a += weight * m.a;
    b += weight * m.b;
    aa += weight * m.aa;
    bb += weight * m.bb;
    ab += weight * m.ab;
  }
};

/// [Wang2004] eq. 13.
double ssim(const Moments& m) {
  const double covariance = m.ab - m.a * m.b;
  const double variances = (m.aa - m.a * m.a) + (m.bb - m.b * m.b);
  return ((2 * (m.a * m.b) + kC1) * (2 * covariance + kC2)) / ((m.a * m.a + m.b * m.b + kC1) * (variances + kC2));
}

}  // namespace

double mean_ssim(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  if (a.empty()) return 1;
  const std::vector<double> across = gaussian(a.width());
  const std::vector<double> down = gaussian(a.height());
  const std::size_t width = static_cast<std::size_t>(a.width());
  const std::size_t columns = width - across.size() + 1;
  const std::size_t rows = static_cast<std::size_t>(a.height()) - down.size() + 1;
  std::vector<double> row_sums(rows);
  parallel_for(rows, kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    std::vector<Moments> columns_summed(width);
    for (std::size_t y = begin; y < end; ++y) {
      // The window is a product: first its columns are summed, then these sums along the row.
      std::fill(columns_summed.begin(), columns_summed.end(), Moments{});
      for (std::size_t i = 0; i < down.size(); ++i) {
        const Rgb8* row_a = a.row(static_cast<int>(y + i));
        const Rgb8* row_b = b.row(static_cast<int>(y + i));
        for (std::size_t x = 0; x < width; ++x) {
          const double va = luma(row_a[x]), vb = luma(row_b[x]);
          columns_summed[x].add(down[i], {va, vb, va * va, vb * vb, va * vb});
        }
      }
      for (std::size_t x = 0; x < columns; ++x) {
        Moments window;
        for (std::size_t i = 0; i < across.size(); ++i) window.add(across[i], columns_summed[x + i]);
        row_sums[y] += ssim(window);
      }
    }
  });
  return std::accumulate(row_sums.begin(), row_sums.end(), 0.0) / static_cast<double>(rows * columns);
}

}  // namespace meniscus
