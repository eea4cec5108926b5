#include "surface/packet_rays.h"

#include <algorithm>
#include <cmath>

namespace meniscus {
namespace {

void set(PacketRays& rays, int l, const Ray& ray) {
  rays.ox[l] = ray.origin.x, rays.oy[l] = ray.origin.y, rays.oz[l] = ray.origin.z;
  rays.dx[l] = ray.direction.x, rays.dy[l] = ray.direction.y, rays.dz[l] = ray.direction.z;
}

/// A perspective view's, lane by lane as View::ray(), in a form that compilers vectorise.
void perspective_rays(const View& view, const float* at_x, const float* at_y, PacketRays& rays) {
  const float per_pixel = 2.0f * view.half_height / static_cast<float>(view.height);
  const float half_width = 0.5f * static_cast<float>(view.width), half_height = 0.5f * static_cast<float>(view.height);
  const vec3 right = view.right, up = view.up, forward = view.forward, eye = view.eye;
  for (int l = 0; l < kPacket; ++l) {
    const float p = (at_x[l] - half_width) * per_pixel, q = (half_height - at_y[l]) * per_pixel;
    const float x = forward.x + (p * right.x + q * up.x), y = forward.y + (p * right.y + q * up.y),
                z = forward.z + (p * right.z + q * up.z);
    const float per = 1.0f / std::sqrt(x * x + y * y + z * z);
    rays.ox[l] = eye.x, rays.oy[l] = eye.y, rays.oz[l] = eye.z;
    rays.dx[l] = x * per, rays.dy[l] = y * per, rays.dz[l] = z * per;
  }
}

}  // namespace

PacketMask picture_rays(const View& view, int x, int y, PacketRays& rays) {
  alignas(64) float at_x[kPacket], at_y[kPacket];
  PacketMask mask = 0;
  for (int l = 0; l < kPacket; ++l) {
    const int px = x + l % kPacketWidth, py = y + l / kPacketWidth;
    mask |= px < view.width && py < view.height ? 1u << l : 0u;
    at_x[l] = static_cast<float>(std::min(px, view.width - 1)) + 0.5f;
    at_y[l] = static_cast<float>(std::min(py, view.height - 1)) + 0.5f;
  }
  if (view.projection == Projection::perspective)
    perspective_rays(view, at_x, at_y, rays);
  else
    for (int l = 0; l < kPacket; ++l) set(rays, l, view.ray({at_x[l], at_y[l]}));
  return mask;
}

PacketMask point_rays(const View& view, std::span<const vec2> points, std::size_t first, PacketRays& rays) {
  PacketMask mask = 0;
  for (int l = 0; l < kPacket; ++l) {
    const std::size_t i = first + static_cast<std::size_t>(l);
    mask |= i < points.size() ? 1u << l : 0u;
    set(rays, l, view.ray(points[std::min(i, points.size() - 1)]));
  }
  return mask;
}

}  // namespace meniscus
