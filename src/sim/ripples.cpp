#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/field_axes.h"
#include "meniscus/formulas/rain.h"
#include "meniscus/sim.h"
#include "sim/ripples_step.h"

namespace meniscus {
namespace {

constexpr float kGravity = 9.81f;        ///< m/s^2
constexpr float kWaterDensity = 1000;    ///< kg/m^3
constexpr double kCourant = 0.8;         ///< c step / points; stable up to sqrt(3) / 2
constexpr double kLeast_rel = 1.0 / 16;  ///< of the longest inner step: less time is kept for later
constexpr double kMostSteps = 1e8;       ///< in one call
constexpr int kLayer = 12;               ///< points along the border that let waves out
constexpr int kLeastLayer = 4;           ///< a steeper end throws back more than it takes
constexpr double kLayerDamping = 0.35;   ///< at its outer end, in speeds a step between points
constexpr std::size_t kMostPoints = std::size_t{1} << 26;
constexpr std::size_t kGrain = 16384;  ///< points of one piece

constexpr float kNothing = 1e-7f;  ///< m

[[noreturn]] void refuse(std::string problem, std::string expected, std::string found) {
  throw Error(ErrorCode::invalid_argument, {std::move(problem), std::move(expected), std::move(found), {}, {}, {}, {}});
}

void check(const RippleOptions& o) {
  const auto require = [](bool good, std::string_view what, std::string expected, double found) {
    if (!good)
      refuse(fmt::format("the ripples' {} is out of range", what), std::move(expected), fmt::format("{}", found));
  };
  for (int i = 0; i < 2; ++i)
    require(std::abs(o.low[i]) <= 1e7f && std::abs(o.high[i]) <= 1e7f && o.low[i] < o.high[i], "region",
            "low < high, m", o.high[i] - o.low[i]);
  require(o.step >= 1e-5f && o.step <= 1e5f, "step", "1e-5 .. 1e5 m", o.step);
  require(o.wavelength > 1e-5f, "wavelength", "more than 1e-5 m, or infinity", o.wavelength);
  require(o.surface_tension >= 0 && o.surface_tension <= 10, "surface tension", "0 .. 10 N/m", o.surface_tension);
  require(o.damping >= 0 && o.damping <= 1000, "damping", "0 .. 1000 1/s", o.damping);
  require(std::abs(o.strength) <= 1000, "strength", "a number of at most 1000", o.strength);
}

/// Squared speeds by depth, from a table where it pays.
class SpeedsByDepth {
 public:
  SpeedsByDepth(const Ripples& ripples, float wavelength) {
    if (!std::isfinite(wavelength)) return;
    // From a depth of 1.3 wavelengths on, tanh(k h) is 1 in float.
    per_step_ = static_cast<float>(kSteps) / (1.3f * wavelength);
    table_.resize(kSteps + 2);
    for (std::size_t i = 1; i < table_.size(); ++i) {
      const float c = ripples.speed(static_cast<float>(i) / per_step_);
      table_[i] = c * c;
    }
  }
  float squared(float depth) const {
    if (!(depth > 0)) return 0;
    if (table_.empty()) return kGravity * depth;
    const float along = std::min(depth * per_step_, static_cast<float>(kSteps));
    const auto i = static_cast<std::size_t>(along);
    return table_[i] + (along - static_cast<float>(i)) * (table_[i + 1] - table_[i]);
  }

 private:
  static constexpr std::size_t kSteps = 4096;
  float per_step_ = 0;
  std::vector<float> table_;
};

int tiles_along(int points, int tile) { return (points + tile - 1) / tile; }

}  // namespace

Ripples::Ripples(const RippleOptions& options) : options_(options) {
  check(options);
  const double step = options.step;
  const double width = std::ceil((double{options.high.x} - double{options.low.x}) / step - 1e-3) + 1;
  const double height = std::ceil((double{options.high.y} - double{options.low.y}) / step - 1e-3) + 1;
  if (width * height > static_cast<double>(kMostPoints))
    throw Error(ErrorCode::limit_exceeded, {"the ripples have too many points",
                                            fmt::format("at most {}", kMostPoints),
                                            fmt::format("{:.0f} x {:.0f}", width, height),
                                            {},
                                            {},
                                            {},
                                            "make the step larger or the region smaller"});
  width_ = static_cast<int>(width);
  height_ = static_cast<int>(height);
  const std::size_t points = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  now_.assign(points + 2, 0.0f);
  before_.assign(points + 2, 0.0f);
  const auto tiles = static_cast<std::size_t>(tiles_along(width_, kTileWidth) * tiles_along(height_, kTileHeight));
  wet_tiles_.assign(tiles, 0);
  moving_tiles_.assign(tiles, kTileCleared);
}

vec3 Ripples::place(int i, int j, float level) const {
  const vec2 place = options_.low + options_.step * vec2{i, j};
  return FieldAxes(options_.up).place(place.x, place.y, level);
}

float Ripples::speed(float depth) const {
  if (!(depth > 0)) return 0;
  if (!std::isfinite(options_.wavelength)) return std::sqrt(kGravity * depth);
  const float wave_number = 2 * std::numbers::pi_v<float> / options_.wavelength;
  return formulas::wave_speed(wave_number, depth, kGravity, options_.surface_tension / kWaterDensity);
}

void Ripples::set_depths(std::vector<float> depths) {
  const std::size_t points = now_.size() - 2, width = static_cast<std::size_t>(width_);
  if (depths.size() != points)
    refuse("the depths under the ripples are not as many as the points", fmt::format("{} x {}", width_, height_),
           fmt::format("{}", depths.size()));
  for (std::size_t k = 0; k < points; ++k)
    if (!(depths[k] <= 1e6f)) refuse("a depth under the ripples is not a number", "", fmt::format("point {}", k));
  depths_ = std::move(depths);

  const SpeedsByDepth speeds(*this, options_.wavelength);
  const std::size_t stride = width + 2, rows_grain = std::max<std::size_t>(kGrain / width, 1);
  speeds2_.resize(stride * (static_cast<std::size_t>(height_) + 2), 0.0f);
  parallel_for(static_cast<std::size_t>(height_), rows_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t i = 0; i < width; ++i) {
        const float c2 = speeds.squared(depths_[i + j * width]);
        speeds2_[i + 1 + stride * (j + 1)] = c2;
        if (c2 == 0) now_[i + j * width + 1] = before_[i + j * width + 1] = 0;
      }
  });
  const std::size_t tiles_a = static_cast<std::size_t>(tiles_along(width_, kTileWidth));
  std::fill(wet_tiles_.begin(), wet_tiles_.end(), std::uint8_t{0});
  for (std::size_t j = 0; j < static_cast<std::size_t>(height_); ++j)
    for (std::size_t a = 0; a < tiles_a; ++a) {
      const float* row = speeds2_.data() + stride * (j + 1) + 1;
      const float* end = row + std::min((a + 1) * kTileWidth, width);
      if (std::any_of(row + a * kTileWidth, end, [](float c2) { return c2 > 0; }))
        wet_tiles_[a + tiles_a * (j / kTileHeight)] = 1;
    }

  // The longest step depends on the fastest waves that there may be, so that it stays as puddles grow.
  float fastest2 = 0;
  for (const float c2 : speeds2_) fastest2 = std::max(fastest2, c2);
  if (fastest2 > 0 && std::isfinite(options_.wavelength)) {
    const float deep = speed(std::numeric_limits<float>::max());
    fastest2 = deep * deep;
  }
  limit_ = fastest2 > 0 ? kCourant * double{options_.step} / std::sqrt(double{fastest2}) : 0.0;
  set_step(limit_ == 0 || step_ == 0 ? limit_ : std::min(step_, limit_));
}

// What waves do in a step is seen from the last one: with the acceleration now, it is told what they would have done in
// a step of another length. u(t - s dt) = u - s (u - u-) + s (s - 1) / 2 u_tt dt^2.
void Ripples::set_step(double seconds) {
  const std::size_t points = now_.size() - 2, width = static_cast<std::size_t>(width_);
  if (seconds > 0 && step_ > 0 && std::abs(seconds - step_) > 1e-9 * seconds) {
    const float old_decay = static_cast<float>(std::exp(-options_.damping * step_));
    for (float& height : before_) height *= old_decay;
    const std::vector<float> old = before_;
    step(step_, 1, false);
    const double ratio = seconds / step_;
    const float stretch = static_cast<float>(ratio), bend = static_cast<float>(0.5 * ratio * (ratio - 1));
    const float per_decay = static_cast<float>(std::exp(options_.damping * seconds));
    parallel_for(points, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin + 1; k < end + 1; ++k)
        before_[k] =
            per_decay * (now_[k] - stretch * (now_[k] - old[k]) + bend * (before_[k] - (now_[k] + now_[k]) + old[k]));
    });
  }
  step_ = seconds;

  // Points of the border let waves go on outwards, u_t + c u_n = 0 [Mur1981]; the layer before them damps those that
  // come aslant.
  keeps_.resize(points, 1.0f);
  const auto damping = [](int away, int points_along) {  // in speeds a step between points
    const int layer = std::min(kLayer, points_along / 8);
    const double t = layer >= kLeastLayer && away < layer ? 1.0 - away / static_cast<double>(layer) : 0.0;
    return kLayerDamping * t * t + (away == 0 ? 0.5 : 0.0);
  };
  for (int j = 0; j < height_; ++j) {
    const double along_b = damping(j, height_) + damping(height_ - 1 - j, height_);
    for (int i = 0; i < width_; ++i) {
      if (along_b == 0 && i == kLayer + 1) i = std::max(i, width_ - kLayer - 1);
      const std::size_t k = static_cast<std::size_t>(i) + width * static_cast<std::size_t>(j);
      const double c = std::sqrt(double{speeds2_[padded(i, j)]});
      const double sigma = (along_b + damping(i, width_) + damping(width_ - 1 - i, width_)) * c / double{options_.step};
      keeps_[k] = static_cast<float>(1.0 / (1.0 + sigma * step_));
    }
  }
}

void Ripples::advance(double seconds) {
  if (!(seconds >= 0 && std::isfinite(seconds)))
    refuse("the ripples' time is not a positive number", "0 s or more", fmt::format("{}", seconds));
  if (limit_ == 0) {
    left_ = 0;
    return;
  }
  left_ += seconds;
  // What is still stays so: no time is spent on it.
  if (std::all_of(moving_tiles_.begin(), moving_tiles_.end(),
                  [](std::uint8_t state) { return state == kTileCleared; })) {
    left_ = 0;
    return;
  }
  if (left_ < kLeast_rel * limit_) return;
  const double steps = std::ceil(left_ / limit_ - 1e-9);
  if (steps > kMostSteps)
    throw Error(ErrorCode::limit_exceeded, {"the ripples' time is too long",
                                            fmt::format("{} s", kMostSteps * limit_),
                                            fmt::format("{}", seconds),
                                            {},
                                            {},
                                            {},
                                            {}});
  const double step = left_ / steps;
  if (std::abs(step - step_) > 1e-9 * step) set_step(step);
  const double decay = std::exp(-options_.damping * step_);
  for (double done = 0; done < steps; ++done) {
    this->step(step_, decay, true);
    std::swap(now_, before_);
  }
  left_ = 0;
}

// Heights one step on take the place of those one step ago.
void Ripples::step(double seconds, double decay, bool border) {
  const std::size_t width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  const std::size_t tiles_a = static_cast<std::size_t>(tiles_along(width_, kTileWidth)),
                    tiles_b = static_cast<std::size_t>(tiles_along(height_, kTileHeight));
  const double ratio = seconds / options_.step;
  const float scale = static_cast<float>(ratio * ratio);
  std::vector<std::uint8_t> next_states(moving_tiles_);
  const auto moves = [&](std::size_t a, std::size_t b) { return moving_tiles_[a + tiles_a * b] > kTileStill; };
  const auto moves_near = [&](std::size_t a, std::size_t b) {
    return moves(a, b) || (a > 0 && moves(a - 1, b)) || (a + 1 < tiles_a && moves(a + 1, b)) ||
           (b > 0 && moves(a, b - 1)) || (b + 1 < tiles_b && moves(a, b + 1));
  };
  parallel_for(tiles_a * tiles_b, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile) {
      const std::size_t a = tile % tiles_a, b = tile / tiles_a;
      const bool stepped = wet_tiles_[tile] && moves_near(a, b);
      if (!stepped && moving_tiles_[tile] == kTileCleared) continue;
      const std::size_t i0 = a * kTileWidth, count = std::min<std::size_t>(kTileWidth, width - i0);
      float largest = 0;
      for (std::size_t j = b * kTileHeight; j < std::min(height, (b + 1) * kTileHeight); ++j) {
        const std::size_t k = i0 + j * width;
        if (!stepped) {
          std::fill_n(before_.begin() + static_cast<std::ptrdiff_t>(k) + 1, count, 0.0f);
          continue;
        }
        RippleRow row;
        row.now[1] = now_.data() + 1 + k;
        row.now[0] = j > 0 ? row.now[1] - width : row.now[1];
        row.now[2] = j + 1 < height ? row.now[1] + width : row.now[1];
        for (std::size_t n = 0; n < 3; ++n) row.speeds2[n] = speeds2_.data() + (j + n) * (width + 2) + i0 + 1;
        const bool near_border =
            i0 <= kLayer || i0 + count + kLayer >= width || j <= kLayer || j + kLayer + 1 >= height;
        row.keeps = border && near_border ? keeps_.data() + k : nullptr;
        row.before = before_.data() + 1 + k;
        row.decay = static_cast<float>(decay);
        row.scale = scale;
        row.count = count;
        largest = std::max(largest, step_row(row));
      }
      const std::uint8_t state = moving_tiles_[tile];
      const auto calmer = static_cast<std::uint8_t>(state > 0 ? state - 1 : 0);
      next_states[tile] = !stepped ? calmer : largest > kNothing ? kTileMoves : std::max(calmer, kTileStill);
    }
  });
  moving_tiles_ = std::move(next_states);
}

double Ripples::energy() const {
  if (step_ == 0) return 0;
  // Leapfrog keeps the sum of kinetic energy half a step ago and the product of both times' slopes.
  const double decay = std::exp(-options_.damping * step_), cell = double{options_.step} * double{options_.step};
  double sum = 0;
  for (int j = 0; j < height_; ++j)
    for (int i = 0; i < width_; ++i) {
      const std::size_t k =
          static_cast<std::size_t>(i) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(j) + 1;
      const double now = now_[k], before = decay * before_[k], rate = (now - before) / step_;
      sum += cell * rate * rate;
      const auto speed2 = [&](int di, int dj) { return double{speeds2_[padded(i + di, j + dj)]}; };
      const auto pair = [&](int di, int dj, double sixths) {
        if (!(speed2(0, 0) > 0 && speed2(di, dj) > 0)) return;
        const std::size_t n = k + static_cast<std::size_t>(di + width_ * dj);
        sum += sixths / 12 * (speed2(0, 0) + speed2(di, dj)) * (now_[n] - now) * (decay * before_[n] - before);
      };
      const auto dry = [&](int di, int dj, int ei, int ej) { return speed2(di, dj) + speed2(ei, ej) == 0 ? 1 : 0; };
      pair(1, 0, 4 + dry(0, 1, 1, 1) + dry(0, -1, 1, -1));
      pair(0, 1, 4 + dry(1, 0, 1, 1) + dry(-1, 0, -1, 1));
      pair(1, 1, 1);
      pair(-1, 1, 1);
    }
  return 0.5 * sum;
}

}  // namespace meniscus
