/// Pixels of water side by side, shaded together: one interface, the far side guessed from the thickness, as
/// transparent_radiance() and opaque_radiance() do it a pixel at a time.                      [Xiao2017] 3.4
#pragma once

#include "meniscus/shading.h"
#include "scene/ray_block.h"

namespace meniscus {

/// What all pixels of a picture have in common.
struct BlockOptics {
  const Material& material;
  FresnelFormula fresnel = FresnelFormula::exact;
  Beam beam;                  ///< of a pixel at its ray's origin
  vec3 up{0, 1, 0};           ///< of the ground, unit
  vec3 sun{0, 1, 0};          ///< towards it, unit
  vec3 sun_irradiance{0.0f};  ///< on a surface that faces it
};

/// Up to 64 pixels; lanes from `count` to the next multiple of 16 are copies of the last.
struct WaterBlock {
  static constexpr int kLanes = RayBlock::kRays;
  using Lanes = float[kLanes];

  // Given.
  int count = 0;
  std::size_t indices[kLanes];  ///< of the pixels
  RayBlock rays;                ///< from the eye
  alignas(64) Lanes depth;      ///< m along the ray
  alignas(64) Lanes thickness;  ///< m; anything but a number > 0 is none
  alignas(64) Lanes variance;   ///< see NormalVariance
  BlockVectors normal;          ///< out of the water; turned to the eye by bend()

  // Found by bend().
  RayBlock inside;             ///< refracted rays, from the surface
  RayBlock mirror;             ///< mirrored rays
  BlockBeams mirror_beams;     ///< of those
  RayBlock onward;             ///< the straight rays, from the surface; go_on() changes them
  alignas(64) Lanes path;      ///< m through the water if it ends where the thickness says
  alignas(64) Lanes slopes;    ///< radians by which directions differ within a pixel
  alignas(64) Lanes mirrored;  ///< reflectance, with the material's specular factor
  alignas(64) Lanes glare;     ///< rad^2, variance of what the mirror shows of the sun
  bool undersides = false;     ///< some normals look down

  // Found by lean().
  alignas(64) Lanes straight;  ///< m to the floor along the straight rays
  alignas(64) Lanes contact;   ///< weight of that floor, see Contact

  // Found by go_on().
  BlockBeams beams;  ///< of `onward`
};

/// Normals and their variance at the pixels from lane `lane` on, which is a multiple of 16, as far as they are a row
/// within the picture's edges. @return  how many there are; none: they have to be found one by one
std::size_t load_normals(const Image<vec3>& normals, std::size_t lane, WaterBlock& block);
void bend(const BlockOptics& optics, WaterBlock& block);
/// What is seen of the floor under bodies that stand on it. @param floor  m from the surface along the straight rays
/// @return  whether anything is
bool lean(const BlockOptics& optics, const float* floor, WaterBlock& block);
/// Where the rays go on after the water. @param to_ground  m along the refracted rays
void go_on(const BlockOptics& optics, const float* to_ground, WaterBlock& block);
/// The pixels' radiance.
/// @param sky     irradiance on the normals
/// @param behind  radiance of `onward`; null: opaque
/// @param floor   radiance along the straight rays; null where lean() found nothing
/// @param image   radiance of `mirror`; null: no mirror image
void put_together(const BlockOptics& optics, const WaterBlock& block, const BlockVectors& sky,
                  const BlockVectors* behind, const BlockVectors* floor, const BlockVectors* image, BlockVectors& seen);

/// Writes pixels of a picture. @param indices  of `count` pixels, increasing
void store_pixels(const std::size_t* indices, int count, const BlockVectors& colours, vec3* picture);

}  // namespace meniscus
