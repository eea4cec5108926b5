#include "surface/thickness.h"

#include <glm/geometric.hpp>

#include "surface/splat.h"
#include "surface/thickness_filter.h"

namespace meniscus {
namespace {

/// Bilinear between the centres of blocks of stride x stride pixels.
float between(const Image<float>& coarse, int stride, float x, float y) {
  const float u = std::clamp(x / static_cast<float>(stride) - 0.5f, 0.0f, static_cast<float>(coarse.width() - 1));
  const float v = std::clamp(y / static_cast<float>(stride) - 0.5f, 0.0f, static_cast<float>(coarse.height() - 1));
  const int x0 = static_cast<int>(u), y0 = static_cast<int>(v);
  const int x1 = std::min(x0 + 1, coarse.width() - 1), y1 = std::min(y0 + 1, coarse.height() - 1);
  const float fu = u - static_cast<float>(x0), fv = v - static_cast<float>(y0);
  return (1 - fv) * ((1 - fu) * coarse(x0, y0) + fu * coarse(x1, y0)) +
         fv * ((1 - fu) * coarse(x0, y1) + fu * coarse(x1, y1));
}

}  // namespace

Image<float> splatted_thickness(const BandGrid& grid, float spacing, const View& view,
                                std::span<const vec2> points) {
  const float radius = 1.25f * spacing;  // thickness_radius() of raycast_field.h
  const float weight = spacing * spacing * spacing / (4.0f / 3.0f * 3.14159265f * radius * radius * radius);
  // One to two samples a spacing in the middle of the water.
  const float middle = std::max(glm::dot(grid.bounds().centre() - view.eye, view.forward), spacing);
  const float spacing_px = spacing / view.pixel_size(middle);
  const int stride = grid.size() == 0 ? 1 : std::clamp(static_cast<int>(spacing_px / 1.4f), 1, 8);
  // Particles of deep cells are known by their number only: spread them over the cell.
  std::vector<float> x(grid.x(), grid.x() + grid.size()), y(grid.y(), grid.y() + grid.size()),
      z(grid.z(), grid.z() + grid.size());
  for (int block = 0; block < grid.blocks() && grid.has_deep(); ++block)
    for (int cell = 0; cell < BandGrid::kCells; ++cell) {
      if (grid.kinds(block)[cell] != BandGrid::deep) continue;
      for (std::uint32_t k = 0; k < grid.counts(block)[cell]; ++k) {
        const vec3 in_cell =
            vec3(cell % 8, cell / 8 % 8, cell / 64) + 0.25f + 0.5f * vec3(k & 1, k >> 1 & 1, k >> 2 & 1);
        const vec3 at = grid.low(block) + grid.cell_size() * in_cell;
        x.push_back(at.x);
        y.push_back(at.y);
        z.push_back(at.z);
      }
    }
  const Image<float> coarse = splat_chords(view, {x, y, z, {&radius, 1}}, weight, stride);
  const Image<float> smooth =
      smoothed_thickness(coarse, std::min(spacing_px / static_cast<float>(stride), 4.0f), spacing);
  if (!points.empty()) {
    Image<float> values(static_cast<int>(points.size()), 1);
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = between(smooth, stride, points[i].x, points[i].y);
    return values;
  }
  if (stride == 1) return smooth;
  Image<float> full(view.width, view.height);
  parallel_for(static_cast<std::size_t>(view.height), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (int x = 0; x < view.width; ++x)
        full(x, static_cast<int>(y)) =
            between(smooth, stride, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  });
  return full;
}

Image<float> sampled_picture(const Image<float>& picture, std::span<const vec2> points) {
  Image<float> values(static_cast<int>(points.size()), 1);
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = between(picture, 1, points[i].x, points[i].y);
  return values;
}

}  // namespace meniscus
