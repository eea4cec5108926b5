/// A ray-cast surface that is never there as a whole: slabs of space one after another, composed by depth.
#pragma once

#include "meniscus/surface.h"

namespace meniscus {

/// What is seen of it is what is seen of make_raycast_surface(), to 1e-3 spacings; it takes the memory of one slab at a
/// time and builds each anew for every question, so that many questions are slow. It cannot be marched.
///
/// A slab holds the particles between two planes across an axis, and of its neighbours those that march and normals of
/// its own part of the surface reach. Of what is seen of it, hits outside its own part do not count: those are its cut
/// faces. A cut face hides nothing of its own part: where a ray enters it, the ray is in the water already, as sums
/// over fewer particles are smaller, and the slab that the ray came from knows a nearer hit.
///
/// @param particles  and colours: kept by reference, they must live as long as the surface
/// @param slabs      >= 1; fewer are made where the particles do not spread over so many
/// @throws Error     invalid_argument: as make_raycast_surface(); see() and refine() throw limit_exceeded where the eye
///                   is in the water, whose far side is in no one slab
std::unique_ptr<Surface> make_slab_surface(const Particles& particles, const RaycastOptions& options,
                                           std::span<const vec3> colours, int slabs);

constexpr int kMostSlabs = 256;

/// Slabs that a surface has to be drawn in so that making and seeing it holds no more than `bytes` beside the
/// particles: 1: the whole fits; 0: not even kMostSlabs would do.
/// @param coloured  whether particles have colours
int slabs_within(std::uint64_t bytes, std::uint64_t count, const Bounds& bounds, const RaycastOptions& options,
                 std::uint64_t pixels, bool coloured);

/// The least that slabs_within() would do with: of the whole, or of many slabs.
std::uint64_t least_slab_bytes(std::uint64_t count, const Bounds& bounds, const RaycastOptions& options,
                               std::uint64_t pixels, bool coloured);

/// Bytes held at once for a surface in `slabs` slabs.
std::uint64_t slab_bytes(int slabs, std::uint64_t count, const Bounds& bounds, const RaycastOptions& options,
                         std::uint64_t pixels, bool coloured);

}  // namespace meniscus
