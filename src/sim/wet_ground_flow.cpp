/// Sheet flow over the ground: local inertia, gravity and friction from cell to cell.             [Bates2010]
///
/// Along each side between two cells goes q, m^2/s, in water that is h deep there and of which the upper h_f = h - film
/// flows:
///   q' = (q + g h_f dt S) / (1 + dt (K nu / (8 h^2) + f |q| / (8 h_f h)))
/// with the slope S of the water's level and Darcy-Weisbach's friction K / Re + f: laminar and turbulent sheets
/// [Woolhiser1975]. Gravity is explicit, friction is not, so that waves alone limit the step. No faster than waves
/// (Froude number <= 1), and no more than a cell has.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "meniscus/sim.h"
#include "sim/ground_constants.h"

namespace meniscus {
namespace {

constexpr double kGravity = 9.81;      ///< m/s^2
constexpr double kViscosity = 1.0e-6;  ///< m^2/s, of water at 20 degrees
constexpr double kCourant = 0.4;       ///< of the waves' speed in two dimensions: stable up to 1 / sqrt(2)
constexpr double kStillDepth = 1e-8;   ///< m: less does not flow
constexpr double kStillLevel = 1e-9;   ///< m: levels that differ by less are equal, ...
constexpr double kStillFlow = 1e-10;   ///< m^2/s: ... where no more than this flows
constexpr double kLongest = 3600;      ///< s
constexpr int kMostSteps = 200'000;    ///< of one call
constexpr std::size_t kTile = 32;      ///< cells, edge of a tile

std::size_t tiles_along(int cells) { return (static_cast<std::size_t>(cells) + kTile - 1) / kTile; }

/// Friction on both sides of a cell's edge, ready for use: the mean of the two materials'.
struct Friction {
  double laminar;    ///< K nu / 8, m^2/s
  double turbulent;  ///< f / 8
};
Friction friction_between(GroundMaterial a, GroundMaterial b) {
  const GroundTraits &ta = traits_of(a), &tb = traits_of(b);
  return {(ta.resistance + tb.resistance) * (kViscosity / 16), (ta.friction + tb.friction) / 16};
}

/// Flow after a step of dt, m^2/s, positive from the first to the second.
/// @param rise  m, level of the first over that of the second
/// @param deep  m, of water over the higher bed of the two
/// @param over  dt by the cell's edge, s/m
double flow_after(double q, double rise, double deep, const Friction& friction, double dt, double over) {
  const double flowing = deep - kHeldFilm;
  if (flowing < kStillDepth) return 0;
  if (std::abs(rise) < kStillLevel && std::abs(q) < kStillFlow) return 0;
  // (q + g h_f dt S) / (1 + dt drag), multiplied by h^2 h_f above and below: one division.
  const double thick = deep * deep * flowing;
  const double slowed = thick + dt * (friction.laminar * flowing + friction.turbulent * std::abs(q) * deep);
  const double next = (q + kGravity * flowing * rise * over) * thick / slowed;
  const double fastest2 = flowing * flowing * (kGravity * deep);
  return next * next > fastest2 ? std::copysign(std::sqrt(fastest2), next) : next;
}

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
    part_.assign(size(), 1.0);
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
  const double longest = kCourant * cell / std::sqrt(kGravity * std::max(deepest, kHeldFilm));
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
  const auto between = [&](double q, std::size_t a, std::size_t b) {
    const double step = static_cast<double>(bed_[a]) - static_cast<double>(bed_[b]);
    const double rise = step + (depth_[a] - depth_[b]);
    const double deep = std::max(depth_[a] + std::min(step, 0.0), depth_[b] - std::max(step, 0.0));
    if (q == 0 && deep < kHeldFilm) return 0.0;  // most of a wet street
    return flow_after(q, rise, deep, friction_between(material_[a], material_[b]), dt, over);
  };
  const auto outwards = [&](double q, std::size_t c) {  // the level outside is that of the cell's own ground
    return flow_after(q, depth_[c], depth_[c], friction_between(material_[c], material_[c]), dt, over);
  };
  each_tile([&](std::size_t, std::size_t i0, std::size_t i1, std::size_t j0, std::size_t j1) {
    for (std::size_t j = j0; j < j1; ++j) {
      double* qa = along_a_.data() + (width + 1) * j;
      for (std::size_t i = i0; i < i1; ++i) {
        const std::size_t c = i + width * j;
        qa[i] = i > 0 ? between(qa[i], c - 1, c) : -outwards(-qa[i], c);
        double& qb = along_b_[c];
        qb = j > 0 ? between(qb, c - width, c) : -outwards(-qb, c);
        if (i + 1 == width) qa[width] = outwards(qa[width], c);
        if (j + 1 == height) {
          double& end = along_b_[c + width];
          end = outwards(end, c);
        }
      }
    }
  });

  // The part of what would leave a cell that its water over the film can give.
  each_tile([&](std::size_t, std::size_t i0, std::size_t i1, std::size_t j0, std::size_t j1) {
    for (std::size_t j = j0; j < j1; ++j)
      for (std::size_t i = i0; i < i1; ++i) {
        const std::size_t c = i + width * j, a = i + (width + 1) * j;
        const double out = std::max(-along_a_[a], 0.0) + std::max(along_a_[a + 1], 0.0) + std::max(-along_b_[c], 0.0) +
                           std::max(along_b_[c + width], 0.0);
        const double free = std::max(depth_[c] - kHeldFilm, 0.0);
        part_[c] = out * over > free ? free / (out * over) : 1.0;
      }
  });

  // Water moves. What goes through a side is the same number for both cells.
  const auto through = [&](double q, std::size_t from, std::size_t to) {
    return q * (q > 0 ? part_[from] : part_[to]);
  };
  each_tile([&](std::size_t tile, std::size_t i0, std::size_t i1, std::size_t j0, std::size_t j1) {
    double most = 0;
    bool moves = false;
    for (std::size_t j = j0; j < j1; ++j)
      for (std::size_t i = i0; i < i1; ++i) {
        const std::size_t c = i + width * j, a = i + (width + 1) * j;
        const double qa0 = along_a_[a], qa1 = along_a_[a + 1], qb0 = along_b_[c], qb1 = along_b_[c + width];
        if (qa0 != 0 || qa1 != 0 || qb0 != 0 || qb1 != 0) {
          double in = through(qa0, i > 0 ? c - 1 : c, c) - through(qa1, c, i + 1 < width ? c + 1 : c);
          in += through(qb0, j > 0 ? c - width : c, c) - through(qb1, c, j + 1 < height ? c + width : c);
          depth_[c] = soak(c, std::max(depth_[c] + in * over, 0.0));
          moves = true;
        }
        most = std::max(most, depth_[c]);
      }
    deepest_[tile] = most;
    stirred_[tile] = moves;
  });

  // Over the border, in one order.
  double out = 0;
  for (std::size_t j = 0; j < height; ++j) {
    const double* qa = along_a_.data() + (width + 1) * j;
    if (qa[0] != 0) out -= qa[0] * part_[width * j];
    if (qa[width] != 0) out += qa[width] * part_[width * j + width - 1];
  }
  for (std::size_t i = 0; i < width; ++i) {
    const double first = along_b_[i], last = along_b_[i + width * height];
    if (first != 0) out -= first * part_[i];
    if (last != 0) out += last * part_[i + width * (height - 1)];
  }
  drained_ += out * over * cell * cell;
  return steps > 1 ? left - dt : 0;
}

}  // namespace meniscus
