// The body of water of a height field: its cells and its pyramid.
#include "surface/height_field_body.h"

#include <algorithm>
#include <cmath>

#include "surface/height_field_axes.h"

namespace meniscus {
namespace {

constexpr float kDry = -std::numeric_limits<float>::infinity();

}  // namespace

HeightFieldBody::HeightFieldBody(const HeightField& field) {
  const FieldAxes axes(field.up);
  frame_ = {axes.a, axes.b, axes.up, 0, 0, 1, 1};
  floor_ = top_ = field.floor;
  if (field.empty()) return;
  frame_.low_a = static_cast<double>(field.low.x);
  frame_.low_b = static_cast<double>(field.low.y);
  frame_.per_a = 1.0 / static_cast<double>(field.step.x);
  frame_.per_b = 1.0 / static_cast<double>(field.step.y);
  cells_a_ = field.height.width() - 1;
  cells_b_ = field.height.height() - 1;
  heights_.assign(field.height.begin(), field.height.end());
  water_.resize(heights_.size());
  for (std::size_t i = 0; i < heights_.size(); ++i) water_[i] = heights_[i] > kDry;
  holes_ = std::find(water_.begin(), water_.end(), 0) != water_.end();
  if (holes_) fill_beside_water();
  make_cells();
  make_levels();
  top_ = std::max(levels_.back().blocks[0].high, floor_);
}

void HeightFieldBody::fill_beside_water() {
  const int width = cells_a_ + 1, height = cells_b_ + 1;
  const auto index = [&](int i, int j) {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i);
  };
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      if (water_[index(i, j)]) continue;
      double sum = 0;
      int count = 0;
      for (int y = std::max(j - 1, 0); y <= std::min(j + 1, height - 1); ++y)
        for (int x = std::max(i - 1, 0); x <= std::min(i + 1, width - 1); ++x)
          if (water_[index(x, y)]) {
            sum += static_cast<double>(heights_[index(x, y)]);
            ++count;
          }
      if (count > 0) heights_[index(i, j)] = static_cast<float>(sum / count);
    }
}

void HeightFieldBody::make_cells() {
  kinds_.resize(static_cast<std::size_t>(cells_a_) * static_cast<std::size_t>(cells_b_));
  const auto width = static_cast<std::size_t>(cells_a_) + 1;
  for (int j = 0; j < cells_b_; ++j)
    for (int i = 0; i < cells_a_; ++i) {
      const std::size_t p = static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i);
      const int wet = water_[p] + water_[p + 1] + water_[p + width] + water_[p + width + 1];
      kinds_[cell_index(i, j)] = wet == 4 ? full : wet == 0 ? dry : cut;
    }
}

void HeightFieldBody::make_levels() {
  const auto width = static_cast<std::size_t>(cells_a_) + 1;
  Level level{cells_a_, cells_b_, {}};
  level.blocks.resize(kinds_.size());
  for (int j = 0; j < cells_b_; ++j)
    for (int i = 0; i < cells_a_; ++i) {
      const std::size_t p = static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i);
      const auto [low, high] =
          std::minmax({heights_[p], heights_[p + 1], heights_[p + width], heights_[p + width + 1]});
      const Kind kind = kinds_[cell_index(i, j)];
      level.blocks[cell_index(i, j)] = {kind == full ? low : kDry, kind == dry ? kDry : high};
    }
  levels_.push_back(std::move(level));
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const Level& fine = levels_.back();
    Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
    coarse.blocks.resize(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height));
    for (int y = 0; y < coarse.height; ++y)
      for (int x = 0; x < coarse.width; ++x) {
        Block block{-kDry, kDry};
        for (int v = 2 * y; v < std::min(2 * y + 2, fine.height); ++v)
          for (int u = 2 * x; u < std::min(2 * x + 2, fine.width); ++u) {
            const Block& part = fine.blocks[static_cast<std::size_t>(v) * static_cast<std::size_t>(fine.width) +
                                            static_cast<std::size_t>(u)];
            block = {std::min(block.low, part.low), std::max(block.high, part.high)};
          }
        coarse.blocks[static_cast<std::size_t>(y) * static_cast<std::size_t>(coarse.width) +
                      static_cast<std::size_t>(x)] = block;
      }
    levels_.push_back(std::move(coarse));
  }
}

}  // namespace meniscus
