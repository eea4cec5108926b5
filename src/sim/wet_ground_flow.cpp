/// Sheet flow over the ground: local inertia, gravity and friction from cell to cell.             [Bates2010]
///
/// Through each side between two cells goes q, m^2/s, driven by the slope of the water's level and slowed by
/// Darcy-Weisbach's friction K / Re + f of laminar and turbulent sheets [Woolhiser1975]. Gravity is explicit, friction
/// is not, so that waves alone limit the step. Nothing is faster than waves (Froude number <= 1), and no cell gives
/// more than it has over its film.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "meniscus/sim.h"
#include "sim/ground_constants.h"
#include "sim/sheet_flow.h"

namespace meniscus {
namespace {

constexpr double kViscosity = 1.0e-6;  ///< m^2/s, of water at 20 degrees
constexpr double kCourant = 0.5;       ///< of the waves' speed in two dimensions: stable up to 1 / sqrt(2)
constexpr double kLongest = 3600;      ///< s
constexpr int kMostSteps = 200'000;    ///< of one call
constexpr std::size_t kTile = 32;      ///< cells, edge of a tile

std::size_t tiles_along(int cells) { return (static_cast<std::size_t>(cells) + kTile - 1) / kTile; }

/// Friction of a row of a tile's cells.
struct FrictionRow {
  double laminar[kTile];    ///< K nu / 8, m^2/s
  double turbulent[kTile];  ///< f / 8
  FrictionRow(const GroundMaterial* materials, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const GroundTraits& traits = traits_of(materials[i]);
      laminar[i] = traits.resistance * (kViscosity / 8);
      turbulent[i] = traits.friction / 8;
    }
  }
};

}  // namespace

void WetGround::stir(std::size_t cell) {
  if (stirred_.empty()) return;  // the first flow() looks at all
  const auto width = static_cast<std::size_t>(width_);
  const std::size_t tile = cell % width / kTile + cell / width / kTile * tiles_along(width_);
  stirred_[tile] = 1;
  deepest_[tile] = std::max(deepest_[tile], depth_[cell]);
}

void WetGround::stir_all() {
  stirred_.clear();
  deepest_.clear();
}

void WetGround::flow(double seconds) {
  if (!(seconds >= 0 && std::isfinite(seconds)))
    throw Error(ErrorCode::invalid_argument,
                {"water cannot flow for this long", "finite, >= 0 s", fmt::format("{:g} s", seconds), {}, {}, {}, {}});
  if (seconds == 0) return;
  const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  if (along_a_.empty()) {
    along_a_.assign((width + 1) * height, 0.0);
    along_b_.assign(width * (height + 1), 0.0);
    part_.assign(size() + 2 * width, 1.0);
  }
  if (stirred_.empty()) {
    const std::size_t across = tiles_along(width_);
    stirred_.assign(across * tiles_along(height_), 1);
    deepest_.assign(stirred_.size(), 0.0);
    for (std::size_t c = 0; c < size(); ++c) {
      double& deepest = deepest_[c % width / kTile + c / width / kTile * across];
      deepest = std::max(deepest, depth_[c]);
    }
  }
  double left = std::min(seconds, kLongest);
  int steps = 0;
  while (left > 0 && steps++ < kMostSteps) left = flow_step(left);
  if ((seconds > kLongest || left > 0) && std::find(stirred_.begin(), stirred_.end(), 1) != stirred_.end()) settle();
}

/// One step of at most `left` s; returns what is left then, nothing if all is still.
double WetGround::flow_step(double left) {
  const auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  const std::size_t across = tiles_along(width_), along = tiles_along(height_);

  // Tiles in which, or beside which, water has moved. In all others nothing has changed: they stay as they are.
  std::vector<std::size_t> tiles;
  double deepest = 0;
  for (std::size_t t = 0; t < stirred_.size(); ++t) {
    const std::size_t i = t % across, j = t / across;
    if (stirred_[t] || (i > 0 && stirred_[t - 1]) || (i + 1 < across && stirred_[t + 1]) ||
        (j > 0 && stirred_[t - across]) || (j + 1 < along && stirred_[t + across])) {
      tiles.push_back(t);
      deepest = std::max(deepest, deepest_[t]);
    }
  }
  if (tiles.empty()) return 0;
  const double cell = options_.cell;
  const double longest = kCourant * cell / std::sqrt(kGroundGravity * std::max(deepest, kHeldFilm));
  const double steps = std::ceil(left / longest);
  const double dt = left / steps, over = dt / cell;

  /// Calls body(tile, i0, i1, j0, j1) for each of the tiles.
  const auto each_tile = [&](auto&& body) {
    parallel_for(tiles.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const std::size_t i0 = tiles[k] % across * kTile, j0 = tiles[k] / across * kTile;
        body(tiles[k], i0, std::min(i0 + kTile, width), j0, std::min(j0 + kTile, height));
      }
    });
  };

  // New flow through the sides: a tile has the lower sides of its cells, at the end of the ground the upper ones too.
  const auto step_sides = [&](std::size_t a, std::size_t b, double* flow, std::size_t count) {
    const FrictionRow fa(material_.data() + a, count), fb(material_.data() + b, count);
    step_flow({bed_.data() + a, bed_.data() + b, depth_.data() + a, depth_.data() + b, fa.laminar, fb.laminar,
               fa.turbulent, fb.turbulent, flow, count, dt, over});
  };
  const auto step_border = [&](std::size_t c, double& flow, double sign) {
    // Outside is ground as high as the cell's, without water; `sign` is that of what flows out.
    const double dry = 0;
    double outwards = sign * flow;
    const FrictionRow friction(material_.data() + c, 1);
    step_flow({bed_.data() + c, bed_.data() + c, depth_.data() + c, &dry, friction.laminar, friction.laminar,
               friction.turbulent, friction.turbulent, &outwards, 1, dt, over});
    flow = sign * outwards;
  };
  each_tile([&](std::size_t, std::size_t i0, std::size_t i1, std::size_t j0, std::size_t j1) {
    for (std::size_t j = j0; j < j1; ++j) {
      const std::size_t c0 = i0 + width * j, c1 = i1 + width * j, inner = i0 > 0 ? 0 : 1;
      double* qa = along_a_.data() + i0 + (width + 1) * j;
      if (i1 - i0 > inner) step_sides(c0 + inner - 1, c0 + inner, qa + inner, i1 - i0 - inner);
      if (i0 == 0) step_border(c0, qa[0], -1);
      if (i1 == width) step_border(c1 - 1, qa[i1 - i0], 1);
      if (j > 0) step_sides(c0 - width, c0, along_b_.data() + c0, i1 - i0);
      for (std::size_t c = c0; c < c1 && (j == 0 || j + 1 == height); ++c) {
        if (j == 0) step_border(c, along_b_[c], -1);
        if (j + 1 == height) step_border(c, along_b_[c + width], 1);
      }
    }
  });

  // The part of what would leave a cell that it can give; a row before and after, so that outside can be looked at.
  double* const parts = part_.data() + width;
  const auto row_of = [&](std::size_t i0, std::size_t i1, std::size_t j) {
    const std::size_t c = i0 + width * j;
    return CellsRow{along_a_.data() + c + j,
                    along_b_.data() + c,
                    along_b_.data() + c + width,
                    parts + c,
                    width,
                    depth_.data() + c,
                    i1 - i0,
                    over};
  };
  each_tile([&](std::size_t, std::size_t i0, std::size_t i1, std::size_t j0, std::size_t j1) {
    for (std::size_t j = j0; j < j1; ++j) limit_flow(row_of(i0, i1, j));
  });

  // Water moves, and soaks in where it comes to dry ground.
  each_tile([&](std::size_t tile, std::size_t i0, std::size_t i1, std::size_t j0, std::size_t j1) {
    double most = 0;
    bool any = false;
    for (std::size_t j = j0; j < j1; ++j) {
      double moved[kTile];
      most = std::max(most, move_water(row_of(i0, i1, j), moved));
      for (std::size_t i = i0; i < i1; ++i) {
        if (moved[i - i0] == 0) continue;
        any = true;
        const std::size_t c = i + width * j;
        depth_[c] = soak(c, depth_[c]);
      }
    }
    deepest_[tile] = most;
    stirred_[tile] = any;
  });

  // Over the border, in one order.
  double out = 0;
  for (std::size_t j = 0; j < height; ++j) {
    const double* qa = along_a_.data() + (width + 1) * j;
    if (qa[0] != 0) out -= qa[0] * parts[width * j];
    if (qa[width] != 0) out += qa[width] * parts[width * j + width - 1];
  }
  for (std::size_t i = 0; i < width; ++i) {
    const double first = along_b_[i], last = along_b_[i + width * height];
    if (first != 0) out -= first * parts[i];
    if (last != 0) out += last * parts[i + width * (height - 1)];
  }
  drained_ += out * over * cell * cell;
  return steps > 1 ? left - dt : 0;
}

}  // namespace meniscus
