/// Sixteen rays at once into the water of a height field; compiled once for each instruction set.
#pragma once

#include "surface/height_field_rays.h"
#include "surface/packet.h"

namespace meniscus {

/// Where sixteen rays come into the water. What stands in lanes of neither mask means nothing.
struct FieldHits {
  PacketMask hit = 0;         ///< lanes that meet the surface
  PacketMask unsettled = 0;   ///< lanes that HeightFieldRays has to follow one by one
  PacketMask unmeasured = 0;  ///< lanes that meet the surface, whose thickness HeightFieldBody has to tell
  alignas(64) float depth[kPacket];
  alignas(64) float thickness[kPacket];   ///< m of water from there on; only when asked for
  alignas(64) float normal[3 * kPacket];  ///< x, y, z of a lane after one another
};

/// The first place of each ray of `mask`, from its origin on, where it comes into the water, as
/// HeightFieldRays::enter() and normal() tell to rounding.
///
/// The march is in floats, with one level of the pyramid for all lanes; the root that it finds is improved by one step
/// of Newton's in double precision. Lanes where that does not settle, that graze, meet the border of a hole, begin
/// in the water or meet sides that are no surface are unsettled.
/// @param want_thickness  fills in the thickness as well, as HeightFieldBody::length() tells to rounding
void enter_packet(const HeightFieldRays& water, const PacketRays& rays, PacketMask mask, bool want_thickness,
                  FieldHits& hits);

}  // namespace meniscus
