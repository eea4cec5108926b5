/// Who is within the smoothing length of whom: found once a step, read by every loop over pairs.
#pragma once

#include <memory>
#include <optional>

#include "particles/grid.h"
#include "sim/fluid.h"

namespace meniscus {

/// The neighbours of one particle, itself left out. Lists are filled up to whole vectors of 16 with the index size() at
/// the squared distance 4 h^2, where the kernels vanish: the loops over pairs keep one particle more, far away from
/// all.
struct NeighbourList {
  const std::int32_t* index;  ///< in sorted order
  const float* r2;            ///< m^2, at the time of the search
  std::size_t count;
};

class Neighbours {
 public:
  /// Particles that one thread takes at a time: lists, sums of impulses and loops are kept by these pieces.
  static constexpr std::size_t kPiece = 256;
  /// More neighbours than these are left out: water pressed to ten times its density.
  static constexpr std::size_t kMost = 1023;

  /// Sorts the particles by cells of edge `h` and finds the neighbours of each.
  void find(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z, float h);

  std::size_t size() const { return count_.size(); }
  std::size_t pieces() const { return (size() + kPiece - 1) / kPiece; }
  const ParticleGrid& grid() const { return *grid_; }
  NeighbourList of(std::size_t sorted) const {
    const Lists& lists = lists_[sorted / kPiece];
    return {lists.index.get() + first_[sorted], lists.r2.get() + first_[sorted], count_[sorted]};
  }
  /// Particles begin .. end that are close together, and the box around them.
  struct Group {
    std::size_t begin, end;
    Bounds box;
  };
  /// All particles of a piece in groups, in sorted order.
  const std::vector<Group>& groups(std::size_t piece) const { return lists_[piece].groups; }
  /// Whether another particle is in the same point, so that no force can part the two.
  bool coincident(std::size_t sorted) const { return coincident_[sorted] != 0; }
  float mean() const;

 private:
  friend struct NeighbourSearch;
  struct Lists {
    std::unique_ptr<std::int32_t[]> index;
    std::unique_ptr<float[]> r2;
    std::size_t capacity = 0;
    std::vector<Group> groups;
    void reserve(std::size_t wanted, std::size_t used);
  };
  Particles positions_;
  std::optional<ParticleGrid> grid_;
  std::vector<Lists> lists_;
  std::vector<std::uint32_t> first_, count_;
  std::vector<std::uint8_t> coincident_;
};

/// The particles that may be neighbours of a few: copied once, they are read by vectors.
struct Candidates {
  std::vector<float> x, y, z;  ///< m; what fills the last vector is far away
  std::vector<std::int32_t> index;
  std::size_t count = 0;
  /// Those that are nearer than h to a box, in sorted order.
  void gather(const ParticleGrid& grid, const ParticleGrid::CellBox& cells, const Bounds& box, float h);
};

/// Adds those of the sorted particles begin .. end that are nearer to a box than the root of h2; there is room for all
/// of them and 16 more.
void gather_near(const ParticleGrid& grid, std::size_t begin, std::size_t end, const Bounds& box, float h2,
                 Candidates& to);

/// Finds the candidates near particle `self`, which is among them and is left out.
/// @param index, r2  room for all candidates and 32 more
/// @param coincident  whether one of them is in the same point
/// @return       how many, at most Neighbours::kMost and without what fills the last vector
std::size_t near_among(const Candidates& candidates, const ParticleGrid& grid, std::size_t self, float h2,
                       std::int32_t* index, float* r2, bool& coincident);

}  // namespace meniscus
