/// The rays of sixteen neighbouring pixels.
#pragma once

#include "surface/packet.h"

namespace meniscus {

/// View::ray() for sixteen points of a picture, to the same bits.
void rays_through(const View& view, const float* x, const float* y, PacketRays& rays);

/// Pixels of a packet of a picture: lane l is at (x + l % 8, y + l / 8).
constexpr int kPacketWidth = 8, kPacketHeight = 2;

/// View::ray() for the pixels of the packet at (x, y), to the same bits; pixels beyond the picture are the last ones
/// within it.
/// @return  lanes of pixels within the picture
PacketMask picture_rays(const View& view, int x, int y, PacketRays& rays);

/// The same for up to sixteen points of a picture, from the `first` on.
PacketMask point_rays(const View& view, std::span<const vec2> points, std::size_t first, PacketRays& rays);

}  // namespace meniscus
