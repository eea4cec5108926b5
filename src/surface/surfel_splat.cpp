#include "surface/surfel_splat.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "surface/packet.h"
#include "surface/surfel_tile.h"

namespace meniscus {
namespace {

constexpr int kTile = kSurfelTile;
constexpr std::size_t kGrain = 1 << 13;

struct Camera {
  explicit Camera(const View& view)
      : view(view),
        perspective(view.projection == Projection::perspective),
        pixel(2.0f * view.half_height / static_cast<float>(view.height)) {}
  vec3 turned(vec3 v) const { return {glm::dot(v, view.right), glm::dot(v, view.up), glm::dot(v, view.forward)}; }
  /// Place on the plane at distance 1, or in metres.
  vec2 on_plane(vec2 point) const {
    return {(point.x - 0.5f * static_cast<float>(view.width)) * pixel,
            (0.5f * static_cast<float>(view.height) - point.y) * pixel};
  }
  const View& view;
  bool perspective;
  float pixel;
};

struct Range {
  float low, high;
};

/// Where values within `half` of c, at depths within `deep` of z, lie on the plane at distance 1.
Range seen(float c, float half, float z, float deep) {
  const float nearest = z - deep, farthest = z + deep;
  if (nearest <= 0.01f * farthest) return {-1e30f, 1e30f};
  const float low = c - half, high = c + half;
  return {low / (low < 0 ? nearest : farthest), high / (high > 0 ? nearest : farthest)};
}

/// The disc's form from its mean curvature and half of its bend (the whole of it leaves single pixels open where a
/// rippled surface is seen at a slant): S = k b b + l c c + m n n, with the larger curvature k along b, the smaller one
/// l along c, and m that of them which is larger in size, so that balls and cylinders are met exactly.
void set_form(const Camera& camera, const Surfel& surfel, float side, SurfelDisc& disc) {
  const float size = 0.5f * glm::length(surfel.bend);
  const float k = side * (surfel.curvature + size), l = side * (surfel.curvature - size),
              m = std::abs(k) > std::abs(l) ? k : l;
  const vec3 n = disc.normal;
  disc.straight = vec3{l} + (m - l) * n * n;
  disc.skew = (m - l) * vec3{n.y * n.z, n.z * n.x, n.x * n.y};
  if (!(size > 0.0f)) return;
  const vec3 b = camera.turned(0.5f * surfel.bend / size);
  disc.straight += (k - l) * b * b;
  disc.skew += (k - l) * vec3{b.y * b.z, b.z * b.x, b.x * b.y};
}

/// The surfel as it is seen; covers nothing where it turns its back or lies behind the eye.
SurfelDisc seen_disc(const Camera& camera, const Surfel& surfel, bool from_inside, float margin) {
  SurfelDisc disc;
  disc.x0 = disc.y0 = 1;
  disc.x1 = disc.y1 = 0;
  const float side = from_inside ? -1.0f : 1.0f, radius = surfel.radius;
  disc.centre = camera.turned(surfel.position - camera.view.eye);
  disc.normal = camera.turned(side * surfel.normal);
  // Back faces are culled; the rim of a bulging cap may still face the eye.
  const float bend = glm::length(surfel.bend), most = std::max(side * surfel.curvature + bend, 0.0f);
  const float facing =
      camera.perspective ? glm::dot(disc.normal, disc.centre) / glm::length(disc.centre) : disc.normal.z;
  if (!(facing < most * radius)) return disc;
  if (disc.centre.z + radius <= 0.0f) return disc;
  disc.radius2 = radius * radius;
  const float bulge = 0.5f * (std::abs(surfel.curvature) + bend) * disc.radius2;
  const auto half = [&](float n) { return radius * std::sqrt(std::max(1.0f - n * n, 0.0f)) + bulge; };
  const float deep = half(disc.normal.z);
  Range u{disc.centre.x - half(disc.normal.x), disc.centre.x + half(disc.normal.x)};
  Range v{disc.centre.y - half(disc.normal.y), disc.centre.y + half(disc.normal.y)};
  if (camera.perspective) {
    u = seen(disc.centre.x, half(disc.normal.x), disc.centre.z, deep);
    v = seen(disc.centre.y, half(disc.normal.y), disc.centre.z, deep);
  }
  const float width = static_cast<float>(camera.view.width), height = static_cast<float>(camera.view.height);
  const float x0 = std::ceil(u.low / camera.pixel + 0.5f * width - 0.5f - margin),
              x1 = std::floor(u.high / camera.pixel + 0.5f * width - 0.5f + margin),
              y0 = std::ceil(0.5f * height - v.high / camera.pixel - 0.5f - margin),
              y1 = std::floor(0.5f * height - v.low / camera.pixel - 0.5f + margin);
  if (!(x0 <= width - 1 && x1 >= 0 && y0 <= height - 1 && y1 >= 0 && x0 <= x1 && y0 <= y1)) return disc;
  disc.x0 = static_cast<std::int16_t>(std::max(x0, 0.0f));
  disc.x1 = static_cast<std::int16_t>(std::min(x1, width - 1));
  disc.y0 = static_cast<std::int16_t>(std::max(y0, 0.0f));
  disc.y1 = static_cast<std::int16_t>(std::min(y1, height - 1));
  set_form(camera, surfel, side, disc);
  return disc;
}

/// Things by tile, in their given order within each.
struct Tiles {
  std::vector<std::uint32_t> start, index;  ///< by tile, and one more; of the things
};

/// @param tiles_of  calls visit(tile) for the tiles of thing i
template <class TilesOf>
Tiles sorted(std::size_t count, std::size_t tiles, TilesOf tiles_of) {
  Tiles result;
  const std::size_t blocks = std::clamp<std::size_t>(count / kGrain, 1, 16), per_block = (count + blocks - 1) / blocks;
  std::vector<std::vector<std::uint32_t>> counters(blocks, std::vector<std::uint32_t>(tiles, 0));
  const auto for_block = [&](std::size_t block, auto visit) {
    for (std::size_t i = block * per_block; i < std::min(count, (block + 1) * per_block); ++i)
      tiles_of(i, [&](std::size_t tile) { visit(tile, static_cast<std::uint32_t>(i)); });
  };
  parallel_for(blocks, 1, [&](std::size_t block, std::size_t) {
    for_block(block, [&](std::size_t tile, std::uint32_t) { ++counters[block][tile]; });
  });
  result.start.resize(tiles + 1);
  std::uint32_t sum = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    result.start[tile] = sum;
    for (auto& mine : counters) sum += std::exchange(mine[tile], sum);
  }
  result.start[tiles] = sum;
  result.index.resize(sum);
  parallel_for(blocks, 1, [&](std::size_t block, std::size_t) {
    for_block(block, [&](std::size_t tile, std::uint32_t i) { result.index[counters[block][tile]++] = i; });
  });
  return result;
}

/// The samples of one tile, sorted by pixel, and what is summed for them; kept by each thread from tile to tile.
struct TileSamples {
  std::vector<std::uint32_t> start;   ///< by pixel of the tile, and one more
  std::vector<vec2> place;            ///< on the plane
  std::vector<std::uint32_t> target;  ///< in the buffers
  AlignedFloats values;

  void clear() {
    start.clear();
    place.clear();
    target.clear();
  }

  /// The arrays that the passes work on.
  SurfelSamples arrays(bool perspective) {
    const std::size_t count = place.size(), pitch = (count + 2 * kSampleRoom) / kSampleRoom * kSampleRoom;
    values.reserve(11 * pitch, 0);
    float* const v = values.data();
    std::fill_n(v, 11 * pitch, 0.0f);
    std::fill_n(v + 2 * pitch, 2 * pitch, 1.0f);
    std::fill_n(v + 4 * pitch, pitch, std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < count; ++i) {
      v[i] = place[i].x;
      v[pitch + i] = place[i].y;
      if (!perspective) continue;
      const float length2 = 1.0f + glm::dot(place[i], place[i]);
      v[2 * pitch + i] = std::sqrt(length2);
      v[3 * pitch + i] = 1.0f / length2;
    }
    const auto array = [&](std::size_t i) { return v + i * pitch; };
    return {count,    start.data(), array(0), array(1), array(2), array(3), array(4),
            array(5), array(6),     array(7), array(8), array(9), array(10)};
  }
};

class Splat {
 public:
  Splat(const View& view, float epsilon, bool from_inside, std::span<const vec2> points, SurfaceBuffers& out)
      : camera_(view), epsilon_(epsilon), from_inside_(from_inside), points_(points), out_(out) {
    tiles_x_ = (view.width + kTile - 1) / kTile;
    tiles_y_ = (view.height + kTile - 1) / kTile;
  }

  void run(std::span<const Surfel> surfels, std::span<const vec3> normals) {
    normals_ = normals;
    discs_.resize(surfels.size());
    const float margin = points_.empty() ? 0.01f : 0.51f;  // points lie anywhere in their pixels
    parallel_for(surfels.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        discs_[i] = seen_disc(camera_, surfels[i], from_inside_, margin);
        if (!normals_.empty()) discs_[i].shaded = normals_[i];
      }
    });
    const auto tiles = static_cast<std::size_t>(tiles_x_ * tiles_y_);
    const Tiles by_tile = sorted(discs_.size(), tiles, [&](std::size_t i, auto visit) {
      const SurfelDisc& disc = discs_[i];
      if (disc.x0 > disc.x1) return;
      for (int y = disc.y0 / kTile; y <= disc.y1 / kTile; ++y)
        for (int x = disc.x0 / kTile; x <= disc.x1 / kTile; ++x) visit(static_cast<std::size_t>(y * tiles_x_ + x));
    });
    Tiles points_by_tile;
    if (!points_.empty())
      points_by_tile = sorted(points_.size(), tiles, [&](std::size_t i, auto visit) {
        visit(static_cast<std::size_t>(pixel_y(points_[i]) / kTile * tiles_x_ + pixel_x(points_[i]) / kTile));
      });
    parallel_for(tiles, 1, [&](std::size_t tile, std::size_t) {
      const std::span<const std::uint32_t> mine(by_tile.index.data() + by_tile.start[tile],
                                                by_tile.start[tile + 1] - by_tile.start[tile]);
      if (mine.empty()) return;
      thread_local TileSamples samples;
      samples.clear();
      const int x = static_cast<int>(tile) % tiles_x_ * kTile, y = static_cast<int>(tile) / tiles_x_ * kTile;
      if (points_.empty())
        take_pixels(x, y, samples);
      else
        take_points(x, y, points_by_tile, tile, samples);
      draw(x, y, mine, samples);
    });
  }

 private:
  int pixel_x(vec2 p) const {
    return static_cast<int>(std::clamp(p.x, 0.0f, static_cast<float>(camera_.view.width - 1)));
  }
  int pixel_y(vec2 p) const {
    return static_cast<int>(std::clamp(p.y, 0.0f, static_cast<float>(camera_.view.height - 1)));
  }

  void take_pixels(int x0, int y0, TileSamples& samples) const {
    const int width = camera_.view.width, height = camera_.view.height;
    samples.start.push_back(0);
    for (int y = y0; y < y0 + kTile; ++y)
      for (int x = x0; x < x0 + kTile; ++x) {
        if (x < width && y < height) {
          samples.place.push_back(camera_.on_plane({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}));
          samples.target.push_back(static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width) +
                                   static_cast<std::uint32_t>(x));
        }
        samples.start.push_back(static_cast<std::uint32_t>(samples.place.size()));
      }
  }

  void take_points(int x0, int y0, const Tiles& by_tile, std::size_t tile, TileSamples& samples) const {
    const auto pixel = [&](std::uint32_t i) {
      return static_cast<std::size_t>((pixel_y(points_[i]) - y0) * kTile + pixel_x(points_[i]) - x0);
    };
    samples.start.assign(kTile * kTile + 1, 0);
    for (std::uint32_t at = by_tile.start[tile]; at < by_tile.start[tile + 1]; ++at)
      ++samples.start[pixel(by_tile.index[at]) + 1];
    for (std::size_t p = 0; p < kTile * kTile; ++p) samples.start[p + 1] += samples.start[p];
    samples.place.resize(samples.start.back());
    samples.target.resize(samples.start.back());
    std::vector<std::uint32_t> next(samples.start);
    for (std::uint32_t at = by_tile.start[tile]; at < by_tile.start[tile + 1]; ++at) {
      const std::uint32_t i = by_tile.index[at], slot = next[pixel(i)]++;
      samples.place[slot] = camera_.on_plane(points_[i]);
      samples.target[slot] = i;
    }
  }

  void draw(int x0, int y0, std::span<const std::uint32_t> mine, TileSamples& samples) {
    const SurfelSamples sums = samples.arrays(camera_.perspective);
    draw_surfels({x0, y0, camera_.perspective, normals_.empty(), epsilon_, discs_, mine}, sums);
    const View& view = camera_.view;
    for (std::size_t s = 0; s < sums.count; ++s) {
      const vec3 sum{sums.nx[s], sums.ny[s], sums.nz[s]};
      const float size = glm::length(sum);
      if (!(sums.weight[s] > 0.0f) || !(size > 0.0f)) continue;
      const std::size_t target = samples.target[s];
      const vec3 n = sum * (from_inside_ ? -1.0f : 1.0f);
      out_.depth[target] = sums.depth[s] / sums.weight[s];
      out_.normal[target] =
          glm::normalize(normals_.empty() ? n.x * view.right + n.y * view.up + n.z * view.forward : sum);
      out_.coverage[target] = 1.0f;
      out_.entry[target] = sums.nearest[s] * sums.length[s];
      out_.exit[target] = sums.last[s] * sums.length[s];
    }
  }

  Camera camera_;
  float epsilon_;
  bool from_inside_;
  std::span<const vec2> points_;
  SurfaceBuffers& out_;
  int tiles_x_, tiles_y_;
  std::vector<SurfelDisc> discs_;
  std::span<const vec3> normals_;
};

}  // namespace

SurfaceBuffers splat_surfels(const View& view, std::span<const Surfel> surfels, std::span<const vec3> normals,
                             float epsilon, bool from_inside, std::span<const vec2> points) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  SurfaceBuffers out;
  const int width = points.empty() ? view.width : static_cast<int>(points.size()),
            height = points.empty() ? view.height : 1;
  out.eye_in_water = from_inside;
  out.depth = Image<float>(width, height, kInfinity);
  out.normal = Image<vec3>(width, height, vec3{0});
  out.coverage = Image<float>(width, height, 0.0f);
  out.entry = Image<float>(width, height, kInfinity);
  out.exit = Image<float>(width, height, -kInfinity);
  if (!surfels.empty()) Splat(view, epsilon, from_inside, points, out).run(surfels, normals);
  return out;
}

}  // namespace meniscus
