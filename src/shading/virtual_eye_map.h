/// A cube environment map that is drawn where it is looked up.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

/// What a map shows in one direction.
struct MapTexel {
  vec3 radiance{0.0f};  ///< linear, times alpha
  float alpha = 0;      ///< part of what is behind it that is hidden; 0: nothing is there
  float distance = std::numeric_limits<float>::infinity();  ///< m; what of is for the one who draws to say
  vec3 normal{0.0f};                                        ///< unit, of the flat face
  std::int32_t object = -1;
};

/// Six faces of size x size cells with texels at the cells' corners, so that neighbouring faces share those of their
/// common edge and lookups between them need no border. Face 2 k looks along axis k, 2 k + 1 against it. Tiles of
/// kTile x kTile cells are drawn when they are first looked at, by whichever thread comes first; what they hold does
/// not depend on that.
class CubeMap {
 public:
  static constexpr int kTile = 16;  ///< cells
  static constexpr int kSide = kTile + 1;
  /// Draws the texels of a tile: directions in, unit; texels out. False: there is nothing in any of them.
  using Draw = std::function<bool(std::span<const vec3> directions, std::span<MapTexel> texels)>;

  /// @param size  cells along a face, >= 1
  CubeMap(int size, Draw draw);
  ~CubeMap();
  CubeMap(const CubeMap&) = delete;
  CubeMap& operator=(const CubeMap&) = delete;

  /// The four texels around a direction and their weights; null where there is nothing.
  struct Cell {
    const MapTexel* first = nullptr;  ///< of the upper left one
    float x = 0, y = 0;               ///< between the left and the right, the upper and the lower ones

    const MapTexel& texel(int k) const { return first[(k & 1) + (k >> 1) * kSide]; }
    float weight(int k) const { return (k & 1 ? x : 1 - x) * (k >> 1 ? y : 1 - y); }
    const MapTexel& nearest() const { return texel((x >= 0.5f ? 1 : 0) + (y >= 0.5f ? 2 : 0)); }
  };
  /// @param direction  of any length but zero
  Cell at(vec3 direction) const;

  int size() const { return size_; }
  /// Angle between neighbouring texels in the middle of a face, radians.
  float texel_angle() const { return 2.0f / static_cast<float>(size_); }
  /// Tiles that have been drawn, and those of them that hold something.
  std::size_t drawn_tiles() const { return drawn_.load(); }
  std::size_t filled_tiles() const { return filled_.load(); }

 private:
  using Tile = std::array<MapTexel, static_cast<std::size_t>(kSide) * kSide>;

  const Tile* tile(std::size_t index) const;
  const Tile* draw_tile(std::size_t index) const;

  int size_ = 0, tiles_across_ = 0;
  Draw draw_;
  mutable std::vector<std::atomic<const Tile*>> tiles_;
  mutable std::atomic<std::size_t> drawn_{0}, filled_{0};
};

/// Directions no farther than an angle from an axis.
struct Cone {
  vec3 axis{0, 0, 1};    ///< unit
  float half_angle = 0;  ///< radians
};

/// A map for each cone, so that no two that meet share one: each takes the first in which it is free.
std::vector<std::size_t> map_layers(std::span<const Cone> cones);

}  // namespace meniscus
