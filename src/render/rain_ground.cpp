#include "render/rain_ground.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/field_axes.h"
#include "base/random.h"

namespace meniscus {
namespace {

constexpr float kTrack = 1.5f;                 ///< m between the two ruts of a lane
constexpr float kRutWidth = 0.22f;             ///< m, standard deviation of a rut's profile
constexpr double kMostTexels = 4e6;            ///< of made-up heights
constexpr float kShallowest = 0.35f;           ///< of a rut's depth, where it is shallowest
constexpr float kRutLengths[] = {7.3f, 3.1f};  ///< m, of the waves along a rut

float brightness_of(Rgb8 colour) { return (0.2126f * colour.r + 0.7152f * colour.g + 0.0722f * colour.b) / 255.0f; }

Image<GroundMaterial> materials_of(const Image<Rgb8>& picture) {
  Image<GroundMaterial> materials(picture.width(), picture.height());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const float bright = brightness_of(picture[i]);
    materials[i] = bright < 1.0f / 3   ? GroundMaterial::asphalt
                   : bright < 2.0f / 3 ? GroundMaterial::concrete
                                       : GroundMaterial::steel;
  }
  return materials;
}

Image<float> heights_of(const Image<Rgb8>& picture, float lowest, float highest) {
  Image<float> heights(picture.width(), picture.height());
  for (std::size_t i = 0; i < picture.size(); ++i) heights[i] = lowest + (highest - lowest) * brightness_of(picture[i]);
  return heights;
}

/// Between the middles of pixels bilinear, beyond them held; u and v run from 0 to 1 over the whole picture.
float bilinear(const Image<float>& image, float u, float v) {
  const float x = std::clamp(u * static_cast<float>(image.width()) - 0.5f, 0.0f, static_cast<float>(image.width() - 1));
  const float y =
      std::clamp(v * static_cast<float>(image.height()) - 0.5f, 0.0f, static_cast<float>(image.height() - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.width() - 1), y1 = std::min(y0 + 1, image.height() - 1);
  const float s = x - static_cast<float>(x0), t = y - static_cast<float>(y0);
  return (1 - t) * ((1 - s) * image(x0, y0) + s * image(x1, y0)) + t * ((1 - s) * image(x0, y1) + s * image(x1, y1));
}

/// Two wheel tracks along a that are deeper here and there, on a crowned road.
class Road {
 public:
  explicit Road(const RainGround& ground) : ground_(ground) {
    Draws draws(ground.cells.seed, 0x726f6164);
    for (auto& side : phases_)
      for (float& phase : side) phase = static_cast<float>(draws.between(0, 2 * std::numbers::pi));
  }

  /// @param b  m from the middle of the road
  float height(float a, float b) const {
    float height = -ground_.slope * std::abs(b);
    for (int side = 0; side < 2; ++side) {
      const float off = (b - (side == 0 ? -0.5f : 0.5f) * kTrack) / kRutWidth;
      height -= ground_.rut_depth * depth(a, phases_[side]) * std::exp(-0.5f * off * off);
    }
    return height;
  }

 private:
  /// kShallowest to 1.
  static float depth(float a, const float (&phases)[2]) {
    float sum = 0;
    for (int wave = 0; wave < 2; ++wave)
      sum += 0.5f * std::sin(2 * std::numbers::pi_v<float> * a / kRutLengths[wave] + phases[wave]);
    return kShallowest + (1 - kShallowest) * (0.5f + 0.5f * sum);
  }

  const RainGround& ground_;
  float phases_[2][2];
};

/// An image with a texel a cell, or fewer where that would be too many.
Image<float> texels_for(const GroundOptions& cells) {
  const vec2 size = cells.high - cells.low;
  const double along_a = std::max(1.0, std::ceil(static_cast<double>(size.x) / cells.cell));
  const double along_b = std::max(1.0, std::ceil(static_cast<double>(size.y) / cells.cell));
  const double coarser = std::max(1.0, std::sqrt(along_a * along_b / kMostTexels));
  return {static_cast<int>(std::max(1.0, along_a / coarser)), static_cast<int>(std::max(1.0, along_b / coarser))};
}

/// Fills an image of heights by `of(a, b, u, v)`: the place in m, and in parts of the picture.
template <class Of>
Image<float> filled(const GroundOptions& cells, Of of) {
  Image<float> image = texels_for(cells);
  const vec2 size = cells.high - cells.low;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(image.width());
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height());
      image(x, y) = of(cells.low.x + u * size.x, cells.high.y - v * size.y, u, v);
    }
  return image;
}

/// What is met by rays straight down, above `level`; the level where there is nothing.
Image<float> seen_from_above(const GroundOptions& cells, const Scene& scene) {
  const FieldAxes axes(cells.up);
  const vec3 down = -direction_of(cells.up);
  const float top = scene.solid_bounds().high[axes.up] + 1;
  std::vector<Ray> rays;
  Image<float> image = filled(cells, [&](float a, float b, float, float) {
    rays.push_back({axes.place(a, b, top), down});
    return 0.0f;
  });
  std::vector<float> distances(rays.size());
  scene.distances(rays, distances);
  for (std::size_t i = 0; i < distances.size(); ++i)
    image[i] = std::isfinite(distances[i]) ? top - distances[i] - cells.level : 0.0f;
  return image;
}

}  // namespace

GroundOptions ground_cells(const RainGround& ground, const Scene* seen) {
  GroundOptions cells = ground.cells;
  if (!ground.materials.empty()) cells.materials = materials_of(read_png(ground.materials));
  if (!ground.heights.empty()) cells.heights = heights_of(read_png(ground.heights), ground.lowest, ground.highest);
  if (!ground.mesh.empty()) {
    if (!seen)
      throw Error(ErrorCode::invalid_argument,
                  {"the ground's body is not there", "a body of the name " + ground.mesh, "none", {}, {}, {}, {}});
    cells.heights = seen_from_above(cells, *seen);
  }
  if (ground.rut_depth != 0 || ground.slope != 0) {
    const Road road(ground);
    const Image<float> base = std::move(cells.heights);
    const float middle = 0.5f * (cells.low.y + cells.high.y);
    cells.heights = filled(cells, [&](float a, float b, float u, float v) {
      return road.height(a, b - middle) + (base.empty() ? 0.0f : bilinear(base, u, v));
    });
  }
  return cells;
}

float lowest_bed(const WetGround& ground) {
  float lowest = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < ground.size(); ++i) lowest = std::min(lowest, ground.bed(i));
  return lowest;
}

float highest_bed(const WetGround& ground) {
  float highest = -std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < ground.size(); ++i) highest = std::max(highest, ground.bed(i));
  return highest;
}

}  // namespace meniscus
