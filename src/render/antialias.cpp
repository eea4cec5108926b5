#include "render/antialias.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr int kGrid = 4;  ///< rays along each edge of a pixel
constexpr std::size_t kRays = kGrid * kGrid;
constexpr std::size_t kPixelsAtOnce = 16384;  ///< bounds the memory: about 80 bytes a ray
constexpr float kFoldCosine = 0.819f;         ///< of 35 degrees

/// Whether two neighbouring pixels show different things.
class Differ {
 public:
  /// @param solids  what is seen without the water; null: nothing with edges
  Differ(const View& view, const SurfaceBuffers& buffers, const Image<std::uint8_t>& visible,
         const SceneBuffers* solids, float spacing)
      : view_(view), buffers_(buffers), visible_(visible), solids_(solids), spacing_(spacing) {}

  bool operator()(std::size_t a, std::size_t b, vec3 direction) const {
    const bool water_a = visible_[a] != 0, water_b = visible_[b] != 0;
    if (water_a != water_b) return true;
    if (!water_a) return solids_ && solids_differ(a, b, direction);
    const float depth_a = buffers_.depth[a], depth_b = buffers_.depth[b];
    float slope = 0;  // change of depth over the width of a pixel on the flatter-seen of both surfaces
    if (!buffers_.normal.empty()) {
      const vec3 normal_a = buffers_.normal[a], normal_b = buffers_.normal[b];
      if (glm::dot(normal_a, normal_b) < kFoldCosine) return true;
      const float cosine =
          std::max(0.1f, std::min(std::abs(glm::dot(normal_a, direction)), std::abs(glm::dot(normal_b, direction))));
      slope = std::sqrt(1 - std::min(cosine * cosine, 1.0f)) / cosine;
    }
    const float allowed = 2 * spacing_ + 2 * slope * view_.pixel_size(std::min(depth_a, depth_b));
    return std::abs(depth_a - depth_b) > allowed;
  }

 private:
  /// Edges and outlines of solids, and where they meet.
  bool solids_differ(std::size_t a, std::size_t b, vec3 direction) const {
    const float depth_a = solids_->depth[a], depth_b = solids_->depth[b];
    const bool far_a = depth_a == std::numeric_limits<float>::infinity();
    const bool far_b = depth_b == std::numeric_limits<float>::infinity();
    if (far_a || far_b) return far_a != far_b;
    const vec3 normal = solids_->normal[a];
    if (glm::dot(normal, solids_->normal[b]) < kFoldCosine) return true;
    // Whether b lies on the plane through a, as far as a pixel can tell.
    const float cosine = std::max(0.02f, std::abs(glm::dot(normal, direction)));
    return std::abs(depth_a - depth_b) > 4 * view_.pixel_size(std::min(depth_a, depth_b)) / cosine;
  }

  const View& view_;
  const SurfaceBuffers& buffers_;
  const Image<std::uint8_t>& visible_;  ///< 1 where water is seen
  const SceneBuffers* solids_;
  float spacing_;
};

}  // namespace

std::vector<std::uint32_t> silhouette_pixels(const View& view, const SurfaceBuffers& buffers, const Scene& scene,
                                             float spacing, const SceneBuffers* solids) {
  const Image<float>& coverage = buffers.coverage;
  const std::size_t width = static_cast<std::size_t>(coverage.width());
  const std::size_t height = static_cast<std::size_t>(coverage.height());
  Image<std::uint8_t> marked(coverage.width(), coverage.height());
  Image<std::uint8_t> visible(coverage.width(), coverage.height());
  parallel_for(height, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * width; i < end * width; ++i) {
      if (!(coverage[i] > 0)) continue;
      const Ray ray = view.ray({static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f});
      visible[i] =
          buffers.eye_in_water || (solids ? solids->depth[i] : scene.distance(ray)) >= buffers.depth[i] ? 1 : 0;
    }
  });
  const Differ differ(view, buffers, visible, solids, spacing);
  // A row looks at its neighbours on all sides and marks its own pixels only.
  parallel_for(height, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t i = y * width + x;
        const vec3 direction = view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}).direction;
        marked[i] = (x > 0 && differ(i, i - 1, direction)) || (x + 1 < width && differ(i, i + 1, direction)) ||
                    (y > 0 && differ(i, i - width, direction)) || (y + 1 < height && differ(i, i + width, direction));
      }
  });
  std::vector<std::uint32_t> pixels;
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (marked[i]) pixels.push_back(static_cast<std::uint32_t>(i));
  return pixels;
}

void refine_pixels(const Surface& surface, const View& view, const Scene& scene, const Material& material,
                   const OpticsInputs& optics, std::span<const std::uint32_t> pixels, SurfaceBuffers& buffers,
                   Image<vec3>& radiance) {
  // What refine() looks at must stay as see() returned it, so the means are kept aside until the end.
  std::vector<float> coverage(pixels.size()), thickness(pixels.size());
  const std::size_t width = static_cast<std::size_t>(view.width);
  std::vector<vec2> points;
  for (std::size_t first = 0; first < pixels.size(); first += kPixelsAtOnce) {
    const std::span<const std::uint32_t> batch = pixels.subspan(first, std::min(kPixelsAtOnce, pixels.size() - first));
    points.clear();
    for (const std::uint32_t pixel : batch)
      for (std::size_t k = 0; k < kRays; ++k)
        points.emplace_back(static_cast<float>(pixel % width) + (static_cast<float>(k % kGrid) + 0.5f) / kGrid,
                            static_cast<float>(pixel / width) + (static_cast<float>(k / kGrid) + 0.5f) / kGrid);
    const SurfaceBuffers fine = surface.refine(view, buffers, points);
    const Image<vec3> fine_radiance = shade(view, points, fine, scene, material, optics);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      radiance[batch[i]] = averaged({fine_radiance.data() + i * kRays, kRays});
      for (std::size_t k = 0; k < kRays; ++k) {
        coverage[first + i] += fine.coverage[i * kRays + k] / kRays;
        if (!fine.thickness.empty()) thickness[first + i] += fine.thickness[i * kRays + k] / kRays;
      }
    }
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    buffers.coverage[pixels[i]] = coverage[i];
    if (!buffers.thickness.empty()) buffers.thickness[pixels[i]] = thickness[i];
  }
}

SurfaceBuffers halved(const SurfaceBuffers& fine) {
  const int width = fine.coverage.width() / 2, height = fine.coverage.height() / 2;
  SurfaceBuffers result;
  result.eye_in_water = fine.eye_in_water;
  result.depth = Image<float>(width, height);
  result.coverage = Image<float>(width, height);
  if (!fine.normal.empty()) result.normal = Image<vec3>(width, height);
  if (!fine.thickness.empty()) result.thickness = Image<float>(width, height);
  if (!fine.colour.empty()) result.colour = Image<vec3>(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::array<std::size_t, 4> four;
      for (std::size_t k = 0; k < four.size(); ++k)
        four[k] = (2 * static_cast<std::size_t>(y) + k / 2) * static_cast<std::size_t>(fine.coverage.width()) +
                  2 * static_cast<std::size_t>(x) + k % 2;
      const std::size_t nearest =
          *std::min_element(four.begin(), four.end(), [&](auto a, auto b) { return fine.depth[a] < fine.depth[b]; });
      result.depth(x, y) = fine.depth[nearest];
      if (!fine.normal.empty()) result.normal(x, y) = fine.normal[nearest];
      vec3 colour{0};
      float wet = 0;
      for (const std::size_t i : four) {
        result.coverage(x, y) += fine.coverage[i] / 4;
        if (!fine.thickness.empty()) result.thickness(x, y) += fine.thickness[i] / 4;
        if (!fine.colour.empty() && fine.coverage[i] > 0) colour += fine.colour[i];
        wet += fine.coverage[i] > 0 ? 1.0f : 0.0f;
      }
      if (!fine.colour.empty() && wet > 0) result.colour(x, y) = colour / wet;
    }
  return result;
}

}  // namespace meniscus
