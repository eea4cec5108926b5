#include "surface/packet_rays.h"

#include <algorithm>
#include <cmath>

namespace meniscus {
namespace {

void set(PacketRays& rays, int l, const Ray& ray) {
  rays.ox[l] = ray.origin.x, rays.oy[l] = ray.origin.y, rays.oz[l] = ray.origin.z;
  rays.dx[l] = ray.direction.x, rays.dy[l] = ray.direction.y, rays.dz[l] = ray.direction.z;
}

}  // namespace

void rays_through(const View& view, const float* at_x, const float* at_y, PacketRays& rays) {
  if (view.projection != Projection::perspective) {
    for (int l = 0; l < kPacket; ++l) set(rays, l, view.ray({at_x[l], at_y[l]}));
    return;
  }
  // View::ray(), operation by operation, in a form that compilers vectorise.
  const float per_pixel = 2.0f * view.half_height / static_cast<float>(view.height);
  const float half_width = 0.5f * static_cast<float>(view.width), half_height = 0.5f * static_cast<float>(view.height);
  const vec3 right = view.right, up = view.up, forward = view.forward, eye = view.eye;
  alignas(64) float dx[kPacket], dy[kPacket], dz[kPacket], per[kPacket];
  for (int l = 0; l < kPacket; ++l) {
    const float p = (at_x[l] - half_width) * per_pixel, q = (half_height - at_y[l]) * per_pixel;
    dx[l] = forward.x + (p * right.x + q * up.x);
    dy[l] = forward.y + (p * right.y + q * up.y);
    dz[l] = forward.z + (p * right.z + q * up.z);
    per[l] = 1.0f / std::sqrt(dx[l] * dx[l] + dy[l] * dy[l] + dz[l] * dz[l]);
  }
  for (int l = 0; l < kPacket; ++l) rays.ox[l] = eye.x, rays.oy[l] = eye.y, rays.oz[l] = eye.z;
  for (int l = 0; l < kPacket; ++l) {
    rays.dx[l] = dx[l] * per[l];
    rays.dy[l] = dy[l] * per[l];
    rays.dz[l] = dz[l] * per[l];
  }
}

PacketMask picture_rays(const View& view, int x, int y, PacketRays& rays) {
  alignas(64) float at_x[kPacket], at_y[kPacket];
  PacketMask mask = 0xffff;
  const bool within = x + kPacketWidth <= view.width && y + kPacketHeight <= view.height;
  for (int l = 0; l < kPacket; ++l) {
    at_x[l] = static_cast<float>(x + l % kPacketWidth) + 0.5f;
    at_y[l] = static_cast<float>(y + l / kPacketWidth) + 0.5f;
  }
  if (!within) {
    const float last_x = static_cast<float>(view.width) - 0.5f, last_y = static_cast<float>(view.height) - 0.5f;
    for (int l = 0; l < kPacket; ++l) {
      if (at_x[l] > last_x || at_y[l] > last_y) mask &= ~(1u << l);
      at_x[l] = std::min(at_x[l], last_x);
      at_y[l] = std::min(at_y[l], last_y);
    }
  }
  rays_through(view, at_x, at_y, rays);
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
