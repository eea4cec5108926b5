/// Places in the order of a Z-shaped curve: those that follow each other lie near each other.
#pragma once

namespace meniscus {

struct CurvePlace {
  int x, y;
};

/// Place `at` of 64, in a square of 8 x 8; the first 4 and 16 fill squares of 2 x 2 and 4 x 4.
constexpr CurvePlace z_curve(int at) {
  return {(at & 1) | (at >> 1 & 2) | (at >> 2 & 4), (at >> 1 & 1) | (at >> 2 & 2) | (at >> 3 & 4)};
}

}  // namespace meniscus
