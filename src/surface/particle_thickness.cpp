#include "surface/particle_thickness.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "surface/splat_camera.h"
#include "surface/thickness.h"
#include "surface/thickness_canvas.h"
#include "surface/thickness_filter.h"
#include "surface/thickness_water.h"

namespace meniscus {
namespace {

/// A particle whose spacing is at most so many samples is a point, as in summed_water().
constexpr float kWidestPoint = 3.0f;
constexpr std::size_t kMostPieces = 4, kPieceParticles = 100000, kRun = 1024;

/// Adds the particles [begin, end): those that are small in the picture as points.
void add(const Particles& particles, std::size_t begin, std::size_t end, float spacing, const SplatCamera& camera,
         ThicknessCanvas& canvas) {
  const float radius = kThicknessRadius * spacing, volume = spacing * spacing * spacing;
  const float weight = volume / (4.0f / 3.0f * 3.14159265f * radius * radius * radius);
  float x[kRun], y[kRun], z[kRun];
  for (std::size_t first = begin; first < end; first += kRun) {
    std::size_t count = 0;
    for (std::size_t i = first; i < std::min(first + kRun, end); ++i) {
      const vec3 at = particles.position(i);
      const float near = glm::dot(at - camera.eye, camera.forward) - radius;
      const float width = camera.perspective ? near * camera.du : camera.du;
      if (near > 0.0f && spacing <= kWidestPoint * width) {
        x[count] = at.x;
        y[count] = at.y;
        z[count++] = at.z;
      } else {
        add_sphere(camera, at, radius, weight, canvas);
      }
    }
    if (count > 0) add_points(camera, x, y, z, count, volume, canvas);
  }
}

}  // namespace

Image<float> particle_thickness(const Particles& particles, float spacing, const View& view,
                                std::span<const vec2> points) {
  const float middle = std::max(glm::dot(particles.bounds().centre() - view.eye, view.forward), spacing);
  const float spacing_px = particles.empty() ? 0.0f : spacing / view.pixel_size(middle);
  // Three samples in two spacings in the middle of the water, as in splatted_thickness().
  const int stride = std::clamp(static_cast<int>(spacing_px / 1.3f + 0.5f), 1, 8);
  const float spacing_samples = spacing_px / static_cast<float>(stride);
  const SplatCamera camera(view, stride);
  const std::size_t pieces = std::clamp<std::size_t>(particles.size() / kPieceParticles, 1, kMostPieces);
  std::vector<ThicknessCanvas> canvases(pieces);
  parallel_for(pieces, 1, [&](std::size_t piece, std::size_t) {
    SampleRect all;
    all.x0 = all.y0 = 0;
    all.x1 = static_cast<std::uint16_t>(camera.width - 1);
    all.y1 = static_cast<std::uint16_t>(camera.height - 1);
    canvases[piece].start(all);
    add(particles, particles.size() * piece / pieces, particles.size() * (piece + 1) / pieces, spacing, camera,
        canvases[piece]);
  });
  Image<float> sums(camera.width, camera.height, 0.0f);
  for (int row = 0; row < camera.height; ++row)
    for (const ThicknessCanvas& canvas : canvases)
      for (int column = 0; column < camera.width; ++column) sums(column, row) += canvas.row(row)[column];
  // Variance along an axis: that of a sphere's water less that of the spreading over four samples.
  const float radius = kThicknessRadius * spacing_samples;
  const float spread =
      spacing_samples <= kWidestPoint ? std::sqrt(std::max(radius * radius / 5.0f - 1.0f / 6.0f, 0.0f)) : 0.0f;
  const Image<float> smooth =
      smoothed_thickness(blurred(sums, std::min(spread, 1.0f)), std::min(spacing_samples, 4.0f), spacing);
  const float samples = 1.0f / static_cast<float>(stride);
  std::vector<vec2> places(points.begin(), points.end());
  for (vec2& place : places) place *= samples;
  if (!points.empty()) return sampled_picture(smooth, places);
  if (stride == 1) return smooth;
  Image<float> full(view.width, view.height);
  places.resize(static_cast<std::size_t>(view.width));
  for (int row = 0; row < view.height; ++row) {
    for (std::size_t i = 0; i < places.size(); ++i)
      places[i] = samples * vec2{static_cast<float>(i) + 0.5f, static_cast<float>(row) + 0.5f};
    const Image<float> values = sampled_picture(smooth, places);
    std::copy_n(values.row(0), view.width, full.row(row));
  }
  return full;
}

}  // namespace meniscus
