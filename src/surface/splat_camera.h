/// Camera space of a picture that is splatted into, and where in it a sphere may lie.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

/// Camera space: x right, y up, z forward, from the eye, m. Every `stride`-th pixel in both directions is a sample, at
/// the centre of a block of stride x stride pixels. The ray of sample (i, j) has the coordinates u0 + i du and
/// v0 + j dv: in the plane at distance 1 (perspective), or where it starts (orthographic).
struct SplatCamera {
  explicit SplatCamera(const View& view, int stride)
      : perspective(view.projection == Projection::perspective),
        eye(view.eye),
        right(view.right),
        up(view.up),
        forward(view.forward) {
    width = (view.width + stride - 1) / stride;
    height = (view.height + stride - 1) / stride;
    const float pixel = 2.0f * view.half_height / static_cast<float>(view.height);
    du = pixel * static_cast<float>(stride);
    dv = -du;
    u0 = (0.5f * static_cast<float>(stride) - 0.5f * static_cast<float>(view.width)) * pixel;
    v0 = -(0.5f * static_cast<float>(stride) - 0.5f * static_cast<float>(view.height)) * pixel;
  }
  vec3 to_camera(vec3 point) const {
    const vec3 offset = point - eye;
    return {glm::dot(offset, right), glm::dot(offset, up), glm::dot(offset, forward)};
  }

  bool perspective;
  int width, height;  ///< samples
  float u0, v0, du, dv;
  vec3 eye, right, up, forward;
};

/// Samples that something may cover, both ends included; x0 > x1 when there are none.
struct SampleRect {
  std::uint16_t x0 = 1, x1 = 0, y0 = 1, y1 = 0;
  bool empty() const { return x0 > x1; }
};

/// The samples within [u_low, u_high] x [v_low, v_high] of the camera's coordinates.
inline SampleRect samples_within(const SplatCamera& camera, float u_low, float u_high, float v_low, float v_high) {
  // A hundredth of a sample more than needed keeps rounding from losing one.
  const float x0 = std::ceil((u_low - camera.u0) / camera.du - 0.01f);
  const float x1 = std::floor((u_high - camera.u0) / camera.du + 0.01f);
  const float y0 = std::ceil((v_high - camera.v0) / camera.dv - 0.01f);
  const float y1 = std::floor((v_low - camera.v0) / camera.dv + 0.01f);
  const float last_x = static_cast<float>(camera.width - 1), last_y = static_cast<float>(camera.height - 1);
  if (!(x0 <= last_x && x1 >= 0.0f && y0 <= last_y && y1 >= 0.0f && x0 <= x1 && y0 <= y1)) return {};
  return {static_cast<std::uint16_t>(std::max(x0, 0.0f)), static_cast<std::uint16_t>(std::min(x1, last_x)),
          static_cast<std::uint16_t>(std::max(y0, 0.0f)), static_cast<std::uint16_t>(std::min(y1, last_y))};
}

/// A box along the axes of the world, by its middle and half its extent, m.
struct SplatBox {
  vec3 middle, half;
};

/// Samples whose rays may meet the box: those of the box along the camera's axes around it.
inline SampleRect samples_of(const SplatCamera& camera, const SplatBox& box) {
  const vec3 c = camera.to_camera(box.middle);
  const vec3 h{glm::dot(glm::abs(camera.right), box.half), glm::dot(glm::abs(camera.up), box.half),
               glm::dot(glm::abs(camera.forward), box.half)};
  const float near = c.z - h.z, far = c.z + h.z;
  if (!(far > 0.0f)) return {};
  if (!camera.perspective) return samples_within(camera, c.x - h.x, c.x + h.x, c.y - h.y, c.y + h.y);
  constexpr float kAll = 1e30f;
  if (!(near > 1e-5f * far)) return samples_within(camera, -kAll, kAll, -kAll, kAll);
  const auto low = [&](float value) { return value / (value < 0.0f ? near : far); };
  const auto high = [&](float value) { return value / (value < 0.0f ? far : near); };
  return samples_within(camera, low(c.x - h.x), high(c.x + h.x), low(c.y - h.y), high(c.y + h.y));
}

/// Where the entries of each tile begin in a list sorted by tile, and one more.
/// @param counters  entries by part of the work and tile; become the places where those of each part begin
inline std::vector<std::uint32_t> tile_starts(std::vector<std::vector<std::uint32_t>>& counters, std::size_t tiles) {
  std::vector<std::uint32_t> start(tiles + 1);
  std::uint32_t sum = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    start[tile] = sum;
    for (auto& mine : counters) {
      const std::uint32_t in_part = mine[tile];
      mine[tile] = sum;
      sum += in_part;
    }
  }
  start[tiles] = sum;
  return start;
}

}  // namespace meniscus
