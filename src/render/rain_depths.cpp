#include "render/rain_depths.h"

#include <algorithm>
#include <cmath>

#include "base/field_axes.h"
#include "render/inside_solids.h"

namespace meniscus {
namespace {

constexpr float kClosest = 0.02f;  ///< m between places that are looked at
constexpr float kOver = 0.01f;     ///< m over the highest water, where rays down to it start

}  // namespace

std::vector<float> water_depths(const Ripples& ripples, const Surface& water, const Scene& scene, float deepest) {
  const auto width = static_cast<std::size_t>(ripples.width()), height = static_cast<std::size_t>(ripples.height());
  const FieldAxes axes(ripples.options().up);
  const auto stride = static_cast<std::size_t>(std::max(std::lround(kClosest / ripples.options().step), 1l));
  const std::size_t across = (width + stride - 1) / stride, along = (height + stride - 1) / stride;
  const InsideSolids solids(scene);
  const float top = water.bounds().high[axes.up] + kOver;
  const vec3 down = axes.place(0, 0, -1);
  std::vector<float> looked(across * along);
  // Of every place the point in its middle.
  parallel_for(along, 4, [&](std::size_t begin, std::size_t end) {
    std::vector<Ray> rays(across);
    std::vector<float> from(across), limits(across, kOver + water.bounds().extent()[axes.up] + kOver), grounds(across);
    const std::vector<std::uint8_t> outside(across, 0);
    std::vector<Crossing> found(across);
    for (std::size_t j = begin; j < end; ++j) {
      for (std::size_t i = 0; i < across; ++i)
        rays[i] = {ripples.place(static_cast<int>(std::min(i * stride + stride / 2, width - 1)),
                                 static_cast<int>(std::min(j * stride + stride / 2, height - 1)), top),
                   down};
      std::fill(from.begin(), from.end(), 0.0f);
      std::fill(found.begin(), found.end(), Crossing{});
      water.crossings(rays, from, limits, outside, found);
      for (std::size_t i = 0; i < across; ++i)
        if (std::isfinite(found[i].distance)) rays[i].origin += found[i].distance * down;
      scene.distances(rays, grounds);
      for (std::size_t i = 0; i < across; ++i)
        looked[i + across * j] = !std::isfinite(found[i].distance) ? deepest
                                 : solids.holds(rays[i].origin)    ? 0.0f
                                                                   : std::min(grounds[i], deepest);
    }
  });
  std::vector<float> depths(width * height);
  for (std::size_t j = 0; j < height; ++j)
    for (std::size_t i = 0; i < width; ++i) depths[i + width * j] = looked[i / stride + across * (j / stride)];
  return depths;
}

}  // namespace meniscus
