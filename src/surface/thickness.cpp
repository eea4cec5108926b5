#include "surface/thickness.h"

#include <glm/geometric.hpp>

#include "surface/thickness_filter.h"
#include "surface/thickness_water.h"

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

/// between() at all pixels.
Image<float> enlarged(const Image<float>& coarse, int stride, int width, int height) {
  Image<float> full(width, height);
  const auto place = [&](int pixel, int count) {
    return std::clamp((static_cast<float>(pixel) + 0.5f) / static_cast<float>(stride) - 0.5f, 0.0f,
                      static_cast<float>(count - 1));
  };
  std::vector<int> column(static_cast<std::size_t>(width));
  std::vector<float> fraction(column.size());
  for (int x = 0; x < width; ++x) {
    const float u = place(x, coarse.width());
    column[static_cast<std::size_t>(x)] = static_cast<int>(u);
    fraction[static_cast<std::size_t>(x)] = u - static_cast<float>(static_cast<int>(u));
  }
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<float> row(static_cast<std::size_t>(coarse.width()) + 1);
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const float v = place(y, coarse.height());
      const int y0 = static_cast<int>(v), y1 = std::min(y0 + 1, coarse.height() - 1);
      const float fv = v - static_cast<float>(y0);
      for (int x = 0; x < coarse.width(); ++x)
        row[static_cast<std::size_t>(x)] = (1 - fv) * coarse(x, y0) + fv * coarse(x, y1);
      row.back() = row[row.size() - 2];
      float* to = full.row(y);
      for (std::size_t x = 0; x < column.size(); ++x) {
        const float* from = &row[static_cast<std::size_t>(column[x])];
        to[x] = (1 - fraction[x]) * from[0] + fraction[x] * from[1];
      }
    }
  });
  return full;
}

}  // namespace

Image<float> splatted_thickness(const BandGrid& grid, float spacing, const View& view, std::span<const vec2> points) {
  return splatted_thickness(CountedCells(grid, spacing, grid.counted()), spacing, view, points);
}

Image<float> splatted_thickness(const CountedCells& counted, float spacing, const View& view,
                                std::span<const vec2> points) {
  const BandGrid& grid = counted.grid();
  return thickness_by_sums({grid.bounds(), grid.counted(), spacing}, view, points, [&](const SplatCamera& camera) {
    return summed_water(counted, spacing, camera, {grid.counted()});
  });
}

Image<float> thickness_by_sums(const WaterBody& water, const View& view, std::span<const vec2> points,
                               const std::function<Image<float>(const SplatCamera&)>& sum) {
  // Three samples in two spacings in the middle of the water.
  const float spacing = water.spacing;
  const float middle = std::max(glm::dot(water.bounds.centre() - view.eye, view.forward), spacing);
  const float spacing_px = spacing / view.pixel_size(middle);
  const int stride = water.count == 0 ? 1 : std::clamp(static_cast<int>(spacing_px / 1.3f + 0.5f), 1, 8);
  const float spacing_samples = spacing_px / static_cast<float>(stride);
  const Image<float> sums = sum(SplatCamera(view, stride));
  // Variance along an axis: that of a sphere's water (radius^2 / 5) less that of the spreading over four samples.
  const float radius = kThicknessRadius * spacing_samples;
  const float spread =
      water.count <= kAllSpheres ? 0.0f : std::sqrt(std::max(radius * radius / 5.0f - 1.0f / 6.0f, 0.0f));
  const Image<float> smooth =
      smoothed_thickness(blurred(sums, std::min(spread, 1.0f)), std::min(spacing_samples, 4.0f), spacing);
  if (!points.empty()) {
    Image<float> values(static_cast<int>(points.size()), 1);
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = between(smooth, stride, points[i].x, points[i].y);
    return values;
  }
  return stride == 1 ? smooth : enlarged(smooth, stride, view.width, view.height);
}

Image<float> sampled_picture(const Image<float>& picture, std::span<const vec2> points) {
  Image<float> values(static_cast<int>(points.size()), 1);
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = between(picture, 1, points[i].x, points[i].y);
  return values;
}

}  // namespace meniscus
