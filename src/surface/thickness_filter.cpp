#include "surface/thickness_filter.h"

#include <algorithm>
#include <cmath>

namespace meniscus {
namespace {

constexpr float kSameRelative = 0.2f;  ///< of the thickness: differences of the same body of water

/// One direction: along rows or along columns.
Image<float> pass(const Image<float>& from, const std::vector<float>& weights, float spacing, bool along_x) {
  const int radius = static_cast<int>(weights.size()) - 1;
  Image<float> to(from.width(), from.height());
  parallel_for(static_cast<std::size_t>(from.height()), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < from.width(); ++x) {
        const float here = from(x, y);
        if (!(here > 0.0f)) continue;
        const float per_tolerance = 1.0f / (kSameRelative * here + spacing);
        float sum = here, weight = 1.0f;
        const int place = along_x ? x : y, count = along_x ? from.width() : from.height();
        for (int off = -std::min(radius, place); off <= std::min(radius, count - 1 - place); ++off) {
          if (off == 0) continue;
          const float there = along_x ? from(x + off, y) : from(x, y + off);
          if (!(there > 0.0f)) continue;
          const float differs = (there - here) * per_tolerance;
          const float same = 1.0f / (1.0f + differs * differs);
          const float w = weights[static_cast<std::size_t>(std::abs(off))] * same * same;
          sum += w * there;
          weight += w;
        }
        to(x, y) = sum / weight;
      }
  });
  return to;
}

}  // namespace

Image<float> smoothed_thickness(const Image<float>& thickness, float sigma, float spacing) {
  if (!(sigma >= 0.5f)) return thickness;
  std::vector<float> weights;
  for (int off = 0; off <= static_cast<int>(2.0f * sigma + 0.5f); ++off)
    weights.push_back(std::exp(-0.5f * static_cast<float>(off * off) / (sigma * sigma)));
  return pass(pass(thickness, weights, spacing, true), weights, spacing, false);
}

}  // namespace meniscus
