#include "shading/plane_light.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace meniscus {
namespace {

constexpr int kMostCells = 512;
constexpr int kCells = PlaneLight::kTile - 1;
/// Points are looked at from this far, of the planes' size.
constexpr float kLift = 2e-4f;

}  // namespace

PlaneLight::PlaneLight(const Scene& scene, const Bounds& region, float step) : white_(scene) {
  Tank tank = scene.tank();
  const Ground& ground = scene.ground();
  tolerance_ = kLift * glm::length(region.extent());
  if (tank.style == TankStyle::tiled && !tank.inside.empty()) {
    tolerance_ = std::max(tolerance_, kLift * glm::length(tank.inside.extent()));
    for (int axis = 0; axis < 3; ++axis) {
      add(axis, 1.0f, tank.inside.low[axis], tank.inside, step);
      if (!(tank.up[axis] > 0.5f)) add(axis, -1.0f, tank.inside.high[axis], tank.inside, step);
    }
  }
  for (int axis = 0; axis < 3; ++axis)
    if (ground.visible && std::abs(ground.up[axis]) > 0.99999f && !region.empty())
      add(axis, ground.up[axis] > 0 ? 1.0f : -1.0f, ground.height * ground.up[axis], region, step);
  if (planes_.empty()) return;
  tank.albedo = tank.joint_albedo = vec3{1.0f};
  if (tank.style != TankStyle::none) white_.set_tank(tank);
}

PlaneLight::~PlaneLight() {
  for (const auto& plane : planes_)
    for (const auto& square : plane->squares) delete square.load();
}

void PlaneLight::add(int axis, float sign, float level, const Bounds& region, float step) {
  auto plane = std::make_unique<Plane>();
  plane->axis = axis;
  plane->sign = sign;
  plane->level = level;
  const int s = (axis + 1) % 3, t = (axis + 2) % 3;
  plane->low = {region.low[s], region.low[t]};
  const vec2 extent{region.high[s] - region.low[s], region.high[t] - region.low[t]};
  if (!(extent.x > 0 && extent.y > 0 && extent.x < 1e6f && extent.y < 1e6f)) return;
  const auto cells = [&](float length) {
    return static_cast<int>(std::clamp(std::ceil(length / step), 4.0f, static_cast<float>(kMostCells)));
  };
  plane->width = cells(extent.x);
  plane->height = cells(extent.y);
  plane->step = extent / vec2{plane->width, plane->height};
  plane->inverse = 1.0f / plane->step;
  plane->across = (plane->width + kCells - 1) / kCells;
  const int down = (plane->height + kCells - 1) / kCells;
  plane->squares =
      std::vector<std::atomic<const Square*>>(static_cast<std::size_t>(plane->across) * static_cast<std::size_t>(down));
  by_face_[static_cast<std::size_t>(2 * axis + (sign > 0 ? 1 : 0))].push_back(plane.get());
  planes_.push_back(std::move(plane));
}

bool PlaneLight::at(std::int32_t face, vec3 point, vec3& irradiance) const {
  const int axis = face >> 1;
  const vec3 turned = axis == 0 ? point : axis == 1 ? vec3{point.y, point.z, point.x} : vec3{point.z, point.x, point.y};
  for (const Plane* held : by_face_[static_cast<std::size_t>(face)]) {
    const Plane& plane = *held;
    if (!(std::abs(turned.x - plane.level) <= tolerance_)) continue;
    const float u = (turned.y - plane.low.x) * plane.inverse.x;
    const float v = (turned.z - plane.low.y) * plane.inverse.y;
    // A little beyond the edge, as planes overlap.
    if (!(u >= -0.1f && v >= -0.1f && u <= static_cast<float>(plane.width) + 0.1f &&
          v <= static_cast<float>(plane.height) + 0.1f))
      continue;
    const int x = std::clamp(static_cast<int>(u), 0, plane.width - 1);
    const int y = std::clamp(static_cast<int>(v), 0, plane.height - 1);
    const float fx = std::clamp(u - static_cast<float>(x), 0.0f, 1.0f);
    const float fy = std::clamp(v - static_cast<float>(y), 0.0f, 1.0f);
    const int column = x / kCells, row = y / kCells;
    const vec3* corner = square(plane, column, row).data() + (y - row * kCells) * kTile + (x - column * kCells);
    irradiance =
        (1 - fy) * ((1 - fx) * corner[0] + fx * corner[1]) + fy * ((1 - fx) * corner[kTile] + fx * corner[kTile + 1]);
    return true;
  }
  return false;
}

const PlaneLight::Square& PlaneLight::square(const Plane& plane, int x, int y) const {
  auto& place = const_cast<std::atomic<const Square*>&>(
      plane
          .squares[static_cast<std::size_t>(y) * static_cast<std::size_t>(plane.across) + static_cast<std::size_t>(x)]);
  const Square* held = place.load(std::memory_order_acquire);
  if (held) [[likely]]
    return *held;
  // Two threads that come at once both fill it, with the same values; the first one's is kept.
  auto fresh = std::make_unique<Square>();
  fill(plane, x, y, *fresh);
  if (place.compare_exchange_strong(held, fresh.get(), std::memory_order_acq_rel)) return *fresh.release();
  return *held;
}

void PlaneLight::fill(const Plane& plane, int x, int y, Square& square) const {
  std::array<Ray, static_cast<std::size_t>(kTile) * kTile> rays;
  vec3 normal{0.0f};
  normal[plane.axis] = plane.sign;
  for (int k = 0; k < kTile * kTile; ++k) {
    const int i = std::min(x * kCells + k % kTile, plane.width), j = std::min(y * kCells + k / kTile, plane.height);
    vec3 point;
    point[plane.axis] = plane.level + plane.sign * tolerance_;
    point[(plane.axis + 1) % 3] = plane.low.x + plane.step.x * static_cast<float>(i);
    point[(plane.axis + 2) % 3] = plane.low.y + plane.step.y * static_cast<float>(j);
    rays[static_cast<std::size_t>(k)] = {point, -normal};
  }
  const Beam beam{std::min(plane.step.x, plane.step.y), 0.0f};
  white_.radiance(rays, beam, square);
  std::array<SolidHit, static_cast<std::size_t>(kTile) * kTile> hits;
  white_.hits(rays, beam, hits);
  for (std::size_t k = 0; k < square.size(); ++k) {
    const SolidHit& hit = hits[k];
    // Where something stands on the plane its own light would do; nothing is seen there.
    if (hit.found() && hit.presence >= 1.0f && std::min({hit.albedo.x, hit.albedo.y, hit.albedo.z}) > 1e-3f)
      square[k] *= std::numbers::pi_v<float> / hit.albedo;
    else
      square[k] = white_.irradiance(rays[k].origin - tolerance_ * normal, normal, normal);
  }
}

}  // namespace meniscus
