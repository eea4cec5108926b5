#include "render/rain_puddles.h"

#include <algorithm>
#include <cmath>

#include "base/field_axes.h"

namespace meniscus {
namespace {

constexpr float kNone = -std::numeric_limits<float>::infinity();
constexpr int kBeyond = 3;  ///< cells around a puddle that its level goes on for

/// Level of the water at each cell, m along up; kNone far from puddles.
std::vector<float> levels_of(const WetGround& ground) {
  std::vector<float> levels(ground.size(), kNone);
  for (std::size_t i = 0; i < levels.size(); ++i)
    if (ground.depth(i) > kPuddle) levels[i] = ground.bed(i) + static_cast<float>(ground.depth(i));
  const auto width = static_cast<std::size_t>(ground.width()), height = static_cast<std::size_t>(ground.height());
  // Cells get the mean of their neighbours' levels, ring by ring.
  std::vector<std::size_t> ring;
  std::vector<float> found;
  for (int round = 0; round < kBeyond; ++round) {
    ring.clear();
    found.clear();
    for (std::size_t j = 0; j < height; ++j)
      for (std::size_t i = 0; i < width; ++i) {
        const std::size_t cell = i + width * j;
        if (levels[cell] > kNone) continue;
        float sum = 0;
        int count = 0;
        for (std::size_t y = j > 0 ? j - 1 : j; y <= std::min(j + 1, height - 1); ++y)
          for (std::size_t x = i > 0 ? i - 1 : i; x <= std::min(i + 1, width - 1); ++x) {
            const float level = levels[x + width * y];
            if (!(level > kNone)) continue;
            sum += level;
            ++count;
          }
        if (count == 0) continue;
        ring.push_back(cell);
        found.push_back(sum / static_cast<float>(count));
      }
    for (std::size_t k = 0; k < ring.size(); ++k) levels[ring[k]] = found[k];
  }
  return levels;
}

/// Place of a cell's middle along a and b.
vec2 place_of(const WetGround& ground, const FieldAxes& axes, std::size_t cell) {
  const vec3 place = ground.place(cell);
  return {place[axes.a], place[axes.b]};
}

}  // namespace

HeightField puddle_field(const WetGround& ground, const Ripples* ripples) {
  const GroundOptions& options = ground.options();
  const FieldAxes axes(options.up);
  const std::vector<float> levels = levels_of(ground);
  const int width = ground.width(), height = ground.height();
  HeightField field;
  field.up = options.up;
  // The box of all cells with water.
  int low_i = width, low_j = height, high_i = -1, high_j = -1;
  float lowest = std::numeric_limits<float>::infinity();
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const float level =
          levels[static_cast<std::size_t>(i) + static_cast<std::size_t>(width) * static_cast<std::size_t>(j)];
      if (!(level > kNone)) continue;
      low_i = std::min(low_i, i), high_i = std::max(high_i, i);
      low_j = std::min(low_j, j), high_j = std::max(high_j, j);
      lowest = std::min(lowest, level);
    }
  if (high_i < 0) return field;
  const vec2 first = place_of(ground, axes, 0);
  const float cell = options.cell;
  // The points: those of the ripples over that box, or the cells themselves.
  int begin_x = low_i, begin_y = low_j, end_x = high_i + 1, end_y = high_j + 1;
  vec2 origin = first;
  float step = cell;
  if (ripples) {
    step = ripples->options().step;
    const vec3 at = ripples->place(0, 0, 0);
    origin = {at[axes.a], at[axes.b]};
    const auto index = [&](float place, float from) { return static_cast<int>(std::floor((place - from) / step)); };
    begin_x = std::max(index(first.x + static_cast<float>(low_i) * cell, origin.x), 0);
    begin_y = std::max(index(first.y + static_cast<float>(low_j) * cell, origin.y), 0);
    end_x = std::min(index(first.x + static_cast<float>(high_i) * cell, origin.x) + 2, ripples->width());
    end_y = std::min(index(first.y + static_cast<float>(high_j) * cell, origin.y) + 2, ripples->height());
  }
  if (end_x - begin_x < 2 || end_y - begin_y < 2) {  // a lone cell: its neighbours have no water
    begin_x = std::max(begin_x - 1, 0);
    begin_y = std::max(begin_y - 1, 0);
    end_x = std::max(end_x, begin_x + 2);
    end_y = std::max(end_y, begin_y + 2);
  }
  field.low = origin + step * vec2(begin_x, begin_y);
  field.step = vec2(step);
  field.floor = lowest - 1;
  field.height = Image<float>(end_x - begin_x, end_y - begin_y, kNone);
  const std::span<const float> waves = ripples ? ripples->heights() : std::span<const float>();
  parallel_for(static_cast<std::size_t>(field.height.height()), 16, [&](std::size_t from, std::size_t until) {
    for (int y = static_cast<int>(from); y < static_cast<int>(until); ++y)
      for (int x = 0; x < field.height.width(); ++x) {
        const vec2 place = field.low + step * vec2(x, y);
        const float u = std::clamp((place.x - first.x) / cell, 0.0f, static_cast<float>(width - 1));
        const float v = std::clamp((place.y - first.y) / cell, 0.0f, static_cast<float>(height - 1));
        const int i = static_cast<int>(u), j = static_cast<int>(v);
        float sum = 0, weights = 0;
        for (int corner = 0; corner < 4; ++corner) {
          const int ci = std::min(i + (corner & 1), width - 1), cj = std::min(j + (corner >> 1), height - 1);
          const float level =
              levels[static_cast<std::size_t>(ci) + static_cast<std::size_t>(width) * static_cast<std::size_t>(cj)];
          if (!(level > kNone)) continue;
          const float s = u - static_cast<float>(i), t = v - static_cast<float>(j);
          const float weight = ((corner & 1) ? s : 1 - s) * ((corner >> 1) ? t : 1 - t);
          sum += weight * level;
          weights += weight;
        }
        if (!(weights > 1e-4f)) continue;
        float& level = field.height(x, y);
        level = sum / weights;
        if (ripples && x + begin_x < ripples->width() && y + begin_y < ripples->height())
          level += waves[static_cast<std::size_t>(x + begin_x) +
                         static_cast<std::size_t>(ripples->width()) * static_cast<std::size_t>(y + begin_y)];
      }
  });
  find_normals(field);
  return field;
}

std::vector<float> puddle_depths(const WetGround& ground, const Ripples& ripples) {
  const auto width = static_cast<std::size_t>(ripples.width()), height = static_cast<std::size_t>(ripples.height());
  std::vector<float> depths(width * height);
  parallel_for(height, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t i = 0; i < width; ++i) {
        const std::optional<std::size_t> cell =
            ground.cell_at(ripples.place(static_cast<int>(i), static_cast<int>(j), 0));
        if (cell && ground.depth(*cell) > kPuddle) depths[i + width * j] = static_cast<float>(ground.depth(*cell));
      }
  });
  return depths;
}

}  // namespace meniscus
