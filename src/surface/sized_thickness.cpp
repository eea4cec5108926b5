#include "surface/sized_thickness.h"

#include <glm/geometric.hpp>

#include "surface/sized_field.h"
#include "surface/splat.h"
#include "surface/thickness.h"
#include "surface/thickness_filter.h"

namespace meniscus {
namespace {

/// Adds one level's thickness to that of the others.
void add_level(const RaycastField& level, const View& view, std::span<const vec2> points, Image<float>& sum) {
  const std::size_t count = level.grid.size();
  const float spacing = level.options.spacing, radius = thickness_radius(level.options);
  std::vector<float> radii(count);
  for (std::size_t i = 0; i < count; ++i) radii[i] = radius / level.per_spacing[i];
  const float weight = spacing * spacing * spacing / (4.0f / 3.0f * 3.14159265f * radius * radius * radius);
  // One to two samples a spacing in the middle of the water.
  const float middle = std::max(glm::dot(level.grid.bounds().centre() - view.eye, view.forward), spacing);
  const float spacing_px = spacing / view.pixel_size(middle);
  const int stride = std::clamp(static_cast<int>(spacing_px / 1.4f), 1, 8);
  const Spheres spheres{{level.grid.x(), count}, {level.grid.y(), count}, {level.grid.z(), count}, radii};
  const Image<float> smooth = smoothed_thickness(splat_chords(view, spheres, weight, stride),
                                                 std::min(spacing_px / static_cast<float>(stride), 4.0f), spacing);
  const float per_stride = 1.0f / static_cast<float>(stride);
  parallel_for(static_cast<std::size_t>(sum.height()), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<vec2> row(static_cast<std::size_t>(sum.width()));
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (std::size_t x = 0; x < row.size(); ++x) {
        const vec2 centre{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
        row[x] = (points.empty() ? centre : points[x]) * per_stride;
      }
      const Image<float> values = sampled_picture(smooth, row);
      for (int x = 0; x < sum.width(); ++x) sum(x, y) += values(x, 0);
    }
  });
}

}  // namespace

Image<float> sized_thickness(const RaycastField& field, const View& view, std::span<const vec2> points) {
  Image<float> sum(points.empty() ? view.width : static_cast<int>(points.size()), points.empty() ? view.height : 1);
  for_each_level(field, [&](const RaycastField& level) { add_level(level, view, points, sum); });
  return sum;
}

}  // namespace meniscus
