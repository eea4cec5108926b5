/// Where the lanes of a mask go when they are packed to the front of a vector.
#pragma once

#include <array>
#include <cstdint>

namespace meniscus {

/// By the mask's bits, eight or four of them: the numbers of its lanes, ascending, then zeros; eight bytes each.
constexpr std::array<std::uint8_t, 8 * 256> make_packing_table() {
  std::array<std::uint8_t, 8 * 256> table{};
  for (std::size_t bits = 0; bits < 256; ++bits) {
    std::size_t count = 0;
    for (std::size_t lane = 0; lane < 8; ++lane)
      if ((bits >> lane & 1u) != 0) table[8 * bits + count++] = static_cast<std::uint8_t>(lane);
  }
  return table;
}
alignas(64) inline constexpr std::array<std::uint8_t, 8 * 256> kPackingTable = make_packing_table();

}  // namespace meniscus
