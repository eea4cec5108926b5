#include "shading/shade_blocks.h"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>
#include <memory>

#include "scene/view_rays.h"
#include "shading/refraction.h"
#include "shading/water_block.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kLanes = WaterBlock::kLanes;

/// What a thread works with; kept for its next piece.
struct Work {
  std::vector<std::size_t> pixels;  ///< to be done, increasing
  std::vector<float> coverage;      ///< of the piece
  WaterBlock block;
  BlockPixels points;
  RayBlock straight;  ///< rays from the surface as if it bent none
  BlockVectors sky, behind, floor, image, seen;
  alignas(64) float distance[kLanes];
};

/// A piece of the picture.
class Piece {
 public:
  Piece(const ShadeInputs& inputs, std::size_t begin, std::size_t end, vec3* picture, Work& work)
      : inputs_(inputs),
        water_(inputs.water),
        scene_(inputs.scene),
        optics_{inputs.material,
                inputs.optics.options.fresnel,
                inputs.beam,
                inputs.scene.ground().up,
                inputs.scene.environment().sun_direction(),
                inputs.scene.environment().sun_irradiance()},
        picture_(picture),
        work_(work),
        begin_(begin),
        end_(end) {}

  void run() {
    find_water();
    for_each_block([&] { shade_water(); });
    find_rest();
    for_each_block([&] { shade_rest(); });
  }

 private:
  /// Pixels of water, and how much of each it covers.
  void find_water() {
    const std::size_t count = end_ - begin_;
    work_.pixels.resize(count);
    work_.coverage.resize(count);
    std::size_t found = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = begin_ + k;
      const float depth = water_.depth[i], coverage = water_.coverage[i];
      // Without branches: outlines cannot be foreseen.
      const bool wet = (coverage > 0) & (depth >= 0) & (depth < kInfinity);
      work_.coverage[k] = wet ? std::min(coverage, 1.0f) : 0.0f;
      work_.pixels[found] = i;
      found += wet ? 1 : 0;
    }
    work_.pixels.resize(found);
  }

  /// Pixels that show something else too.
  void find_rest() {
    const std::size_t count = end_ - begin_;
    work_.pixels.resize(count);
    std::size_t found = 0;
    for (std::size_t k = 0; k < count; ++k) {
      work_.pixels[found] = begin_ + k;
      found += work_.coverage[k] < 1.0f ? 1 : 0;
    }
    work_.pixels.resize(found);
  }

  /// Fills in indices and rays of some pixels after the other, and calls body().
  template <class Body>
  void for_each_block(Body body) {
    const std::vector<std::size_t>& pixels = work_.pixels;
    WaterBlock& block = work_.block;
    for (std::size_t first = 0; first < pixels.size(); first += kLanes) {
      block.count = static_cast<int>(std::min<std::size_t>(kLanes, pixels.size() - first));
      std::copy_n(pixels.data() + first, block.count, block.indices);
      if (inputs_.points.empty()) {
        centres(block.indices, block.count);
      } else {
        for (int lane = 0; lane < block.count; ++lane) {
          work_.points.x[lane] = inputs_.points[block.indices[lane]].x;
          work_.points.y[lane] = inputs_.points[block.indices[lane]].y;
        }
      }
      view_rays(inputs_.view, work_.points, block.count, block.rays);
      body();
    }
  }

  /// Picture points of pixels whose indices increase.
  void centres(const std::size_t* indices, int count) {
    const auto width = static_cast<std::size_t>(inputs_.view.width);
    const std::size_t last = indices[count - 1];
    std::size_t row = indices[0] / width;
    const auto put = [&](int from, int to) {
      const float y = static_cast<float>(row) + 0.5f;
      const std::size_t start = row * width;
      for (int lane = from; lane < to; ++lane) {
        work_.points.x[lane] = static_cast<float>(static_cast<std::int32_t>(indices[lane] - start)) + 0.5f;
        work_.points.y[lane] = y;
      }
    };
    if (last < (row + 1) * width) {
      put(0, count);
      return;
    }
    for (int lane = 0; lane < count; ++lane) {
      while (indices[lane] >= (row + 1) * width) ++row;
      put(lane, lane + 1);
    }
  }

  /// What is known of the block's water.
  void load() {
    WaterBlock& block = work_.block;
    const int count = block.count, padded = (count + 15) / 16 * 16;
    const std::size_t first = block.indices[0];
    if (block.indices[count - 1] - first == static_cast<std::size_t>(count) - 1) {
      std::copy_n(water_.depth.data() + first, count, block.depth);
      std::copy_n(water_.thickness.data() + first, count, block.thickness);
    } else {
      for (int lane = 0; lane < count; ++lane) {
        block.depth[lane] = water_.depth[block.indices[lane]];
        block.thickness[lane] = water_.thickness[block.indices[lane]];
      }
    }
    for (int lane = 0; lane < count;) {
      const std::size_t loaded =
          inputs_.points.empty() ? load_normals(water_.normal, static_cast<std::size_t>(lane), block) : 0;
      const int next = loaded > 0 ? lane + static_cast<int>(loaded) : std::min((lane / 16 + 1) * 16, count);
      for (; lane < next; ++lane) {
        if (loaded > 0) continue;
        block.normal.set(lane, water_.normal[block.indices[lane]]);
        block.variance[lane] = inputs_.variance.at(block.indices[lane]);
      }
    }
    if (inputs_.scene.tank().style != TankStyle::none) flatten();
    for (int lane = count; lane < padded; ++lane) {
      block.depth[lane] = block.depth[count - 1];
      block.thickness[lane] = block.thickness[count - 1];
      block.variance[lane] = block.variance[count - 1];
      block.normal.set(lane, block.normal.get(count - 1));
    }
  }

  void flatten() {
    WaterBlock& block = work_.block;
    const float spacing = inputs_.optics.surface ? inputs_.optics.surface->spacing() : 0.0f;
    for (int lane = 0; lane < block.count; ++lane) {
      vec3 normal = block.normal.get(lane);
      flatten_at_walls(scene_.tank(), spacing, block.rays.ray(lane), block.depth[lane], normal);
      block.normal.set(lane, normal);
    }
  }

  /// A solid before the water hides it.
  bool hide() {
    WaterBlock& block = work_.block;
    float* distance = work_.distance;
    if (inputs_.behind)
      for (int lane = 0; lane < block.count; ++lane) distance[lane] = inputs_.behind->depth[block.indices[lane]];
    else
      scene_.block_distances(block.rays, distance);
    int hidden = 0;
    for (int lane = 0; lane < block.count; ++lane) hidden |= static_cast<int>(distance[lane] < block.depth[lane]);
    int left = block.count;
    for (int lane = 0; hidden != 0 && lane < block.count; ++lane) {
      if (!(distance[lane] < block.depth[lane])) continue;
      work_.coverage[block.indices[lane] - begin_] = 0.0f;
      --left;
    }
    return left > 0;
  }

  void shade_water() {
    WaterBlock& block = work_.block;
    load();
    if (!hide()) return;
    const Material& material = inputs_.material;
    bend(optics_, block);
    block.inside.count = block.mirror.count = block.onward.count = block.count;
    scene_.environment().irradiance(block.normal, block.count, work_.sky);

    // Through the water.
    bool on_floor = false;
    if (material.transparent) {
      if (block.undersides) {
        scene_.block_distances(block.onward, work_.distance);
        pad(work_.distance);
        on_floor = lean(optics_, work_.distance, block);
      }
      if (on_floor) work_.straight = block.onward;
      scene_.block_distances(block.inside, work_.distance);
      pad(work_.distance);
      go_on(optics_, work_.distance, block);
      scene_.block_radiance(block.onward, block.beams, work_.behind);
      if (on_floor) scene_.block_radiance(work_.straight, block.beams, work_.floor);
    }
    const bool mirrors = material.specular > 0;
    if (mirrors) scene_.block_radiance(block.mirror, block.mirror_beams, work_.image);
    put_together(optics_, block, work_.sky, material.transparent ? &work_.behind : nullptr,
                 on_floor ? &work_.floor : nullptr, mirrors ? &work_.image : nullptr, work_.seen);
    store_pixels(block.indices, block.count, work_.seen, picture_);
  }

  void pad(float* values) const {
    for (int lane = work_.block.count; lane % 16 != 0; ++lane) values[lane] = values[work_.block.count - 1];
  }

  /// Sky and solids beside the water, or mixed with it.
  void shade_rest() {
    WaterBlock& block = work_.block;
    float* distance = work_.distance;
    if (inputs_.behind) {
      for (int lane = 0; lane < block.count; ++lane) {
        work_.behind.set(lane, inputs_.behind->radiance[block.indices[lane]]);
        distance[lane] = inputs_.behind->depth[block.indices[lane]];
      }
    } else {
      block.beams.fill(inputs_.beam);
      scene_.block_radiance(block.rays, block.beams, work_.behind, distance);
    }
    add_sun_disc();
    for (int lane = 0; lane < block.count; ++lane) {
      const std::size_t i = block.indices[lane];
      const float coverage = work_.coverage[i - begin_];
      if (coverage > 0) work_.behind.set(lane, glm::mix(work_.behind.get(lane), picture_[i], coverage));
    }
    store_pixels(block.indices, block.count, work_.behind, picture_);
  }

  void add_sun_disc() {
    if (!scene_.environment().sun_visible()) return;
    const RayBlock& rays = work_.block.rays;
    // Half the squared chord to the sun, as in Environment::sun_glare().
    const float reach = 31.0f * (Environment::kSunVariance + inputs_.beam.spread * inputs_.beam.spread);
    float half_square[kLanes];
    int any = 0;
    for (int lane = 0; lane < rays.count; ++lane) {
      const float x = rays.direction[0][lane] - optics_.sun.x, y = rays.direction[1][lane] - optics_.sun.y,
                  z = rays.direction[2][lane] - optics_.sun.z;
      half_square[lane] = 0.5f * (x * x + y * y + z * z);
      any |= static_cast<int>(half_square[lane] < reach);
    }
    for (int lane = 0; any != 0 && lane < rays.count; ++lane)
      if (half_square[lane] < reach && !(work_.distance[lane] < kInfinity))
        work_.behind.set(lane, work_.behind.get(lane) + sun_disc(rays.ray(lane), inputs_.beam, scene_));
  }

  const ShadeInputs& inputs_;
  const SurfaceBuffers& water_;
  const Scene& scene_;
  const BlockOptics optics_;
  vec3* picture_;
  Work& work_;
  std::size_t begin_, end_;
};

}  // namespace

vec3 sun_disc(const Ray& ray, Beam beam, const Scene& scene) {
  const Environment& environment = scene.environment();
  if (!environment.sun_visible()) return vec3{0.0f};
  return glm::min(environment.sun_glare(ray.direction, beam.spread * beam.spread), vec3{200.0f});
}

bool takes_blocks(const ShadeInputs& inputs) {
  const OpticsOptions& options = inputs.optics.options;
  const bool dispersive = options.dispersion && inputs.material.dispersion != vec3{0.0f};
  const bool one_interface = !inputs.material.transparent || options.refraction == RefractionMethod::thickness;
  return one_interface && !(dispersive && inputs.material.transparent) && !inputs.water.eye_in_water &&
         inputs.water.colour.empty();
}

void shade_pixels(const ShadeInputs& inputs, std::size_t begin, std::size_t end, vec3* picture) {
  // Taken out: this thread may begin another piece while it waits within this one.
  thread_local std::unique_ptr<Work> memory;
  std::unique_ptr<Work> work = memory ? std::move(memory) : std::make_unique<Work>();
  Piece(inputs, begin, end, picture, *work).run();
  memory = std::move(work);
}

}  // namespace meniscus
