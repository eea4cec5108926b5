/// Cells of an octree in Morton order: numbers that keep near cells near, and every larger cube in one piece.
#pragma once

#include <cstdint>
#include <vector>

namespace meniscus {

/// Bits of a cell's number along an axis: the octree's levels.
constexpr int kMortonLevels = 21;

/// The bits of x, y and z (each below 2^21) in turn, z's highest first.
std::uint64_t morton_key(std::uint64_t x, std::uint64_t y, std::uint64_t z);

/// Well-mixed bits of a number: the finaliser of SplitMix64.
std::uint64_t hash_of(std::uint64_t v);

/// A particle by its cell.
struct Keyed {
  std::uint64_t key;
  std::uint32_t index;
};

/// Sorts by key; particles of the same key by index, if they were in the order of their indices before.
void sort_by_key(std::vector<Keyed>& items);

}  // namespace meniscus
