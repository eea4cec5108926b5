/// Number, materials and heights of the ground's cells.
#include "sim/ground_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/ground_constants.h"

namespace meniscus {
namespace {

constexpr float kFar = 1e6f;            ///< m
constexpr double kMostCells = 1 << 26;  ///< 4 GB with all that goes with them
constexpr std::size_t kGrain = 1 << 14;

[[noreturn]] void refuse(std::string problem, std::string expected, std::string found,
                         ErrorCode code = ErrorCode::invalid_argument, std::string advice = {}) {
  throw Error(code, {std::move(problem), std::move(expected), std::move(found), {}, {}, {}, std::move(advice)});
}

/// Where the middle of cell i of a row lies in a picture that is stretched over low .. high, px.
double picture_point(int i, double cell, double extent, int pixels) {
  return (i + 0.5) * cell / extent * static_cast<double>(pixels);
}

/// The two pixels around a point of the picture and how far it is from the first to the second.
struct Between {
  int first, second;
  float part;
};
Between between_pixels(double point, int pixels) {
  const double p = std::clamp(point - 0.5, 0.0, static_cast<double>(pixels - 1));
  const int first = static_cast<int>(p);
  return {first, std::min(first + 1, pixels - 1), static_cast<float>(p - first)};
}

}  // namespace

GroundSize checked_ground_size(const GroundOptions& options) {
  if (static_cast<unsigned>(options.up) > 2u) refuse("the ground's up axis is unknown", "x, y or z", "another value");
  for (int k = 0; k < 2; ++k) {
    const float low = options.low[k], high = options.high[k];
    if (!(std::abs(low) <= kFar && std::abs(high) <= kFar && low < high))
      refuse("the ground has no region", "low < high, within 1e6 m of the origin",
             fmt::format("{:g} to {:g} m", low, high), ErrorCode::invalid_argument,
             "give the region along both horizontal axes");
  }
  if (!(options.cell > 0 && options.cell <= kFar))
    refuse("the ground's cells have no size", "0 < cell <= 1e6 m", fmt::format("{:g} m", options.cell));
  if (!(std::abs(options.level) <= kFar))
    refuse("the ground's level is out of range", "within 1e6 m of the origin", fmt::format("{:g} m", options.level));
  if (!(options.roughness <= 1))  // negative: that of each material
    refuse("the ground's roughness is out of range", "at most 1 m", fmt::format("{:g} m", options.roughness));
  if (!(options.roughness_length > 0 && options.roughness_length <= kFar))
    refuse("the length of the ground's bumps is out of range", "0 < length <= 1e6 m",
           fmt::format("{:g} m", options.roughness_length));
  if (static_cast<std::size_t>(options.material) >= kGroundTraits.size())
    refuse("the ground's material is unknown", "concrete, asphalt or steel",
           fmt::format("number {}", static_cast<int>(options.material)));

  double cells[2];
  for (int k = 0; k < 2; ++k) {
    const double extent = static_cast<double>(options.high[k]) - static_cast<double>(options.low[k]);
    cells[k] = std::max(std::ceil(extent / static_cast<double>(options.cell) - 1e-3), 1.0);  // no sliver by rounding
  }
  if (!(cells[0] * cells[1] <= kMostCells))
    refuse("the ground has too many cells", "at most 2^26", fmt::format("{:.0f} x {:.0f}", cells[0], cells[1]),
           ErrorCode::limit_exceeded, "make the cells larger or the region smaller");
  return {static_cast<int>(cells[0]), static_cast<int>(cells[1])};
}

std::vector<GroundMaterial> ground_materials(const GroundOptions& options, GroundSize size) {
  const auto width = static_cast<std::size_t>(size.width), height = static_cast<std::size_t>(size.height);
  std::vector<GroundMaterial> materials(width * height, options.material);
  const Image<GroundMaterial>& picture = options.materials;
  if (picture.empty()) return materials;
  for (std::size_t i = 0; i < picture.size(); ++i)
    if (static_cast<std::size_t>(picture[i]) >= kGroundTraits.size())
      refuse("the picture of the ground's materials has an unknown one", "concrete, asphalt or steel",
             fmt::format("number {} at pixel {}", static_cast<int>(picture[i]), i));
  const vec2 extent = options.high - options.low;
  for (int j = 0; j < size.height; ++j) {
    const double from_near = picture_point(j, options.cell, extent.y, picture.height());
    const int row = std::clamp(picture.height() - 1 - static_cast<int>(from_near), 0, picture.height() - 1);
    GroundMaterial* to = materials.data() + static_cast<std::size_t>(j) * width;
    for (int i = 0; i < size.width; ++i) {
      const double x = picture_point(i, options.cell, extent.x, picture.width());
      to[i] = picture(std::min(static_cast<int>(x), picture.width() - 1), row);
    }
  }
  return materials;
}

std::vector<float> ground_heights(const GroundOptions& options, GroundSize size,
                                  const std::vector<GroundMaterial>& materials) {
  const Image<float>& picture = options.heights;
  for (std::size_t i = 0; i < picture.size(); ++i)
    if (!(std::abs(picture[i]) <= kFar))
      refuse("a height of the ground is out of range", "within 1e6 m of its level",
             fmt::format("{:g} m at pixel {}", picture[i], i));
  std::vector<float> heights(materials.size(), options.level);
  if (options.roughness != 0) {
    const std::vector<float> bumps = ground_bumps(size, options.cell, options.roughness_length, options.seed);
    for (std::size_t c = 0; c < heights.size(); ++c) {
      const double roughness = options.roughness > 0 ? options.roughness : traits_of(materials[c]).roughness;
      heights[c] += static_cast<float>(roughness) * bumps[c];
    }
  }
  if (picture.empty()) return heights;
  const vec2 extent = options.high - options.low;
  const auto width = static_cast<std::size_t>(size.width);
  parallel_for(static_cast<std::size_t>(size.height), std::max<std::size_t>(kGrain / width, 1),
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t j = begin; j < end; ++j) {
                   const double near = picture_point(static_cast<int>(j), options.cell, extent.y, picture.height());
                   const Between y = between_pixels(picture.height() - near, picture.height());
                   for (std::size_t i = 0; i < width; ++i) {
                     const Between x = between_pixels(
                         picture_point(static_cast<int>(i), options.cell, extent.x, picture.width()), picture.width());
                     const auto along = [&](int row) {
                       const float a = picture(x.first, row), b = picture(x.second, row);
                       return a + (b - a) * x.part;
                     };
                     const float a = along(y.first), b = along(y.second);
                     heights[i + width * j] += a + (b - a) * y.part;
                   }
                 }
               });
  return heights;
}

}  // namespace meniscus
