#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "meniscus/sim.h"
#include "sim/rain_parts.h"

namespace meniscus {
namespace {

constexpr double kDropsPerSlot = 64;           ///< in the mean
constexpr int kIndexBits = 10;                 ///< of a drop's number within its slot
constexpr double kMostPerSecond = 1e9;         ///< drops
constexpr double kMostAtOnce = 1 << 27;        ///< drops
constexpr double kWayOff = 0.02;               ///< m that a way's chord may stand off the way
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

bool earlier(const RainDrop& a, const RainDrop& b) { return a.time != b.time ? a.time < b.time : a.id < b.id; }

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

/// Probabilities of at most i of a Poisson distribution; the last is 1.
std::vector<double> poisson_below(double mean) {
  std::vector<double> below;
  double each = std::exp(-mean), sum = 0;
  for (int i = 0; i + 1 < 1 << kIndexBits; ++i) {
    sum += each;
    below.push_back(sum);
    each *= mean / (i + 1);
    if (i > mean && each < 1e-18) break;
  }
  below.push_back(2);
  return below;
}

}  // namespace

Rain::Rain(const RainOptions& options) : options_((check(options), options)), wind_(upright(options)) {
  options_.wind.up = options_.up;
  auto parts = std::make_shared<Parts>(Parts{RainSpectrum(options.rate_mm_h, options.smallest_mm, options.largest_mm),
                                             FieldAxes(options.up),
                                             0,
                                             {},
                                             0,
                                             0,
                                             {}});
  parts->single = single_drops(options, parts->axes);
  const vec2 sides = options.high - options.low;
  const double all = parts->spectrum.arrivals() * double{sides.x} * double{sides.y};
  share_ = options.share;
  if (share_ == 0) share_ = all > options.most_per_second ? static_cast<float>(options.most_per_second / all) : 1.0f;
  if (share_ * all > kMostPerSecond)
    throw Error(ErrorCode::limit_exceeded, {"the rain has too many drops",
                                            "at most 1e9 a second",
                                            fmt::format("{:.3g}", share_ * all),
                                            {},
                                            {},
                                            {},
                                            "make a smaller share"});
  const double slowest = 1e-3;  // drops a second below which slots are no longer, so that their numbers stay exact
  const double rate = share_ * all;
  parts->slot = kDropsPerSlot / std::max(rate, slowest);
  parts->number_below_ = poisson_below(rate * parts->slot);
  // A chord of T s stands off a curve of acceleration a by a T^2 / 8; gusts have hardly more than twice their
  // deviation.
  const double gusts = 2.0 * wind_.gust_acceleration();
  parts->ways_apart = gusts > 0 ? std::sqrt(8 * kWayOff / gusts) : 1e30;
  parts->step_length =
      std::min(double{options.top} / 8, std::max(0.25 * double{wind_.finest()}, 1e-3 * double{options.top}));
  parts_ = std::move(parts);
}

double Rain::drops_per_second() const {
  const vec2 sides = options_.high - options_.low;
  return parts_->spectrum.arrivals() * double{sides.x} * double{sides.y} * share_;
}

double Rain::rate_of_mist() const { return std::max(options_.rate_mm_h * kWaterRate - parts_->spectrum.water(), 0.0); }

float Rain::extinction() const { return static_cast<float>(parts_->spectrum.extinction()); }

double Rain::volume(const RainDrop& drop) const {
  const double d = drop.diameter;
  return std::numbers::pi / 6 * d * d * d * double{drop.weight};
}

std::vector<RainDrop> Rain::arriving(double from, double until) const {
  std::vector<RainDrop> drops = parts_->raining(*this, from, until);
  const auto after = [](double time, const RainDrop& drop) { return time < drop.time; };
  const std::vector<RainDrop>& single = parts_->single;
  const auto first = std::upper_bound(single.begin(), single.end(), from, after),
             last = std::upper_bound(first, single.end(), until, after);
  if (first == last) return drops;
  const auto middle = static_cast<std::ptrdiff_t>(drops.size());
  drops.insert(drops.end(), first, last);
  std::inplace_merge(drops.begin(), drops.begin() + middle, drops.end(), earlier);
  return drops;
}

std::vector<RainDrop> Rain::Parts::raining(const Rain& rain, double from, double until) const {
  const RainOptions& options = rain.options();
  const float share = rain.share();
  // NaN counts as empty.
  const double end = options.start + options.duration;
  const double low = std::max(from, options.start - 1), high = std::min(until, end);
  if (!(low < high) || !(spectrum.arrivals() > 0)) return {};
  const double first_slot = std::max(std::floor((low - options.start) / slot) - 1, 0.0);
  const double last_slot = std::floor((high - options.start) / slot) + 1;
  if (rain.drops_per_second() * (high - low) > kMostAtOnce || last_slot > 0x1p50 ||
      last_slot - first_slot > kMostAtOnce)
    throw Error(ErrorCode::limit_exceeded, {"too many drops of rain are asked for at once",
                                            fmt::format("at most {}", kMostAtOnce),
                                            fmt::format("{:.3g}", rain.drops_per_second() * (high - low)),
                                            {},
                                            {},
                                            {},
                                            "ask for shorter times"});
  const auto begin = static_cast<std::uint64_t>(first_slot), slots = static_cast<std::uint64_t>(last_slot) + 1 - begin;
  const std::vector<double>& below = number_below_;
  const auto draws_of = [&](std::uint64_t number) { return Draws(options.seed, number); };
  // How many drops fall in each slot: the slot's first number.
  std::vector<std::size_t> starts(slots + 1, 0);
  for (std::uint64_t s = 0; s < slots; ++s) {
    const double u = draws_of(begin + s).uniform();
    starts[s + 1] =
        starts[s] + static_cast<std::size_t>(std::upper_bound(below.begin(), below.end(), u) - below.begin());
  }
  std::vector<RainDrop> drops(starts.back());
  const std::uint64_t name = mixed(options.seed);
  const vec2 sides = options.high - options.low;
  parallel_for(slots, 64, [&](std::size_t piece_begin, std::size_t piece_end) {
    for (std::size_t s = piece_begin; s < piece_end; ++s) {
      Draws draws = draws_of(begin + s);
      draws.bits();
      const double slot_number = static_cast<double>(begin + s);
      for (std::size_t i = starts[s]; i < starts[s + 1]; ++i) {
        RainDrop& drop = drops[i];
        drop.id = name ^ ((begin + s) << kIndexBits | (i - starts[s]));
        drop.time = options.start + slot * (slot_number + draws.uniform());
        drop.diameter = spectrum.diameter(draws.uniform());
        const std::uint64_t both = draws.bits();
        const float u = static_cast<float>(both >> 40) * 0x1p-24f, v = static_cast<float>(both & 0xffffff) * 0x1p-24f;
        const vec2 place = options.low + vec2{u, v} * sides;
        drop.place = axes.place(place.x, place.y, options.level);
        drop.weight = 1 / share;
      }
      std::sort(drops.begin() + static_cast<std::ptrdiff_t>(starts[s]),
                drops.begin() + static_cast<std::ptrdiff_t>(starts[s + 1]), earlier);
    }
  });
  // Rounding may leave the last of a slot at the time of the first of the next.
  if (!std::is_sorted(drops.begin(), drops.end(), earlier)) std::sort(drops.begin(), drops.end(), earlier);
  const auto after = [](double time, const RainDrop& drop) { return time < drop.time; };
  // The rain's first moment and its last belong to it.
  const auto last = std::upper_bound(drops.begin(), drops.end(), high, after);
  drops.erase(last, drops.end());
  drops.erase(drops.begin(), std::upper_bound(drops.begin(), drops.end(), low, after));
  return drops;
}

}  // namespace meniscus
