#include "particles/band_kinds.h"

#include <algorithm>

namespace meniscus {
namespace {

constexpr std::size_t kGrain = 256;  ///< blocks

/// out word i = and of the words i - reach .. i + reach of 24, for the middle eight.
BandBits window(const std::array<std::uint64_t, 24>& words, int reach) {
  BandBits found;
  for (int i = 0; i < 8; ++i) {
    std::uint64_t all = ~std::uint64_t{0};
    for (int k = 8 + i - reach; k <= 8 + i + reach; ++k) all &= words[static_cast<std::size_t>(k)];
    found[static_cast<std::size_t>(i)] = all;
  }
  return found;
}

/// The same within each word, of whose eight bytes (y) or bits of bytes (x) three words side by side are seen.
std::uint64_t along_y(std::uint64_t before, std::uint64_t here, std::uint64_t after, int reach) {
  std::uint64_t all = here;
  for (int k = 1; k <= reach; ++k) {
    const int up = 8 * k, down = 64 - up;
    if (k == 8) {
      all &= before & after;
      break;
    }
    all &= (here >> up | after << down) & (here << up | before >> down);
  }
  return all;
}

std::uint64_t along_x(std::uint64_t before, std::uint64_t here, std::uint64_t after, int reach) {
  constexpr std::uint64_t kOnes = 0x0101010101010101u;
  std::uint64_t all = here;
  for (int k = 1; k <= reach; ++k) {
    if (k == 8) {
      all &= before & after;
      break;
    }
    const std::uint64_t low = kOnes * ((1u << (8 - k)) - 1u);  // bits 0 .. 7 - k of each byte
    const std::uint64_t right = (here >> k & low) | (after << (8 - k) & ~low);
    const std::uint64_t high = kOnes * (0xffu & (0xffu << k));  // bits k .. 7
    const std::uint64_t left = (here << k & high) | (before >> (8 - k) & ~high);
    all &= right & left;
  }
  return all;
}

}  // namespace

void erode(std::vector<BandBits>& bits, const std::vector<BandSides>& sides, int reach, bool missing) {
  std::vector<BandBits> result(bits.size());
  BandBits none;
  none.fill(missing ? ~std::uint64_t{0} : 0);
  const auto side = [&](std::int32_t block) -> const BandBits& {
    return block < 0 ? none : bits[static_cast<std::size_t>(block)];
  };
  for (; reach > 0; reach -= 8) {
    const int now = std::min(reach, 8);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      parallel_for(bits.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          const BandBits &here = bits[b], &before = side(sides[b][2 * axis]), &after = side(sides[b][2 * axis + 1]);
          if (axis == 2) {
            std::array<std::uint64_t, 24> words;
            std::copy(before.begin(), before.end(), words.begin());
            std::copy(here.begin(), here.end(), words.begin() + 8);
            std::copy(after.begin(), after.end(), words.begin() + 16);
            result[b] = window(words, now);
            continue;
          }
          for (std::size_t z = 0; z < 8; ++z)
            result[b][z] =
                axis == 0 ? along_x(before[z], here[z], after[z], now) : along_y(before[z], here[z], after[z], now);
        }
      });
      bits.swap(result);
    }
    if (!missing && std::all_of(bits.begin(), bits.end(), [](const BandBits& block) { return block == BandBits{}; }))
      return;
  }
}

}  // namespace meniscus
