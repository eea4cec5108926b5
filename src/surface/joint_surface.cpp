// Two waters as one surface: any water, and puddles apart from it.
#include <algorithm>
#include <glm/geometric.hpp>

#include "base/field_axes.h"
#include "surface/height_field_body.h"

namespace meniscus {
namespace {

/// Takes from `other` what is nearer there, or nearer and known there alone.
void take_nearer(const SurfaceBuffers& other, SurfaceBuffers& seen) {
  const std::size_t size = seen.depth.size();
  // Where only the other water has them.
  if (!other.colour.empty() && seen.colour.empty())
    seen.colour = Image<vec3>(seen.depth.width(), seen.depth.height(), vec3{1.0f});
  for (std::size_t i = 0; i < size; ++i) {
    if (!(other.depth[i] < seen.depth[i])) continue;
    seen.depth[i] = other.depth[i];
    seen.coverage[i] = other.coverage[i];
    if (!seen.normal.empty() && !other.normal.empty()) seen.normal[i] = other.normal[i];
    if (!seen.unbent_normal.empty())
      seen.unbent_normal[i] = other.unbent_normal.empty() ? other.normal[i] : other.unbent_normal[i];
    if (!seen.thickness.empty()) seen.thickness[i] = other.thickness.empty() ? 0.0f : other.thickness[i];
    if (!seen.colour.empty()) seen.colour[i] = other.colour.empty() ? vec3{1.0f} : other.colour[i];
  }
}

class JointSurface final : public Surface {
 public:
  JointSurface(std::unique_ptr<Surface> water, HeightField puddles)
      : water_(std::move(water)),
        puddles_(make_height_field_surface(std::move(puddles), false)),
        body_(*puddles_->height_field()) {}

  SurfaceBuffers see(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    return joined(water_->see(view, points, times), puddles_->see(view, points, times));
  }

  SurfaceBuffers refine(const View& view, const SurfaceBuffers& coarse, std::span<const vec2> points,
                        StageTimes* times) const override {
    // The water's own first and last places are in `coarse` as it left them.
    return joined(water_->refine(view, coarse, points, times), puddles_->see(view, points, times));
  }

  Image<float> thickness(const View& view, std::span<const vec2> points, StageTimes* times) const override {
    return joined(water_->see(view, points, times), puddles_->see(view, points, times)).thickness;
  }

  float spacing() const override { return water_->spacing(); }
  bool can_march() const override { return water_->can_march(); }

  Bounds bounds() const override {
    Bounds box = water_->bounds();
    box.add(puddles_->bounds());
    return box;
  }

  void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                 std::span<const std::uint8_t> inside, std::span<Crossing> found) const override {
    if (from.size() != rays.size() || limit.size() != rays.size() || inside.size() != rays.size() ||
        found.size() != rays.size())
      throw Error(ErrorCode::invalid_argument, "the lists of rays to follow have different lengths");
    // Rays in a puddle have nothing to do with the water, rays in the water nothing with the puddles.
    std::vector<std::size_t> to_water, to_puddles;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const bool in_puddle = inside[i] != 0 && starts_in_puddle(rays[i], std::max(from[i], 0.0f));
      if (!in_puddle) to_water.push_back(i);
      if (in_puddle || inside[i] == 0) to_puddles.push_back(i);
    }
    std::fill(found.begin(), found.end(), Crossing{});
    const auto follow = [&](const Surface& surface, const std::vector<std::size_t>& chosen) {
      std::vector<Ray> some_rays;
      std::vector<float> some_from, some_limit;
      std::vector<std::uint8_t> some_inside;
      for (const std::size_t i : chosen) {
        some_rays.push_back(rays[i]);
        some_from.push_back(from[i]);
        some_limit.push_back(std::min(limit[i], found[i].distance));
        some_inside.push_back(inside[i]);
      }
      std::vector<Crossing> some_found(chosen.size());
      surface.crossings(some_rays, some_from, some_limit, some_inside, some_found);
      for (std::size_t k = 0; k < chosen.size(); ++k)
        if (some_found[k].distance < found[chosen[k]].distance) found[chosen[k]] = some_found[k];
    };
    follow(*puddles_, to_puddles);
    follow(*water_, to_water);
  }

 private:
  static SurfaceBuffers joined(SurfaceBuffers water, SurfaceBuffers puddles) {
    // An eye in the water sees nothing of the other before it looks out.
    if (water.eye_in_water) return water;
    if (puddles.eye_in_water) {
      puddles.entry = std::move(water.entry);
      puddles.exit = std::move(water.exit);
      return puddles;
    }
    take_nearer(puddles, water);
    return water;
  }

  /// Whether a ray that is in some water starts in a puddle: at its start, or as soon as rounding may hide that.
  bool starts_in_puddle(const Ray& ray, float from) const {
    const FieldRay in_field = body_.field_ray(ray);
    const vec3 start = ray.origin + from * ray.direction;
    const double rounding =
        1e-5 * static_cast<double>(std::max({1.0f, std::abs(start.x), std::abs(start.y), std::abs(start.z), from}));
    const double t = static_cast<double>(from);
    return body_.inside(in_field, t) || body_.inside(in_field, t + rounding) ||
           body_.inside(in_field, t + 10 * rounding);
  }

  std::unique_ptr<Surface> water_;
  std::unique_ptr<Surface> puddles_;
  HeightFieldBody body_;  ///< of the puddles
};

}  // namespace

std::unique_ptr<Surface> make_joint_surface(std::unique_ptr<Surface> water, HeightField puddles) {
  const bool dry = puddles.empty() || puddles.bounds().empty();
  if (water && dry) return water;
  if (!water || water->bounds().empty()) return make_height_field_surface(std::move(puddles), false);
  return std::make_unique<JointSurface>(std::move(water), std::move(puddles));
}

}  // namespace meniscus
