// Small waves on any water: they bend its normals.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/field_axes.h"
#include "meniscus/surface.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Points over which the waves die away towards the border of their field.
constexpr float kFade = 4;

float smooth(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/// The slope of a field of small waves.
class Slopes {
 public:
  explicit Slopes(const HeightField& ripples) : axes_(ripples.up), low_(ripples.low), step_(ripples.step) {
    const int width = ripples.height.width(), height = ripples.height.height();
    if (width < 2 || height < 2) return;
    if (!(step_.x > 0 && step_.y > 0) || !std::isfinite(step_.x + step_.y + low_.x + low_.y))
      throw Error(ErrorCode::invalid_argument,
                  ErrorDetail{"a field of ripples has no place", "steps > 0 and finite bounds", {}, {}, {}, {}, {}});
    // Differences between neighbours, in the middle between them: twice as close as central ones.
    const auto level = [&](int i, int j) {
      const float u = ripples.height(i, j);
      return std::isfinite(u) ? u : 0.0f;
    };
    along_a_ = Image<float>(width - 1, height);
    along_b_ = Image<float>(width, height - 1);
    for (int j = 0; j < height; ++j)
      for (int i = 0; i + 1 < width; ++i) along_a_(i, j) = (level(i + 1, j) - level(i, j)) / step_.x;
    for (int j = 0; j + 1 < height; ++j)
      for (int i = 0; i < width; ++i) along_b_(i, j) = (level(i, j + 1) - level(i, j)) / step_.y;
    last_ = {static_cast<float>(width - 1), static_cast<float>(height - 1)};
    // Means over cells, over 2 x 2 of them, and so on, for pixels that are wider than the waves.
    means_.emplace_back(width - 1, height - 1);
    for (int j = 0; j + 1 < height; ++j)
      for (int i = 0; i + 1 < width; ++i)
        means_[0](i, j) = 0.5f * vec2{along_a_(i, j) + along_a_(i, j + 1), along_b_(i, j) + along_b_(i + 1, j)};
    while (std::max(means_.back().width(), means_.back().height()) > 1) means_.push_back(halved(means_.back()));
  }

  bool empty() const { return means_.empty(); }
  vec3 up() const { return axes_.place(0, 0, 1); }

  /// Horizontal, world space; zero beyond the border.
  /// @param width  m, of what is averaged over
  vec3 at(vec3 point, float width) const {
    const float i = (point[axes_.a] - low_.x) / step_.x, j = (point[axes_.b] - low_.y) / step_.y;
    const float border = std::min({i, j, last_.x - i, last_.y - j});
    if (!(border > 0)) return vec3{0.0f};
    const float cells = width / std::min(step_.x, step_.y);
    vec2 slope{0.0f};
    if (!(cells > 1)) {
      const float part = std::max(2.0f * cells - 1.0f, 0.0f);
      slope = {mean(along_a_, i - 0.5f, j), mean(along_b_, i, j - 0.5f)};
      if (part > 0) slope = glm::mix(slope, mean(means_[0], i - 0.5f, j - 0.5f), part);
    } else {
      const float level = std::min(std::log2(cells), static_cast<float>(means_.size() - 1));
      const auto finer = static_cast<std::size_t>(level);
      const std::size_t coarser = std::min(finer + 1, means_.size() - 1);
      slope = glm::mix(mean_over(finer, i, j), mean_over(coarser, i, j), level - static_cast<float>(finer));
    }
    slope *= smooth(border / kFade);
    return axes_.place(slope.x, slope.y, 0);
  }

 private:
  static Image<vec2> halved(const Image<vec2>& fine) {
    Image<vec2> coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2);
    for (int j = 0; j < coarse.height(); ++j)
      for (int i = 0; i < coarse.width(); ++i) {
        const int i1 = std::min(2 * i + 1, fine.width() - 1), j1 = std::min(2 * j + 1, fine.height() - 1);
        coarse(i, j) = 0.25f * (fine(2 * i, 2 * j) + fine(i1, 2 * j) + fine(2 * i, j1) + fine(i1, j1));
      }
    return coarse;
  }

  vec2 mean_over(std::size_t level, float i, float j) const {
    const float scale = std::ldexp(1.0f, -static_cast<int>(level));
    return mean(means_[level], scale * i - 0.5f, scale * j - 0.5f);
  }

  /// Bilinear; the border's values beyond it.
  template <class T>
  static T mean(const Image<T>& image, float i, float j) {
    i = std::clamp(i, 0.0f, static_cast<float>(image.width() - 1));
    j = std::clamp(j, 0.0f, static_cast<float>(image.height() - 1));
    const int i0 = static_cast<int>(i), j0 = static_cast<int>(j);
    const int i1 = std::min(i0 + 1, image.width() - 1), j1 = std::min(j0 + 1, image.height() - 1);
    const float u = i - static_cast<float>(i0), v = j - static_cast<float>(j0);
    return glm::mix(glm::mix(image(i0, j0), image(i1, j0), u), glm::mix(image(i0, j1), image(i1, j1), u), v);
  }

  FieldAxes axes_;
  vec2 low_, step_, last_{0.0f};
  Image<float> along_a_, along_b_;  ///< between neighbours along a and along b
  std::vector<Image<vec2>> means_;  ///< over squares of 1, 2, 4 ... cells
};

class RippledSurface final : public Surface {
 public:
  RippledSurface(std::unique_ptr<Surface> water, const HeightField& ripples)
      : water_(std::move(water)), slopes_(ripples), up_(slopes_.up()) {}

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    SurfaceBuffers seen = water_->see(view, points, times);
    bend(view, points, seen, times);
    return seen;
  }

  SurfaceBuffers refine(const View& view, const SurfaceBuffers& coarse, std::span<const vec2> points,
                        StageTimes* times) const override {
    SurfaceBuffers seen = water_->refine(view, coarse, points, times);
    bend(view, points, seen, times);
    return seen;
  }

  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    return water_->thickness(view, points, times);
  }
  float spacing() const override { return water_->spacing(); }
  bool can_march() const override { return water_->can_march(); }
  Bounds bounds() const override { return water_->bounds(); }
  const HeightField* height_field() const override { return water_->height_field(); }

  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    water_->crossings(rays, from, limit, inside, found);
    if (slopes_.empty()) return;
    for (std::size_t i = 0; i < found.size(); ++i)
      if (found[i].distance < kInfinity)
        found[i].normal = bent(found[i].normal, rays[i].origin + found[i].distance * rays[i].direction, 0);
  }

 private:
  /// The normal of a plane that is displaced upwards by the waves, over `width` m: n - (n . up) grad u.
  vec3 bent(vec3 normal, vec3 point, float width) const {
    const float upwards = glm::dot(normal, up_);
    if (!(upwards > 0)) return normal;
    const vec3 slope = slopes_.at(point, width);
    if (slope == vec3{0.0f}) return normal;
    return glm::normalize(normal - upwards * slope);
  }

  void bend(const View& view, std::span<const vec2> points, SurfaceBuffers& seen, StageTimes* times) const {
    if (slopes_.empty() || seen.normal.empty()) return;
    const StageTimer timer(times, "ripples");
    // Other small waves may have bent it before.
    if (seen.unbent_normal.empty()) seen.unbent_normal = seen.normal;
    const bool orthographic = view.projection == Projection::orthographic;
    const float pixel = view.pixel_size(1.0f);
    const auto bend_at = [&](std::size_t i, vec2 picture_point) {
      if (!(seen.depth[i] < kInfinity) || seen.normal[i] == vec3{0.0f}) return;
      const Ray ray = view.ray(picture_point);
      // The pixel's print on the water is longer than wide; what lies between both is averaged over.
      const float slant = std::max(std::abs(glm::dot(ray.direction, seen.normal[i])), 0.02f);
      const float width = pixel * (orthographic ? 1.0f : seen.depth[i]) / std::sqrt(slant);
      seen.normal[i] = bent(seen.normal[i], ray.origin + seen.depth[i] * ray.direction, width);
    };
    if (!points.empty()) {
      parallel_for(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) bend_at(i, points[i]);
      });
      return;
    }
    const auto width = static_cast<std::size_t>(view.width);
    parallel_for(static_cast<std::size_t>(view.height), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t y = begin; y < end; ++y)
        for (std::size_t x = 0; x < width; ++x)
          bend_at(y * width + x, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
    });
  }

  std::unique_ptr<Surface> water_;
  Slopes slopes_;
  vec3 up_;
};

}  // namespace

std::unique_ptr<Surface> make_rippled_surface(std::unique_ptr<Surface> water, HeightField ripples) {
  if (!water) throw Error(ErrorCode::invalid_argument, "there is no water for the ripples");
  return std::make_unique<RippledSurface>(std::move(water), ripples);
}

}  // namespace meniscus
