// Smoothing of heights, and sheets over what is not known.
#include <algorithm>
#include <cmath>

#include "surface/height_field_grid.h"

namespace meniscus {
namespace {

constexpr float kDry = -std::numeric_limits<float>::infinity();
constexpr int kRelaxations = 24;

/// One pass along a line of `count` heights that lie `stride` apart.
void smooth_line(const float* from, float* to, int count, std::ptrdiff_t stride, std::span<const float> weights) {
  for (int i = 0; i < count; ++i) {
    const float here = from[i * stride];
    if (!(here > kDry)) {
      to[i * stride] = kDry;
      continue;
    }
    const int reach = std::min({static_cast<int>(weights.size()) - 1, i, count - 1 - i});
    // Differences, so that a plane is kept to the last bit but for rounding.
    float sum = 0, total = weights[0];
    for (int k = 1; k <= reach; ++k) {
      const float before = from[(i - k) * stride], after = from[(i + k) * stride];
      if (!(before > kDry) || !(after > kDry)) break;
      const float weight = weights[static_cast<std::size_t>(k)];
      sum += weight * ((before - here) + (after - here));
      total += 2 * weight;
    }
    to[i * stride] = here + sum / total;
  }
}

std::vector<float> gaussian(float sigma_steps) {
  std::vector<float> weights{1.0f};
  for (int k = 1; static_cast<float>(k) <= 3 * sigma_steps && k < 4096; ++k) {
    const float x = static_cast<float>(k) / sigma_steps;
    weights.push_back(std::exp(-0.5f * x * x));
  }
  return weights;
}

/// Known heights at one resolution: mean of those that are water, how many are known, and how many of these are water.
struct Layer {
  int width = 0, height = 0;
  std::vector<float> level, known, wet;
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

Layer coarser(const Layer& fine) {
  Layer coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}, {}, {}};
  const std::size_t size = static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height);
  coarse.level.assign(size, 0.0f);
  coarse.known.assign(size, 0.0f);
  coarse.wet.assign(size, 0.0f);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t to = coarse.index(x / 2, y / 2), from = fine.index(x, y);
      coarse.level[to] += fine.wet[from] * fine.level[from];
      coarse.wet[to] += fine.wet[from];
      coarse.known[to] += fine.known[from];
    }
  for (std::size_t i = 0; i < size; ++i) {
    if (coarse.wet[i] > 0) coarse.level[i] /= coarse.wet[i];
    // Near ones count: a block says as much as one known point at most.
    const float most = std::min(1.0f, 1.0f / std::max(coarse.known[i], 1e-20f));
    coarse.wet[i] *= most;
    coarse.known[i] *= most;
  }
  return coarse;
}

/// Gives what is not known at a resolution the values between those of the next coarser one.
void take_from(const Layer& coarse, Layer& fine) {
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t i = fine.index(x, y);
      const float missing = 1 - fine.known[i];
      if (!(missing > 0)) continue;
      const float u = std::clamp(0.5f * static_cast<float>(x) - 0.25f, 0.0f, static_cast<float>(coarse.width - 1));
      const float v = std::clamp(0.5f * static_cast<float>(y) - 0.25f, 0.0f, static_cast<float>(coarse.height - 1));
      const int x0 = static_cast<int>(u), y0 = static_cast<int>(v);
      float level = 0, wet = 0, known = 0;
      for (int q = y0; q <= std::min(y0 + 1, coarse.height - 1); ++q)
        for (int p = x0; p <= std::min(x0 + 1, coarse.width - 1); ++p) {
          const float weight = (1 - std::abs(u - static_cast<float>(p))) * (1 - std::abs(v - static_cast<float>(q)));
          const std::size_t from = coarse.index(p, q);
          level += weight * coarse.wet[from] * coarse.level[from];
          wet += weight * coarse.wet[from];
          known += weight * coarse.known[from];
        }
      if (!(known > 0)) continue;
      const float scale = missing / known;
      const float here = fine.wet[i] * fine.level[i] + scale * level;
      fine.wet[i] += scale * wet;
      if (fine.wet[i] > 0) fine.level[i] = here / fine.wet[i];
      fine.known[i] = 1;
    }
}

/// Towards the mean of the neighbours, in the unknown only: no edges where the sheet begins.
void relax(Image<float>& height, const Image<std::uint8_t>& unknown) {
  std::vector<std::pair<int, int>> places;
  for (int y = 0; y < height.height(); ++y)
    for (int x = 0; x < height.width(); ++x)
      if (unknown(x, y) && height(x, y) > kDry) places.emplace_back(x, y);
  std::vector<float> next(places.size());
  for (int round = 0; round < kRelaxations; ++round) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto [x, y] = places[i];
      float sum = 0;
      int count = 0;
      const auto add = [&](int p, int q) {
        if (p < 0 || q < 0 || p >= height.width() || q >= height.height() || !(height(p, q) > kDry)) return;
        sum += height(p, q);
        ++count;
      };
      add(x - 1, y), add(x + 1, y), add(x, y - 1), add(x, y + 1);
      next[i] = count > 0 ? sum / static_cast<float>(count) : height(x, y);
    }
    for (std::size_t i = 0; i < places.size(); ++i) height(places[i].first, places[i].second) = next[i];
  }
}

}  // namespace

void smooth_heights(HeightField& field, float sigma) {
  if (!(sigma > 0) || field.empty()) return;
  const int width = field.height.width(), height = field.height.height();
  const std::vector<float> along_a = gaussian(sigma / field.step.x), along_b = gaussian(sigma / field.step.y);
  Image<float> between(width, height);
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
      smooth_line(field.height.row(j), between.row(j), width, 1, along_a);
  });
  parallel_for(static_cast<std::size_t>(width), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      smooth_line(between.data() + i, field.height.data() + i, height, width, along_b);
  });
}

void fill_unknown(Image<float>& height, const Image<std::uint8_t>& unknown) {
  if (std::find_if(unknown.begin(), unknown.end(), [](std::uint8_t u) { return u != 0; }) == unknown.end()) return;
  std::vector<Layer> layers(1);
  Layer& first = layers[0];
  first.width = height.width();
  first.height = height.height();
  first.level.resize(height.size());
  first.known.resize(height.size());
  first.wet.resize(height.size());
  for (std::size_t i = 0; i < height.size(); ++i) {
    const bool wet = !unknown[i] && height[i] > kDry;
    first.level[i] = wet ? height[i] : 0.0f;
    first.wet[i] = wet ? 1.0f : 0.0f;
    first.known[i] = unknown[i] ? 0.0f : 1.0f;
  }
  while (layers.back().width > 1 || layers.back().height > 1) layers.push_back(coarser(layers.back()));
  for (std::size_t l = layers.size() - 1; l > 0; --l) take_from(layers[l], layers[l - 1]);
  for (std::size_t i = 0; i < height.size(); ++i)
    if (unknown[i]) height[i] = layers[0].wet[i] >= 0.5f ? layers[0].level[i] : kDry;
  relax(height, unknown);
}

}  // namespace meniscus
