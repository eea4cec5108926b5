#include "surface/picture_march.h"

#include "surface/picture_blocks.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Gives the packet's rays; lanes that are not in the mask repeat the first one that is.
void set_rays(const View& view, const Block& block, PacketRays& rays) {
  const int first = __builtin_ctz(block.mask);
  for (int l = 0; l < kPacket; ++l) {
    const Ray ray = view.ray(block.points[(block.mask >> l) & 1u ? l : first]);
    rays.ox[l] = ray.origin.x;
    rays.oy[l] = ray.origin.y;
    rays.oz[l] = ray.origin.z;
    rays.dx[l] = ray.direction.x;
    rays.dy[l] = ray.direction.y;
    rays.dz[l] = ray.direction.z;
  }
}

}  // namespace

void march_picture(const RaycastField& field, const View& view, std::span<const vec2> points, SurfaceBuffers& buffers) {
  const int width = buffers.entry.width(), height = buffers.entry.height();
  buffers.depth = Image<float>(width, height, kInfinity);
  buffers.coverage = Image<float>(width, height, 0.0f);
  for_each_block(view, points, [&](const Block& block) {
    alignas(64) float entry[kPacket], exit[kPacket], depth[kPacket];
    PacketMask mask = 0;
    for (int l = 0; l < kPacket; ++l) {
      entry[l] = exit[l] = 0.0f;
      if (!((block.mask >> l) & 1u)) continue;
      entry[l] = buffers.entry[block.targets[l]];
      exit[l] = buffers.exit[block.targets[l]];
      if (entry[l] <= exit[l]) mask |= 1u << l;
    }
    if (mask == 0) return;
    PacketRays rays;
    set_rays(view, block, rays);
    for (int l = 0; l < kPacket; ++l)
      if (!((mask >> l) & 1u)) entry[l] = entry[__builtin_ctz(mask)];
    thread_local PacketList list;
    march_packet(field, rays, mask, entry, exit, buffers.eye_in_water, list, depth);
    for (int l = 0; l < kPacket; ++l)
      if (((mask >> l) & 1u) && depth[l] < kInfinity) {
        buffers.depth[block.targets[l]] = depth[l];
        buffers.coverage[block.targets[l]] = 1.0f;
      }
  });
}

}  // namespace meniscus
