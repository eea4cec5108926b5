#include "surface/thickness_filter.h"

#include <algorithm>
#include <cmath>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/thickness_filter.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;

constexpr float kSameRelative = 0.2f;  ///< of the thickness: differences of the same body of water

/// Values that are averaged with those of the taps: tap k is from[k] + x for sample x, with weights[k]; those of
/// samples beside the picture are not > 0.
/// @param spacing  m; 0: weights do not depend on the values
void average(const float* here, const float* const* taps, const float* weights, int count, float spacing, int width,
             float* to) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  for (int x = 0; x < width; x += lanes) {
    // Masked loads and stores may touch what lies past the end.
    const int valid = std::min(lanes, width - x);
    alignas(64) float rest[16] = {};
    const auto load = [&](const float* from) {
      if (valid == lanes) return hn::LoadU(d, from);
      std::copy_n(from, valid, rest);
      return hn::Load(d, rest);
    };
    const auto store = [&](Vec value, float* out) {
      if (valid == lanes) return hn::StoreU(value, d, out);
      hn::Store(value, d, rest);
      std::copy_n(rest, valid, out);
    };
    const Vec middle = load(here + x);
    if (spacing > 0.0f && hn::AllTrue(d, hn::Le(middle, zero))) {
      store(zero, to + x);
      continue;
    }
    const Vec per_tolerance = hn::Div(one, hn::MulAdd(middle, hn::Set(d, kSameRelative), hn::Set(d, spacing)));
    Vec sum = middle, total = one;
    for (int k = 0; k < count; ++k) {
      const Vec there = load(taps[k] + x);
      Vec weight = hn::Set(d, weights[k]);
      if (spacing > 0.0f) {
        const Vec differs = hn::Mul(hn::Sub(there, middle), per_tolerance);
        const Vec same = hn::MulAdd(differs, differs, one);
        weight = hn::IfThenElseZero(hn::Gt(there, zero), hn::Div(weight, hn::Mul(same, same)));
      } else {
        weight = hn::IfThenElseZero(hn::Ge(there, zero), weight);
      }
      sum = hn::MulAdd(weight, there, sum);
      total = hn::Add(total, weight);
    }
    Vec result = hn::Div(sum, total);
    if (spacing > 0.0f) result = hn::IfThenElseZero(hn::Gt(middle, zero), result);
    store(result, to + x);
  }
}

}  // namespace

void Average(const float* here, const float* const* taps, const float* weights, int count, float spacing, int width,
             float* to) {
  average(here, taps, weights, count, spacing, width, to);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(Average);

namespace {

constexpr std::size_t kRows = 16;
constexpr float kBeside = -1.0f;  ///< marks samples beside the picture

/// One direction: along rows or along columns. Values are >= 0.
Image<float> pass(const Image<float>& from, const std::vector<float>& weights, float spacing, bool along_x) {
  const int radius = static_cast<int>(weights.size()) - 1, width = from.width(), height = from.height();
  Image<float> to(width, height);
  parallel_for(static_cast<std::size_t>(height), kRows, [&](std::size_t begin, std::size_t end) {
    std::vector<float> padded(static_cast<std::size_t>(width + 2 * radius), kBeside), tap_weights;
    std::vector<const float*> taps;
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      if (along_x) std::copy_n(from.row(y), width, padded.begin() + radius);
      taps.clear();
      tap_weights.clear();
      for (int off = -radius; off <= radius; ++off) {
        if (off == 0 || (!along_x && (y + off < 0 || y + off >= height))) continue;
        taps.push_back(along_x ? padded.data() + radius + off : from.row(y + off));
        tap_weights.push_back(weights[static_cast<std::size_t>(std::abs(off))]);
      }
      HWY_DYNAMIC_DISPATCH(Average)
      (from.row(y), taps.data(), tap_weights.data(), static_cast<int>(taps.size()), spacing, width, to.row(y));
    }
  });
  return to;
}

/// Of a Gaussian, from its middle to two sigma.
std::vector<float> gaussian(float sigma) {
  std::vector<float> weights;
  for (int off = 0; off <= static_cast<int>(2.0f * sigma + 0.5f); ++off)
    weights.push_back(std::exp(-0.5f * static_cast<float>(off * off) / (sigma * sigma)));
  return weights;
}

}  // namespace

Image<float> smoothed_thickness(const Image<float>& thickness, float sigma, float spacing) {
  if (!(sigma >= 0.5f)) return thickness;
  const std::vector<float> weights = gaussian(sigma);
  return pass(pass(thickness, weights, spacing, true), weights, spacing, false);
}

Image<float> blurred(const Image<float>& picture, float sigma) {
  if (!(sigma >= 0.2f)) return picture;
  // A narrow one has three taps, by its variance: a Gaussian that is cut there is too narrow by a fifth.
  const float variance = sigma * sigma;
  const std::vector<float> weights =
      variance < 0.55f ? std::vector<float>{1.0f, 0.5f * variance / (1.0f - variance)} : gaussian(sigma);
  return pass(pass(picture, weights, 0.0f, true), weights, 0.0f, false);
}

}  // namespace meniscus
#endif
