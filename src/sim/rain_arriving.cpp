/// The drops of some time.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "meniscus/sim.h"
#include "sim/rain_parts.h"

namespace meniscus {
namespace {

constexpr int kIndexBits = 10;           ///< of a drop's number within its slot
constexpr double kMostAtOnce = 1 << 27;  ///< drops
constexpr double kPiece = 0.25;          ///< s that are looked at around an eye at once
constexpr double kAbove = 1;             ///< m over the eye up to which drops are followed back
constexpr double kFastestEye = 50;       ///< m/s; what is faster is a cut

bool after(double time, const RainDrop& drop) { return time < drop.time; }

void check_number(double drops) {
  if (drops <= kMostAtOnce) return;
  throw Error(ErrorCode::limit_exceeded, {"too many drops of rain are asked for at once",
                                          fmt::format("at most {}", kMostAtOnce),
                                          fmt::format("{:.3g}", drops),
                                          {},
                                          {},
                                          {},
                                          "ask for shorter times"});
}

/// Leaves what comes after `from` and not after `until`.
void cut(std::vector<RainDrop>& drops, double from, double until) {
  drops.erase(std::upper_bound(drops.begin(), drops.end(), until, after), drops.end());
  drops.erase(drops.begin(), std::upper_bound(drops.begin(), drops.end(), from, after));
}

}  // namespace

std::vector<RainDrop> Rain::Parts::from_slots(const Rain& rain, double low, double high) const {
  const RainOptions& options = rain.options();
  const double first_slot = std::max(std::floor((low - options.start) / slot) - 1, 0.0),
               last_slot = std::floor((high - options.start) / slot) + 1;
  check_number(last_slot > 0x1p50 ? std::numeric_limits<double>::infinity() : last_slot - first_slot);
  const auto begin = static_cast<std::uint64_t>(first_slot), slots = static_cast<std::uint64_t>(last_slot) + 1 - begin;
  const auto draws_of = [&](std::uint64_t number) { return Draws(options.seed, number); };
  // How many drops fall in each slot: the slot's first number.
  std::vector<std::size_t> starts(slots + 1, 0);
  for (std::uint64_t s = 0; s < slots; ++s) {
    const double u = draws_of(begin + s).uniform();
    starts[s + 1] = starts[s] + static_cast<std::size_t>(std::upper_bound(number_below.begin(), number_below.end(), u) -
                                                         number_below.begin());
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
        const double part = draws.uniform();
        const std::uint64_t both = draws.bits();
        const float u = static_cast<float>(both >> 40) * 0x1p-24f, v = static_cast<float>(both & 0xffffff) * 0x1p-24f;
        const vec2 place = options.low + vec2{u, v} * sides;
        drop.place = axes.place(place.x, place.y, options.level);
        if (wide) {
          const RainLayer::Drop kind = wide->drop(part, draws.uniform(), *thinning);
          drop.diameter = kind.diameter;
          drop.weight = kind.u;
        } else {
          drop.diameter = spectrum.diameter(part);
          drop.weight = 1 / rain.share();
        }
      }
      std::sort(drops.begin() + static_cast<std::ptrdiff_t>(starts[s]),
                drops.begin() + static_cast<std::ptrdiff_t>(starts[s + 1]), earlier);
    }
  });
  // Rounding may leave the last of a slot at the time of the first of the next.
  if (!std::is_sorted(drops.begin(), drops.end(), earlier)) std::sort(drops.begin(), drops.end(), earlier);
  cut(drops, low, high);
  return drops;
}

RainEye Rain::Parts::eye(const Rain& rain, std::int64_t number) const {
  const RainOptions& options = rain.options();
  const double time = options.start + RainTiles::kSlot * static_cast<double>(number);
  const vec3 now = options.eye(time), next = options.eye(time + RainTiles::kSlot);
  RainEye eye;
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(now[axis]) <= 1e7f)) return eye;
  const auto level = [&](vec3 v) { return glm::dvec2(v[axes.a], v[axes.b]); };
  glm::dvec2 velocity = (level(next) - level(now)) / RainTiles::kSlot;
  if (!(std::hypot(velocity.x, velocity.y) <= kFastestEye)) velocity = glm::dvec2(0.0);
  eye.place = level(now);
  eye.sweep = level(rain.wind().at(now, time)) - velocity;
  eye.height = std::max(double{now[axes.up]} - double{options.level}, 0.0) + kAbove;
  eye.there = true;
  return eye;
}

std::vector<RainDrop> Rain::Parts::around_eye(const Rain& rain, double low, double high) const {
  const RainOptions& options = rain.options();
  std::int64_t known = -1;
  RainEye at;
  const auto eye_at = [&](std::int64_t number) {
    if (number != known) at = eye(rain, number);
    known = number;
    return at;
  };
  std::vector<RainDrop> drops = from_slots(rain, low, high);
  tiles->add(options, *thinning, low - options.start, high - options.start, eye_at, drops);
  std::sort(drops.begin(), drops.end(), earlier);
  cut(drops, low, high);
  const double whole2 = double{options.whole_within} * double{options.whole_within};
  std::erase_if(drops, [&](RainDrop& drop) {
    const glm::dvec2 place(drop.place[axes.a], drop.place[axes.b]);
    for (int i = 0; i < 2; ++i)
      if (place[i] < double{options.low[i]} || place[i] > double{options.high[i]}) return true;
    const RainEye now = eye_at(static_cast<std::int64_t>(std::floor((drop.time - options.start) / RainTiles::kSlot)));
    double q = 0;
    if (now.there) {
      const double away = now.distance(place, fall_speed(drop.diameter));
      q = away * away <= whole2 ? 1 : whole2 / (away * away);
    }
    const double kept = thinning->kept(q, drop.diameter);
    if (double{drop.weight} >= kept) return true;
    drop.weight = static_cast<float>(1 / (kept * double{rain.share()}));
    return false;
  });
  return drops;
}

std::vector<RainDrop> Rain::arriving(double from, double until) const {
  // NaN counts as empty. The rain's first moment and its last belong to it.
  const double low = std::max(from, options_.start - 1), high = std::min(until, options_.start + options_.duration);
  std::vector<RainDrop> drops;
  if (low < high && parts_->spectrum.arrivals() > 0) {
    check_number(drops_per_second() * (high - low));
    if (!parts_->tiles) {
      drops = parts_->from_slots(*this, low, high);
    } else {
      const double piece_length = parts_->tiles->empty() ? high - low : kPiece;
      for (double begin = low; begin < high; begin += piece_length) {
        const std::vector<RainDrop> piece = parts_->around_eye(*this, begin, std::min(begin + piece_length, high));
        drops.insert(drops.end(), piece.begin(), piece.end());
      }
    }
  }
  const auto& single = parts_->single;
  const auto first = std::upper_bound(single.begin(), single.end(), from, after),
             last = std::upper_bound(first, single.end(), until, after);
  if (first == last) return drops;
  const auto middle = static_cast<std::ptrdiff_t>(drops.size());
  drops.insert(drops.end(), first, last);
  std::inplace_merge(drops.begin(), drops.begin() + middle, drops.end(), earlier);
  return drops;
}

}  // namespace meniscus
