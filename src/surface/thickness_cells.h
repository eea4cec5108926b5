/// Water that is known by numbers of particles: cells amidst well filled ones.
#pragma once

#include "particles/band_grid.h"
#include "particles/band_kinds.h"

namespace meniscus {

/// By block of a grid the cells whose particles are not looked at one by one, how dense their water is and where it
/// ends.
///
/// A particle stands for water half a spacing to all sides of it, so that the water of the particles of a cell ends
/// where the cell does on average only: where a row of particles lies on the side of cells, all of its water belongs to
/// one of them and half of it lies in the other. In views along such sides the rays there would miss half a spacing of
/// water all the way, or meet it twice. So the planes between cells are moved to where the water of the particles
/// beside them ends, as told by those that are kept.
class CountedCells {
 public:
  /// @param spacing  m
  /// @param all      particles of the whole water, of which the grid may hold a part: where there are many, those near
  ///                 the surface that are known one by one are counted as well
  CountedCells(const BandGrid& grid, float spacing, std::size_t all);

  const BandGrid& grid() const { return grid_; }
  const BandBits& cells(int block) const { return blocks_[static_cast<std::size_t>(block)].cells; }
  /// Share of the water's volume in the cells.
  float density(int block) const { return blocks_[static_cast<std::size_t>(block)].density; }
  /// Where the water of the cell, from 0 to 8 along each axis, begins, and that of the one before it ends; world space.
  vec3 corner(int block, glm::ivec3 cell) const {
    const Block& at = blocks_[static_cast<std::size_t>(block)];
    const vec3 moved{at.moved[0][cell.x], at.moved[1][cell.y], at.moved[2][cell.z]};
    return grid_.low(block) + grid_.cell_size() * (vec3(cell) + moved);
  }

 private:
  struct Block {
    BandBits cells{};
    double particles = 0;  ///< in these cells
    float density = 0;
    float moved[3][BandGrid::kSide + 1] = {};  ///< cells, of the planes across each axis
  };
  void choose(float spacing, std::size_t all);
  void count();
  void move_planes(float spacing);
  void join_planes(const std::vector<float>& in_cell);
  /// By block: particles in a cell's volume of the counted cells of it and those around it; 0 where it has none.
  std::vector<float> mean_counts() const;

  const BandGrid& grid_;
  std::vector<Block> blocks_;
};

}  // namespace meniscus
