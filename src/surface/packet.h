/// Sixteen points, or places along sixteen rays, at once over one shared list of neighbours; compiled once for each
/// instruction set.
#pragma once

#include <memory>

#include "surface/raycast_field.h"

namespace meniscus {

constexpr int kPacket = 16;

/// A growing array of floats, aligned for vectors; its content is lost when it grows beyond its capacity.
class AlignedFloats {
 public:
  float* data() const { return data_.get(); }
  std::size_t capacity() const { return capacity_; }
  /// Room for at least `count` values; keeps the first `keep`.
  void reserve(std::size_t count, std::size_t keep);

 private:
  struct Free {
    void operator()(float* values) const;
  };
  std::unique_ptr<float[], Free> data_;
  std::size_t capacity_ = 0;
};

/// Particles near a packet: positions relative to nothing (world space), masses, and where particles have sizes of
/// their own (RaycastField::has_sizes) also 1 / h_j and 1 / R_j, 1/m, of kernel and normals; their masses then carry
/// the factor s_j^3 W(0, h_j) / field.scale. One for each thread, kept from packet to packet.
struct PacketList {
  AlignedFloats x, y, z, mass, red, green, blue;
  AlignedFloats per_smoothing, per_normal_radius;  ///< as long as the others if field.has_sizes(), else not used
  std::size_t count = 0;
  /// Whether BandGrid::full_at() may hold where the list is summed: the density is one there, whatever the sum says.
  bool near_full = false;
  void reserve(std::size_t wanted, bool colours);
};

/// Sixteen rays. Lanes that are not in a mask hold copies of a lane that is.
struct PacketRays {
  alignas(64) float ox[kPacket];
  alignas(64) float oy[kPacket];
  alignas(64) float oz[kPacket];
  alignas(64) float dx[kPacket];
  alignas(64) float dy[kPacket];
  alignas(64) float dz[kPacket];
};

struct PacketPoints {
  alignas(64) float x[kPacket];
  alignas(64) float y[kPacket];
  alignas(64) float z[kPacket];
};

using PacketMask = std::uint32_t;  ///< bit l: lane l

/// Corrects depths, m along the rays of `mask`, that are foretold to lie near where the density rises through the
/// iso-value, by one or two steps of Newton's method.
/// @return  lanes for which that came to an end near where it was foretold; the depths of others are not to be used
PacketMask correct_packet(const RaycastField& field, const PacketRays& rays, PacketMask mask, PacketList& list,
                          float* depth);

/// Normals at the points of `mask` ([Xiao2017] 3.3), unit, out of the water; `towards` is taken where the
/// neighbours tell nothing. Points should lie near each other.
void normals_packet(const RaycastField& field, const PacketPoints& points, PacketMask mask, const PacketPoints& towards,
                    PacketList& list, PacketPoints& normals);

/// Density at the points of `mask`, with unit masses when `unit_mass`.
void density_packet(const RaycastField& field, const PacketPoints& points, PacketMask mask, bool unit_mass,
                    PacketList& list, float* density);

/// Density-weighted average of the particles' colours at the points of `mask`.
void colours_packet(const RaycastField& field, const PacketPoints& points, PacketMask mask, PacketList& list,
                    PacketPoints& colours);

}  // namespace meniscus
