#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "meniscus/sim.h"
#include "sim/rain_parts.h"

namespace meniscus {
namespace {

constexpr double kDropsPerSlot = 64;    ///< in the mean
constexpr double kMostPerSecond = 1e9;  ///< drops
constexpr double kWide = 20000;         ///< drops a second over the whole region, made only to be left out
constexpr int kMostLayers = 24;
constexpr double kLeast = 0.01;                ///< part of the drops far from the eye
constexpr double kMostFar = 0.25;              ///< what those may be of all that are made
constexpr double kStepsOfWay = 64;             ///< through a field, from the top straight down, at most
constexpr double kFar = 1e7;                   ///< m
constexpr double kMostSeconds = 1e9;           ///< of start
constexpr double kWaterRate = 1.0 / 3.6e6;     ///< m/s in a mm/h
constexpr std::uint64_t kSingle = 1ull << 63;  ///< in the ids of single drops; none of the rain's numbers is that large

void require(bool good, std::string_view what, std::string expected, double found) {
  if (good) return;
  throw Error(ErrorCode::invalid_argument, {fmt::format("the rain's {} is out of range", what),
                                            std::move(expected),
                                            fmt::format("{}", found),
                                            {},
                                            {},
                                            {},
                                            {}});
}

void check(const RainOptions& o) {
  require(o.rate_mm_h >= 0 && o.rate_mm_h <= 10000, "rate", "0 to 10000 mm/h", o.rate_mm_h);
  require(o.smallest_mm > 0 && o.smallest_mm < 20, "smallest diameter", "between 0 and 20 mm", o.smallest_mm);
  require(o.largest_mm > o.smallest_mm && o.largest_mm <= 20, "largest diameter",
          "more than the smallest and at most 20 mm", o.largest_mm);
  for (int i = 0; i < 2; ++i)
    require(std::abs(o.low[i]) <= kFar && std::abs(o.high[i]) <= kFar && o.low[i] < o.high[i], "region",
            "low < high, m", o.high[i] - o.low[i]);
  require(std::abs(o.level) <= kFar, "level", "a number of at most 1e7 m", o.level);
  require(o.top > 0 && o.top <= 1e5f, "top", "more than 0 and at most 1e5 m", o.top);
  require(std::abs(o.start) <= kMostSeconds, "start", "a number of at most 1e9 s", o.start);
  require(o.duration >= 0, "duration", "0 s or more", o.duration);
  require(o.whole_within >= 0 && o.whole_within <= kFar, "reach of whole rain", "0 to 1e7 m", o.whole_within);
  require(o.share >= 0 && o.share <= 1, "share", "0 .. 1", o.share);
  require(o.most_per_second > 0 && o.most_per_second <= kMostPerSecond, "most drops a second", "between 0 and 1e9",
          o.most_per_second);
}

void check(const RainDrop& drop, const FieldAxes& axes) {
  require(drop.diameter > 0 && drop.diameter <= 0.02f, "single drop's diameter", "more than 0 and at most 0.02 m",
          drop.diameter);
  require(std::abs(drop.time) <= kMostSeconds, "single drop's time", "a number of at most 1e9 s", drop.time);
  require(drop.weight >= 0 && drop.weight <= 1e9f, "single drop's weight", "0 to 1e9", drop.weight);
  for (const int axis : {axes.a, axes.b})
    require(std::abs(drop.place[axis]) <= kFar, "single drop's place", "numbers of at most 1e7 m", drop.place[axis]);
}

/// The single drops of the options, at the level, in order of time.
std::vector<RainDrop> single_drops(const RainOptions& options, const FieldAxes& axes) {
  std::vector<RainDrop> drops = options.drops;
  const std::uint64_t name = mixed(options.seed);
  for (std::size_t i = 0; i < drops.size(); ++i) {
    check(drops[i], axes);
    drops[i].id = name ^ (kSingle | i);
    drops[i].place[axes.up] = options.level;
  }
  std::sort(drops.begin(), drops.end(), earlier);
  return drops;
}

WindOptions upright(const RainOptions& options) {
  WindOptions wind = options.wind;
  wind.up = options.up;
  return wind;
}

/// m from the eye within which all of `all` drops a second can be made, so that with the eye over the middle there are
/// no more than may be.
double whole_within(const RainThinning& thinning, const RainOptions& options, double all) {
  const glm::dvec2 sides(options.high - options.low);
  const auto too_many = [&](double whole) { return all * thinning.kept_over(sides, whole) > options.most_per_second; };
  const double asked = options.whole_within;
  if (options.share > 0 || !too_many(asked)) return asked;
  double low = 0, high = std::min(asked, std::hypot(sides.x, sides.y));
  for (int i = 0; i < 32; ++i) {
    const double middle = 0.5 * (low + high);
    (too_many(middle) ? high : low) = middle;
  }
  return low;
}

}  // namespace

Rain::Rain(const RainOptions& options) : options_((check(options), options)), wind_(upright(options)) {
  options_.wind.up = options_.up;
  auto parts = std::make_shared<Parts>(
      Parts{RainSpectrum(options.rate_mm_h, options.smallest_mm, options.largest_mm), FieldAxes(options.up)});
  parts->single = single_drops(options, parts->axes);
  const vec2 sides = options.high - options.low;
  const double per_area = parts->spectrum.arrivals(), all = per_area * double{sides.x} * double{sides.y};
  double wide = 1;  // part of the share of all drops that is made over the whole region
  if (options.eye && per_area > 0) {
    // Far away a hundredth is made, or less where even that would be more than a part of what may be made.
    share_ = options.share > 0 ? options.share : 1;
    const double far = options.share > 0 ? kLeast : std::min(kLeast, kMostFar * options.most_per_second / all);
    const RainThinning& thinning = parts->thinning.emplace(parts->spectrum, far);
    const double whole = whole_within(thinning, options, all);
    options_.whole_within = static_cast<float>(whole);
    parts->kept = thinning.kept_over(glm::dvec2(sides), whole);
    // Layers are made near the eye only, until what is left is few over the whole region.
    int layers = 0;
    parts->wide.emplace(parts->spectrum, thinning, 0, 1);
    for (; layers < kMostLayers && share_ * all * (parts->wide->share() - far) > kWide; ++layers)
      parts->wide.emplace(parts->spectrum, thinning, 0, std::exp2(-(layers + 1)));
    wide = parts->wide->share();
    parts->tiles.emplace(parts->spectrum, thinning, layers, share_ * per_area, glm::dvec2(sides), whole);
  } else {
    share_ = options.share;
    if (share_ == 0) share_ = all > options.most_per_second ? static_cast<float>(options.most_per_second / all) : 1.0f;
  }
  if (share_ * all * parts->kept > kMostPerSecond)
    throw Error(ErrorCode::limit_exceeded, {"the rain has too many drops",
                                            "at most 1e9 a second",
                                            fmt::format("{:.3g}", share_ * all * parts->kept),
                                            {},
                                            {},
                                            {},
                                            "make a smaller share"});
  const double slowest = 1e-3;  // drops a second below which slots are no longer, so that their numbers stay exact
  const double rate = share_ * all * wide;
  parts->slot = kDropsPerSlot / std::max(rate, slowest);
  parts->number_below = poisson_below(rate * parts->slot);
  parts->step_length = std::clamp(double{wind_.finest()}, double{options.top} / kStepsOfWay, double{options.top} / 8);
  WindOptions calm = options_.wind;
  calm.gust = 0;
  const bool gusty = options_.wind.gust > 0;
  const Wind& steady = gusty ? parts->calm.emplace(calm) : wind_;
  if (gusty) parts->gusts = std::make_unique<const GustTable>(wind_, steady, options_.wind, options.start);
  parts->rise = steady.carried(0, 1)[parts->axes.up];
  parts_ = std::move(parts);
}

double Rain::drops_per_second() const {
  const vec2 sides = options_.high - options_.low;
  return parts_->spectrum.arrivals() * double{sides.x} * double{sides.y} * share_ * parts_->kept;
}

double Rain::rate_of_mist() const { return std::max(options_.rate_mm_h * kWaterRate - parts_->spectrum.water(), 0.0); }

float Rain::extinction() const { return static_cast<float>(parts_->spectrum.extinction()); }

double Rain::volume(const RainDrop& drop) const {
  const double d = drop.diameter;
  return std::numbers::pi / 6 * d * d * d * double{drop.weight};
}

}  // namespace meniscus
