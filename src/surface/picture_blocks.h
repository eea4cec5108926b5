/// Pictures and lists of points cut into packets.
#pragma once

#include "surface/packet.h"

namespace meniscus {

/// Sixteen picture points that are drawn together, and where their results go.
struct Block {
  vec2 points[kPacket];
  std::size_t targets[kPacket];
  PacketMask mask = 0;
};

/// Calls visit(block) for tiles of 4 x 4 pixels of the picture in parallel, or for sixteen points after another.
template <class Visit>
void for_each_block(const View& view, std::span<const vec2> points, Visit visit) {
  if (!points.empty()) {
    parallel_for((points.size() + kPacket - 1) / kPacket, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t at = begin; at < end; ++at) {
        Block block;
        for (std::size_t l = 0; l < kPacket; ++l) {
          const std::size_t i = at * kPacket + l;
          if (i >= points.size()) break;
          block.points[l] = points[i];
          block.targets[l] = i;
          block.mask |= 1u << l;
        }
        visit(block);
      }
    });
    return;
  }
  constexpr int kSide = 4;
  const auto tiles_x = static_cast<std::size_t>((view.width + kSide - 1) / kSide);
  const auto tiles_y = static_cast<std::size_t>((view.height + kSide - 1) / kSide);
  parallel_for(tiles_y * tiles_x, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile) {
      const int x0 = static_cast<int>(tile % tiles_x) * kSide, y0 = static_cast<int>(tile / tiles_x) * kSide;
      Block block;
      for (int l = 0; l < kPacket; ++l) {
        const int x = x0 + l % kSide, y = y0 + l / kSide;
        if (x >= view.width || y >= view.height) continue;
        block.points[l] = {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
        block.targets[l] =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
        block.mask |= 1u << l;
      }
      visit(block);
    }
  });
}

}  // namespace meniscus
