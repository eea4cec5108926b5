#include "render/rain_puddles.h"

#include <algorithm>
#include <cmath>

#include "base/field_axes.h"
#include "render/rain_ground.h"

namespace meniscus {
namespace {

constexpr float kNone = -std::numeric_limits<float>::infinity();
constexpr float kUnder = 0.01f;  ///< m that the water's floor is under the lowest ground
/// Waves are no higher than this part of the water under them is deep: a shore does not move.
constexpr float kHighest = 0.5f;

/// Place of a cell's middle along a and b.
vec2 place_of(const WetGround& ground, const FieldAxes& axes, std::size_t cell) {
  const vec3 place = ground.place(cell);
  return {place[axes.a], place[axes.b]};
}

}  // namespace

HeightField puddle_field(const WetGround& ground, const Ripples* ripples) {
  const GroundOptions& options = ground.options();
  const FieldAxes axes(options.up);
  const PuddleLevels puddles(ground);
  const std::vector<float>& levels = puddles.cells();
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
  // Just under the ground: rays in the water look no further.
  field.floor = std::min(lowest, lowest_bed(ground)) - kUnder;
  field.height = Image<float>(end_x - begin_x, end_y - begin_y, kNone);
  const std::span<const float> waves = ripples ? ripples->heights() : std::span<const float>();
  parallel_for(static_cast<std::size_t>(field.height.height()), 16, [&](std::size_t from, std::size_t until) {
    for (int y = static_cast<int>(from); y < static_cast<int>(until); ++y)
      for (int x = 0; x < field.height.width(); ++x) {
        const vec2 place = field.low + step * vec2(x, y);
        float& level = field.height(x, y);
        level = puddles.level(place);
        if (!(level > kNone) || !ripples || x + begin_x >= ripples->width() || y + begin_y >= ripples->height())
          continue;
        const float highest = kHighest * std::max(level - puddles.bed(place), 0.0f);
        level += std::clamp(waves[static_cast<std::size_t>(x + begin_x) +
                                  static_cast<std::size_t>(ripples->width()) * static_cast<std::size_t>(y + begin_y)],
                            -highest, highest);
      }
  });
  find_normals(field);
  return field;
}

std::vector<float> puddle_depths(const WetGround& ground, const Ripples& ripples) {
  const GroundOptions& cells = ground.options();
  const RippleOptions& points = ripples.options();
  const auto width = static_cast<std::size_t>(ripples.width()), height = static_cast<std::size_t>(ripples.height());
  // The cell of each point along one axis; none: -1.
  const auto along = [&](std::size_t count, float low, float cells_low, int cells_along) {
    std::vector<std::ptrdiff_t> cell(count, -1);
    for (std::size_t i = 0; i < count; ++i) {
      const double place =
          (static_cast<double>(low + points.step * static_cast<float>(i)) - static_cast<double>(cells_low)) /
          static_cast<double>(cells.cell);
      if (place >= 0 && place <= cells_along) cell[i] = std::min(static_cast<int>(place), cells_along - 1);
    }
    return cell;
  };
  const std::vector<std::ptrdiff_t> columns = along(width, points.low.x, cells.low.x, ground.width());
  const std::vector<std::ptrdiff_t> rows = along(height, points.low.y, cells.low.y, ground.height());
  std::vector<float> depths(width * height);
  parallel_for(height, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t i = 0; i < width; ++i) {
        if (columns[i] < 0 || rows[j] < 0) continue;
        const double depth = ground.depth(static_cast<std::size_t>(columns[i] + rows[j] * ground.width()));
        if (depth > kPuddle) depths[i + width * j] = static_cast<float>(depth);
      }
  });
  return depths;
}

}  // namespace meniscus
