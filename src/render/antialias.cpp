#include "render/antialias.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>

namespace meniscus {
namespace {

constexpr int kGrid = 4;  ///< rays along each edge of a pixel
constexpr std::size_t kRays = kGrid * kGrid;
constexpr float kFoldCosine = 0.819f;  ///< of 35 degrees

/// The rays of a pixel in the order in which they are drawn: four, one in each row and column of its grid; four more of
/// the kind; the rest.
constexpr std::array<std::size_t, kRays> kInTurn{1, 7, 8, 14, 2, 4, 11, 13, 0, 3, 5, 6, 9, 10, 12, 15};
/// How many are enough where their radiance differs by a part of the largest: one more or less of them then moves the
/// mean by some percent at most, as one of sixteen does on any outline.
struct Enough {
  std::size_t rays;
  float apart;
};
constexpr Enough kEnough[] = {{4, 0.05f}, {8, 0.4f}, {kRays, 1}};
/// All of them, in steps all the same: how broad glitter is follows from one ray of each pixel that is drawn with the
/// others, and is steadier as the mean of three.
constexpr Enough kAll[] = {{4, -1}, {8, -1}, {kRays, 1}};

/// Spacings from which on pixels are wide: their rays are no closer than the surface's own detail.
constexpr float kCoarse = 0.5f, kWide = 4.0f / 3.0f;

/// How wide pixels are, in spacings of the particles; zero where the surface has none.
class PixelWidth {
 public:
  PixelWidth(const Surface& surface, const View& view, const SurfaceBuffers& buffers)
      : view_(view), depth_(buffers.depth), spacing_(surface.height_field() ? 0.0f : surface.spacing()) {
    if (!(spacing_ > 0)) return;
    // Beside the water pixels are as wide as in its middle.
    const vec3 middle = surface.bounds().centre();
    middle_ = surface.bounds().empty() ? 0.0f : glm::dot(middle - view.eye, view.forward);
  }

  float of(std::size_t pixel) const {
    if (!(spacing_ > 0)) return 0.0f;
    const float depth = depth_[pixel] < std::numeric_limits<float>::infinity() ? depth_[pixel] : middle_;
    return view_.pixel_size(std::max(depth, 0.0f)) / spacing_;
  }

 private:
  const View& view_;
  const Image<float>& depth_;
  float spacing_, middle_ = 0;
};

struct PixelMean {
  vec3 radiance{0.0f};
  float coverage = 0, thickness = 0;
};

/// What the rays of one pixel see.
struct Samples {
  std::array<vec3, kRays> radiance;
  std::array<float, kRays> coverage, thickness;

  /// Largest difference between the first rays, as a part of the largest radiance; more where some see no water.
  float apart(std::size_t rays) const {
    vec3 least = radiance[kInTurn[0]], most = least;
    bool mixed = false;
    for (const std::size_t k : std::span(kInTurn).first(rays)) {
      mixed = mixed || coverage[k] != coverage[kInTurn[0]];
      least = glm::min(least, radiance[k]);
      most = glm::max(most, radiance[k]);
    }
    const vec3 difference = most - least;
    const float largest = std::max({most.r, most.g, most.b, 1e-6f});
    return std::max(std::max({difference.r, difference.g, difference.b}) / largest, mixed ? 2 * kEnough[0].apart : 0);
  }

  /// Over the first rays, in the order of the grid.
  PixelMean mean(std::size_t rays) const {
    std::array<std::size_t, kRays> order;
    std::copy_n(kInTurn.begin(), rays, order.begin());
    std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(rays));
    PixelMean mean;
    std::array<vec3, kRays> seen;
    for (std::size_t n = 0; n < rays; ++n) {
      seen[n] = radiance[order[n]];
      mean.coverage += coverage[order[n]] / static_cast<float>(rays);
      mean.thickness += thickness[order[n]] / static_cast<float>(rays);
    }
    mean.radiance = averaged({seen.data(), rays});
    return mean;
  }
};

/// Whether two neighbouring pixels show different things.
class Differ {
 public:
  /// @param solids  what is seen without the water; null: nothing with edges
  Differ(const View& view, const SurfaceBuffers& buffers, const Image<std::uint8_t>& visible,
         const SceneBuffers* solids, float spacing)
      : view_(view), buffers_(buffers), visible_(visible), solids_(solids), spacing_(spacing) {}

  bool operator()(std::size_t a, std::size_t b) const {
    const bool water_a = visible_[a] != 0, water_b = visible_[b] != 0;
    if (water_a != water_b) return true;
    if (!water_a) return solids_ && solids_differ(a, b);
    const float depth_a = buffers_.depth[a], depth_b = buffers_.depth[b];
    float slope = 0;  // change of depth over the width of a pixel on the flatter-seen of both surfaces
    if (!buffers_.normal.empty()) {
      const vec3 normal_a = buffers_.normal[a], normal_b = buffers_.normal[b];
      if (glm::dot(normal_a, normal_b) < kFoldCosine) return true;
      if (std::abs(depth_a - depth_b) <= 2 * spacing_) return false;  // whatever the slope is: as nearly everywhere
      const vec3 direction = direction_of(a);
      const float cosine =
          std::max(0.1f, std::min(std::abs(glm::dot(normal_a, direction)), std::abs(glm::dot(normal_b, direction))));
      slope = std::sqrt(1 - std::min(cosine * cosine, 1.0f)) / cosine;
    }
    const float allowed = 2 * spacing_ + 2 * slope * view_.pixel_size(std::min(depth_a, depth_b));
    return std::abs(depth_a - depth_b) > allowed;
  }

 private:
  vec3 direction_of(std::size_t i) const {
    const auto width = static_cast<std::size_t>(visible_.width());
    return view_.ray({static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f}).direction;
  }

  /// Edges and outlines of solids, and where they meet.
  bool solids_differ(std::size_t a, std::size_t b) const {
    const float depth_a = solids_->depth[a], depth_b = solids_->depth[b];
    const bool far_a = depth_a == std::numeric_limits<float>::infinity();
    const bool far_b = depth_b == std::numeric_limits<float>::infinity();
    if (far_a || far_b) return far_a != far_b;
    const vec3 normal = solids_->normal[a];
    if (glm::dot(normal, solids_->normal[b]) < kFoldCosine) return true;
    // Whether b lies on the plane through a, as far as a pixel can tell.
    const float apart = std::abs(depth_a - depth_b), allowed = 4 * view_.pixel_size(std::min(depth_a, depth_b));
    if (apart <= allowed) return false;
    const float cosine = std::max(0.02f, std::abs(glm::dot(normal, direction_of(a))));
    return apart > allowed / cosine;
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
    std::vector<std::size_t> wet;
    std::vector<Ray> rays;
    for (std::size_t i = begin * width; i < end * width; ++i) {
      if (!(coverage[i] > 0)) continue;
      wet.push_back(i);
      if (!buffers.eye_in_water && !solids)
        rays.push_back(view.ray({static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f}));
    }
    std::vector<float> distances(rays.size());
    if (!rays.empty()) scene.distances(rays, distances);
    for (std::size_t k = 0; k < wet.size(); ++k) {
      const std::size_t i = wet[k];
      visible[i] = buffers.eye_in_water || (solids ? solids->depth[i] : distances[k]) >= buffers.depth[i] ? 1 : 0;
    }
  });
  const Differ differ(view, buffers, visible, solids, spacing);
  // A row looks at its neighbours on all sides and marks its own pixels only.
  parallel_for(height, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t i = y * width + x;
        marked[i] = (x > 0 && differ(i, i - 1)) || (x + 1 < width && differ(i, i + 1)) ||
                    (y > 0 && differ(i, i - width)) || (y + 1 < height && differ(i, i + width));
      }
  });
  std::vector<std::uint32_t> pixels;
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (marked[i]) pixels.push_back(static_cast<std::uint32_t>(i));
  return pixels;
}

std::vector<std::uint32_t> with_wide_pixels(std::vector<std::uint32_t> pixels, const Surface& surface, const View& view,
                                            const SurfaceBuffers& buffers) {
  const PixelWidth width(surface, view, buffers);
  std::vector<std::uint32_t> wide;
  for (std::size_t i = 0; i < buffers.coverage.size(); ++i) {
    const bool near_water = buffers.coverage[i] > 0 || (!buffers.thickness.empty() && buffers.thickness[i] > 0);
    if (near_water && width.of(i) > kWide) wide.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> all;
  std::set_union(pixels.begin(), pixels.end(), wide.begin(), wide.end(), std::back_inserter(all));
  return all;
}

void refine_pixels(const Surface& surface, const View& view, const Scene& scene, const Material& material,
                   const OpticsInputs& optics, std::span<const std::uint32_t> given, SurfaceBuffers& buffers,
                   Image<vec3>& radiance, std::size_t at_once) {
  // Those that are narrow first, which share what there is to share with their neighbours.
  std::vector<std::uint32_t> pixels(given.begin(), given.end());
  const PixelWidth widths(surface, view, buffers);
  const auto narrow = static_cast<std::size_t>(
      std::stable_partition(pixels.begin(), pixels.end(), [&](std::uint32_t i) { return widths.of(i) <= kCoarse; }) -
      pixels.begin());
  // What refine() looks at must stay as see() returned it, so the means are kept aside until the end.
  std::vector<float> coverage(pixels.size()), thickness(pixels.size());
  const std::size_t width = static_cast<std::size_t>(view.width);
  std::vector<vec2> points;
  std::vector<Samples> samples;
  // Draws some rays of the pixels of a batch.
  const auto draw = [&](std::span<const std::uint32_t> batch, std::span<const std::size_t> chosen,
                        std::span<const std::size_t> rays) {
    points.clear();
    for (const std::size_t i : chosen)
      for (const std::size_t k : rays)
        points.emplace_back(static_cast<float>(batch[i] % width) + (static_cast<float>(k % kGrid) + 0.5f) / kGrid,
                            static_cast<float>(batch[i] / width) + (static_cast<float>(k / kGrid) + 0.5f) / kGrid);
    if (points.empty()) return;
    const SurfaceBuffers fine = surface.refine(view, buffers, points);
    const Image<vec3> fine_radiance = shade(view, points, fine, scene, material, optics);
    std::size_t point = 0;
    for (const std::size_t i : chosen)
      for (const std::size_t k : rays) {
        samples[i].radiance[k] = fine_radiance[point];
        samples[i].coverage[k] = fine.coverage[point];
        samples[i].thickness[k] = fine.thickness.empty() ? 0.0f : fine.thickness[point];
        ++point;
      }
  };
  std::vector<std::size_t> left, rough;  // pixels of a batch that want more rays
  const auto refine_some = [&](std::size_t first, std::size_t count, std::span<const Enough> steps) {
    const std::span<const std::uint32_t> batch = std::span(pixels).subspan(first, count);
    samples.resize(batch.size());
    left.resize(batch.size());
    std::iota(left.begin(), left.end(), std::size_t{0});
    std::size_t drawn = 0;
    for (const Enough& enough : steps) {
      draw(batch, left, std::span(kInTurn).subspan(drawn, enough.rays - drawn));
      drawn = enough.rays;
      rough.clear();
      for (const std::size_t i : left) {
        if (drawn < kRays && !(samples[i].apart(drawn) <= enough.apart)) {
          rough.push_back(i);
          continue;
        }
        const PixelMean mean = samples[i].mean(drawn);
        radiance[batch[i]] = mean.radiance;
        coverage[first + i] = mean.coverage;
        thickness[first + i] = mean.thickness;
      }
      left.swap(rough);
    }
  };
  for (std::size_t first = 0; first < narrow; first += at_once)
    refine_some(first, std::min(at_once, narrow - first), kEnough);
  // Without the picture's normals a surface gives each ray its own.
  Image<vec3> normals;
  std::swap(normals, buffers.normal);
  for (std::size_t first = narrow; first < pixels.size(); first += at_once)
    refine_some(first, std::min(at_once, pixels.size() - first), kAll);
  std::swap(normals, buffers.normal);
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
