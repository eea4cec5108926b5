// Height fields from pictures and from other surfaces.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "surface/height_field_axes.h"
#include "surface/height_field_grid.h"

namespace meniscus {

HeightField height_field(const Image<float>& picture, Axis up, const Bounds& region, float smoothing) {
  const auto fail = [](std::string problem, std::string expected, std::string found) {
    throw Error(ErrorCode::invalid_argument,
                ErrorDetail{std::move(problem), std::move(expected), std::move(found), {}, {}, {}, {}});
  };
  if (picture.width() < 2 || picture.height() < 2)
    fail("a picture of heights is too small", "2 x 2 pixels or more",
         fmt::format("{} x {}", picture.width(), picture.height()));
  if (!(smoothing >= 0) || !std::isfinite(smoothing))
    fail("the smoothing is out of range", "0 m or more", fmt::format("{} m", smoothing));
  const FieldAxes axes(up);
  const vec3 extent = region.high - region.low;
  HeightField field = blank_field(up, region, std::max(extent[axes.a], extent[axes.b]));
  field.step = {extent[axes.a] / static_cast<float>(picture.width() - 1),
                extent[axes.b] / static_cast<float>(picture.height() - 1)};
  field.height = Image<float>(picture.width(), picture.height());
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      const float value = picture(x, y);
      if (!std::isfinite(value))
        fail("a picture of heights has a pixel that is no number", "finite values",
             fmt::format("{} at ({}, {})", value, x, y));
      field.height(x, picture.height() - 1 - y) = field.floor + value * extent[axes.up];
    }
  smooth_heights(field, smoothing);
  find_normals(field);
  return field;
}

HeightField height_field_of(const Surface& surface, Axis up, const Bounds& region, float step) {
  HeightField field = blank_field(up, region, step);
  field.spacing = surface.spacing();
  find_normals(field);
  const Bounds water = surface.bounds();
  if (water.empty()) return field;
  const FieldAxes axes(up);
  // From the region's upper end, or above the water where that is lower.
  const int width = field.height.width(), height = field.height.height();
  const float level = std::min(region.high[axes.up], water.high[axes.up] + 4 * std::max(field.step.x, field.step.y));
  const vec3 middle = field.point(0.5f * static_cast<float>(width - 1), 0.5f * static_cast<float>(height - 1), level);
  // One pixel a column, the longer step giving the size; points of the border are looked at just within it.
  const float pixel = std::max(field.step.x, field.step.y);
  const auto pixels = [&](int count, float each) {
    return std::max(static_cast<int>(std::ceil(static_cast<float>(count) * each / pixel)), 1) + 1;
  };
  const vec3 along_b = direction_of(static_cast<Axis>(axes.b));
  int picture_width = pixels(width, field.step.x), picture_height = pixels(height, field.step.y);
  const View view = orthographic_view(middle, middle - direction_of(up), along_b,
                                      pixel * static_cast<float>(picture_height), picture_width, picture_height);
  std::vector<vec2> points;
  points.reserve(field.height.size());
  const float edge = 1e-3f;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const vec3 at = view.project(
          field.point(std::clamp(static_cast<float>(i), edge, static_cast<float>(width - 1) - edge),
                      std::clamp(static_cast<float>(j), edge, static_cast<float>(height - 1) - edge), level));
      points.emplace_back(at.x, at.y);
    }
  const SurfaceBuffers seen = surface.see(view, points);
  const bool coloured = seen.colour.size() == field.height.size();
  if (coloured) field.colour = Image<vec3>(width, height, vec3{0.0f});
  for (std::size_t i = 0; i < field.height.size(); ++i) {
    const float depth = seen.depth[i];
    if (!(depth < std::numeric_limits<float>::infinity()) || level - depth < field.floor) continue;
    field.height[i] = level - depth;
    if (coloured) field.colour[i] = seen.colour[i];
  }
  // Normals of the picture are of the very surface; of sides and of the cut face they are none of the heights.
  find_normals(field);
  for (std::size_t i = 0; i < field.height.size(); ++i) {
    if (!(seen.depth[i] > 0) || !(field.height[i] >= field.floor) || seen.normal.size() != field.height.size())
      continue;
    if (seen.normal[i][axes.up] > 0.2f) field.normal[i] = seen.normal[i];
  }
  return field;
}

}  // namespace meniscus
