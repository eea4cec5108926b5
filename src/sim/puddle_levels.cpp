#include "sim/puddle_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meniscus {
namespace {

constexpr float kNone = -std::numeric_limits<float>::infinity();
constexpr int kBeyond = 3;  ///< cells around a puddle that its level goes on for
/// Depth, in parts of kPuddle, that a cell beyond the edge has at most: level water on rising ground has less, running
/// water on an even slope dips under the ground so, and does not end at the edge of a cell.
constexpr float kDeepest[kBeyond] = {1.0f, 0.3f, -0.6f};

/// Whether a cell and those around it have a puddle's depth on average: one heavy drop on a film makes no puddle.
bool in_puddle(const WetGround& ground, std::size_t i, std::size_t j) {
  const auto width = static_cast<std::size_t>(ground.width()), height = static_cast<std::size_t>(ground.height());
  if (!(ground.depth(i + width * j) > kPuddle)) return false;
  double sum = 0;
  int count = 0;
  for (std::size_t y = j > 0 ? j - 1 : j; y <= std::min(j + 1, height - 1); ++y)
    for (std::size_t x = i > 0 ? i - 1 : i; x <= std::min(i + 1, width - 1); ++x) {
      sum += ground.depth(x + width * y);
      ++count;
    }
  return sum > kPuddle * count;
}

/// Level of the water at each cell, m along up; kNone far from puddles.
std::vector<float> levels_of(const WetGround& ground) {
  std::vector<float> levels(ground.size(), kNone);
  const auto width = static_cast<std::size_t>(ground.width()), height = static_cast<std::size_t>(ground.height());
  for (std::size_t j = 0; j < height; ++j)
    for (std::size_t i = 0; i < width; ++i)
      if (in_puddle(ground, i, j))
        levels[i + width * j] = ground.bed(i + width * j) + static_cast<float>(ground.depth(i + width * j));
  // Cells get the mean of their neighbours' levels, ring by ring.
  for (int round = 0; round < kBeyond; ++round) {
    std::vector<float> grown = levels;
    parallel_for(height, 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        const std::size_t first_row = j > 0 ? j - 1 : j, last_row = std::min(j + 1, height - 1);
        const auto from = levels.begin() + static_cast<std::ptrdiff_t>(first_row * width);
        const auto until = levels.begin() + static_cast<std::ptrdiff_t>((last_row + 1) * width);
        if (std::all_of(from, until, [](float level) { return level == kNone; })) continue;
        for (std::size_t i = 0; i < width; ++i) {
          if (levels[i + width * j] > kNone) continue;
          float sum = 0;
          int count = 0;
          for (std::size_t y = first_row; y <= last_row; ++y)
            for (std::size_t x = i > 0 ? i - 1 : i; x <= std::min(i + 1, width - 1); ++x) {
              const float level = levels[x + width * y];
              if (!(level > kNone)) continue;
              sum += level;
              ++count;
            }
          if (count > 0)
            grown[i + width * j] = std::min(sum / static_cast<float>(count),
                                            ground.bed(i + width * j) + kDeepest[round] * static_cast<float>(kPuddle));
        }
      }
    });
    levels.swap(grown);
  }
  return levels;
}

}  // namespace

PuddleLevels::PuddleLevels(const WetGround& ground)
    : cell_(ground.options().cell), width_(ground.width()), height_(ground.height()), levels_(levels_of(ground)) {
  const FieldAxes axes(ground.options().up);
  const vec3 first = ground.place(0);
  first_ = {first[axes.a], first[axes.b]};
  beds_.resize(ground.size());
  for (std::size_t i = 0; i < beds_.size(); ++i) beds_[i] = ground.bed(i);
  for (const float level : levels_) empty_ = empty_ && !(level > kNone);
}

PuddleLevels::Corners PuddleLevels::around(vec2 place) const {
  const float u = std::clamp((place.x - first_.x) / cell_, 0.0f, static_cast<float>(width_ - 1));
  const float v = std::clamp((place.y - first_.y) / cell_, 0.0f, static_cast<float>(height_ - 1));
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const float s = u - static_cast<float>(i), t = v - static_cast<float>(j);
  Corners corners;
  for (int corner = 0; corner < 4; ++corner) {
    const int x = std::min(i + (corner & 1), width_ - 1), y = std::min(j + (corner >> 1), height_ - 1);
    corners.cell[corner] = static_cast<std::size_t>(x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(y);
    corners.weight[corner] = ((corner & 1) ? s : 1 - s) * ((corner >> 1) ? t : 1 - t);
  }
  return corners;
}

float PuddleLevels::level(vec2 place) const {
  if (empty_) return kNone;
  const Corners corners = around(place);
  float sum = 0, weights = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const float level = levels_[corners.cell[corner]];
    if (!(level > kNone)) continue;
    sum += corners.weight[corner] * level;
    weights += corners.weight[corner];
  }
  return weights > 1e-4f ? sum / weights : kNone;
}

float PuddleLevels::bed(vec2 place) const {
  const Corners corners = around(place);
  float sum = 0;
  for (int corner = 0; corner < 4; ++corner) sum += corners.weight[corner] * beds_[corners.cell[corner]];
  return sum;
}

}  // namespace meniscus
