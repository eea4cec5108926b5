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
    along_a_.push_back(Image<float>(width - 1, height));
    along_b_.push_back(Image<float>(width, height - 1));
    for (int j = 0; j < height; ++j)
      for (int i = 0; i + 1 < width; ++i) along_a_[0](i, j) = (level(i + 1, j) - level(i, j)) / step_.x;
    for (int j = 0; j + 1 < height; ++j)
      for (int i = 0; i < width; ++i) along_b_[0](i, j) = (level(i, j + 1) - level(i, j)) / step_.y;
    last_ = {static_cast<float>(width - 1), static_cast<float>(height - 1)};
  }

  bool empty() const { return along_a_.empty(); }
  vec3 up() const { return axes_.place(0, 0, 1); }

  /// Horizontal, world space; zero beyond the border.
  vec3 at(vec3 point) const {
    const float i = (point[axes_.a] - low_.x) / step_.x, j = (point[axes_.b] - low_.y) / step_.y;
    const float border = std::min({i, j, last_.x - i, last_.y - j});
    if (!(border > 0)) return vec3{0.0f};
    const float part = smooth(border / kFade);
    return axes_.place(part * mean(along_a_[0], i - 0.5f, j), part * mean(along_b_[0], i, j - 0.5f), 0);
  }

 private:
  static float mean(const Image<float>& image, float i, float j) {
    i = std::clamp(i, 0.0f, static_cast<float>(image.width() - 1));
    j = std::clamp(j, 0.0f, static_cast<float>(image.height() - 1));
    const int i0 = static_cast<int>(i), j0 = static_cast<int>(j);
    const int i1 = std::min(i0 + 1, image.width() - 1), j1 = std::min(j0 + 1, image.height() - 1);
    const float u = i - static_cast<float>(i0), v = j - static_cast<float>(j0);
    return glm::mix(glm::mix(image(i0, j0), image(i1, j0), u), glm::mix(image(i0, j1), image(i1, j1), u), v);
  }

  FieldAxes axes_;
  vec2 low_, step_, last_{0.0f};
  std::vector<Image<float>> along_a_, along_b_;
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
        found[i].normal = bent(found[i].normal, rays[i].origin + found[i].distance * rays[i].direction);
  }

 private:
  /// The normal of a plane that is displaced upwards by the waves: n - (n . up) grad u.
  vec3 bent(vec3 normal, vec3 point) const {
    const float upwards = glm::dot(normal, up_);
    if (!(upwards > 0)) return normal;
    const vec3 slope = slopes_.at(point);
    if (slope == vec3{0.0f}) return normal;
    return glm::normalize(normal - upwards * slope);
  }

  void bend(const View& view, std::span<const vec2> points, SurfaceBuffers& seen, StageTimes* times) const {
    if (slopes_.empty() || seen.normal.empty()) return;
    const StageTimer timer(times, "ripples");
    // Other small waves may have bent it before.
    if (seen.unbent_normal.empty()) seen.unbent_normal = seen.normal;
    const auto bend_at = [&](std::size_t i, vec2 picture_point) {
      if (!(seen.depth[i] < kInfinity) || seen.normal[i] == vec3{0.0f}) return;
      const Ray ray = view.ray(picture_point);
      seen.normal[i] = bent(seen.normal[i], ray.origin + seen.depth[i] * ray.direction);
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
