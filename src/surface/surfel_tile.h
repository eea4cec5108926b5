/// The innermost loops of drawing surfels; compiled once for each instruction set.
#pragma once

#include <cstdint>
#include <span>

#include "meniscus/base.h"

namespace meniscus {

constexpr int kSurfelTile = 32;  ///< px
/// Values behind the last sample of a tile that vectors may read and write back.
constexpr std::size_t kSampleRoom = 16;

/// A surfel in camera space (x right, y up, z forward), its normal towards the eye's side: the surface
/// n . q + q . S q / 2 = 0 within the radius of its centre, q from there.
struct SurfelDisc {
  vec3 centre, normal;
  vec3 straight;                ///< S: xx, yy, zz
  vec3 skew;                    ///< S: yz, zx, xy
  vec3 shaded;                  ///< the normal that is blended, when it is not the disc's own
  float radius2 = 0;            ///< m^2
  std::int16_t x0, x1, y0, y1;  ///< pixels that it may cover, both ends included; x0 > x1: none
};

/// The samples of one tile, sorted by pixel; arrays of `count` values and kSampleRoom more.
struct SurfelSamples {
  std::size_t count = 0;
  const std::uint32_t* start = nullptr;       ///< by pixel of the tile, and one more
  const float *x = nullptr, *y = nullptr;     ///< on the plane at distance 1, or in metres in an orthographic view
  const float* length = nullptr;              ///< of the ray's direction (x, y, 1), or 1
  const float* per_length2 = nullptr;         ///< 1 / length^2
  float *nearest = nullptr, *last = nullptr;  ///< in lengths of the direction; set to +infinity and 0
  float *nx = nullptr, *ny = nullptr, *nz = nullptr, *depth = nullptr, *weight = nullptr;  ///< sums; set to 0
};

struct SurfelTile {
  int x0 = 0, y0 = 0;  ///< px
  bool perspective = true;
  bool own_normals = false;  ///< blend the discs' own, camera space
  float epsilon = 0;         ///< m
  std::span<const SurfelDisc> discs;
  std::span<const std::uint32_t> mine;  ///< those of the tile
};

/// The passes of [Iwasaki2008] 5.2: nearest and last meeting of each sample with a disc, then the sums of eq. 2 over
/// the meetings within epsilon of the nearest. Both take the discs in the order of `mine`.
void draw_surfels(const SurfelTile& tile, const SurfelSamples& samples);

}  // namespace meniscus
