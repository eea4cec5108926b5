#include "render/rain_flights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/field_axes.h"
#include "render/body_placement.h"
#include "render/rain_ground.h"

namespace meniscus {
namespace {

constexpr float kOnPlane = 1e-3f;       ///< m from the ground's plane that count as on it
constexpr std::size_t kTogether = 512;  ///< drops of one piece of parallel work
constexpr std::size_t kListsTogether = 2;
constexpr float kOffUniform = 0.01f;  ///< m that a drop in even wind may be lower than its mean fall tells
constexpr float kOff = 1;             ///< and in wind that is not the same everywhere

/// One straight part of a drop's way.
struct Leg {
  std::size_t flight;
  double from, until;
  float length;
};

bool same(const PlacedSolid& a, const PlacedSolid& b) {
  return a.solid == b.solid && a.world_from_solid == b.world_from_solid;
}

/// Box around the bodies that are not as they were.
Bounds changed(std::span<const PlacedSolid> before, std::span<const PlacedSolid> now) {
  Bounds box;
  for (std::size_t i = 0; i < std::max(before.size(), now.size()); ++i) {
    if (i < before.size() && i < now.size() && same(before[i], now[i])) continue;
    if (i < before.size()) box.add(bounds_of(before[i]));
    if (i < now.size()) box.add(bounds_of(now[i]));
  }
  return box;
}

bool overlap(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis]) return false;
  return true;
}

/// Moves the members at `places`, in rising order, to the end of `taken`; the others stay in their order.
void take_out(std::vector<Flight>& list, std::span<const std::size_t> places, std::vector<Flight>& taken) {
  if (places.empty()) return;
  std::size_t to = places.front(), next = 0;
  for (std::size_t i = to; i < list.size(); ++i)
    if (next < places.size() && places[next] == i) {
      taken.push_back(list[i]);
      ++next;
    } else {
      list[to++] = list[i];
    }
  list.resize(to);
}

}  // namespace

Flights::Flights(const Rain& rain, const WetGround* ground, double tick)
    : rain_(rain), ground_(ground), tick_(tick), up_(static_cast<int>(rain.options().up)) {
  if (ground_) highest_ = highest_bed(*ground_);
  // The smallest drops are the slowest; wind that rises or falls differs from place to place.
  const RainOptions& options = rain.options();
  const FieldAxes axes(options.up);
  for (const vec2 at : {vec2(0.5f, 0.5f), vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(1, 1)}) {
    RainDrop probe;
    probe.diameter = options.smallest_mm * 1e-3f;
    probe.time = options.start;
    const vec2 place = options.low + at * (options.high - options.low);
    probe.place = axes.place(place.x, place.y, options.level);
    const Rain::Way way = rain.way(probe);
    lead_ = std::max(lead_, way.times.back() - way.times.front());
  }
  lead_ = std::ceil(lead_ * 1.1 / tick_) * tick_;
}

std::size_t Flights::size() const {
  std::size_t count = 0;
  for (const auto& list : lists_) count += list.size();
  return count;
}

void Flights::each(FunctionRef<void(const Flight&)> call) const {
  for (const auto& list : lists_)
    for (const Flight& flight : list) call(flight);
}

/// A hit before the present is one that was seen too late: it counts now.
void Flights::put(const Flight& flight) {
  const auto tick = static_cast<std::int64_t>(std::ceil(flight.hit / tick_)) - 1;
  const auto list = static_cast<std::size_t>(std::max<std::int64_t>(tick - next_, 0));
  if (list >= lists_.size()) lists_.resize(list + 1);
  lists_[list].push_back(flight);
  slowest_ = std::min(slowest_, flight.fall);
}

void Flights::fall_onto_ground(Flight& flight, double from) const {
  // Down to the highest cell nothing can be met.
  const float level = rain_.options().level;
  double time = std::max(from, flight.drop.time - (highest_ - level) / std::max(flight.fall, 1e-3f));
  if (time > flight.hit) return;
  const float cell = ground_->options().cell;
  const vec3 start = rain_.position(flight.drop, time), end = rain_.position(flight.drop, flight.hit);
  const float way = glm::distance(start, end);
  const int steps = static_cast<int>(std::min(std::ceil(way / (0.5f * cell)), 1e5f)) + 1;
  for (int step = 0; step <= steps; ++step) {
    const float part = static_cast<float>(step) / static_cast<float>(steps);
    const vec3 point = start + part * (end - start);
    const std::optional<std::size_t> under = ground_->cell_at(point);
    if (!under || point[up_] > ground_->bed(*under)) continue;
    flight.hit = time + part * (flight.hit - time);
    flight.point = point;
    flight.point[up_] = ground_->bed(*under);
    flight.normal = direction_of(rain_.options().up);
    flight.cell = *under;
    flight.target = Flight::Target::ground;
    return;
  }
}

void Flights::find_targets(std::span<Flight> flights, double from, const Scene& scene) const {
  parallel_for(flights.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    find_targets_of_piece(flights.subspan(begin, end - begin), from, scene);
  });
}

void Flights::find_targets_of_piece(std::span<Flight> flights, double from, const Scene& scene) const {
  std::vector<Leg> legs;
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    Flight& flight = flights[i];
    flight.hit = flight.drop.time;
    flight.target = Flight::Target::nothing;
    const Rain::Way way = rain_.way(flight.drop);
    flight.fall = rain_.options().top / static_cast<float>(std::max(way.times.back() - way.times.front(), 1e-6));
    for (std::size_t k = 0; k + 1 < way.points.size(); ++k) {
      if (way.times[k + 1] <= from) continue;
      const double start = std::max(way.times[k], from);
      const float part = static_cast<float>((start - way.times[k]) / (way.times[k + 1] - way.times[k]));
      const vec3 begin = way.points[k] + part * (way.points[k + 1] - way.points[k]);
      const vec3 along = way.points[k + 1] - begin;
      const float length = glm::length(along);
      if (!(length > 0)) continue;
      legs.push_back({i, start, way.times[k + 1], length});
      rays.push_back({begin, along / length});
    }
  }
  std::vector<SolidHit> hits(rays.size());
  scene.hits(rays, {}, hits);
  for (std::size_t i = legs.size(); i-- > 0;) {  // the first leg that meets something wins
    const Leg& leg = legs[i];
    // The last leg ends at the level, which may be the plane itself.
    if (!(hits[i].distance <= leg.length * (1 + 1e-5f) + 1e-5f)) continue;
    Flight& flight = flights[leg.flight];
    flight.hit =
        std::min(leg.from + (leg.until - leg.from) * static_cast<double>(hits[i].distance / leg.length), leg.until);
    flight.point = rays[i].origin + hits[i].distance * rays[i].direction;
    flight.normal = hits[i].normal;
    const Ground& plane = scene.ground();
    const bool on_plane = plane.visible && std::abs(glm::dot(flight.point, plane.up) - plane.height) < kOnPlane;
    flight.target = on_plane ? Flight::Target::plane : Flight::Target::body;
  }
  if (!ground_) return;
  for (Flight& flight : flights) fall_onto_ground(flight, from);
}

void Flights::come_in(double from, double until, const Scene& scene) {
  const std::vector<RainDrop> drops = rain_.arriving(from, until);
  std::vector<Flight> flights(drops.size());
  for (std::size_t i = 0; i < drops.size(); ++i) flights[i].drop = drops[i];
  find_targets(flights, -std::numeric_limits<double>::infinity(), scene);
  for (const Flight& flight : flights) put(flight);
}

void Flights::meet_changed_scene(double now, const Scene& scene) {
  const Bounds box = changed(solids_, scene.solids()).grown(1e-3f);
  solids_ = scene.solids();
  if (box.empty()) return;
  std::vector<std::vector<std::size_t>> touched(lists_.size());
  parallel_for(lists_.size(), kListsTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      for (std::size_t i = 0; i < lists_[k].size(); ++i) {
        Bounds way;
        for (const vec3 point : rain_.way(lists_[k][i].drop).points) way.add(point);
        if (overlap(way, box)) touched[k].push_back(i);
      }
  });
  std::vector<Flight> again;
  for (std::size_t k = 0; k < lists_.size(); ++k) take_out(lists_[k], touched[k], again);
  find_targets(again, now, scene);
  for (const Flight& flight : again) put(flight);
}

void Flights::meet_water(double from, double until, const Surface& water, std::vector<Flight>& due) {
  const Bounds box = water.bounds().grown(1e-3f);
  if (box.empty()) return;
  // What is not below this height at the end of the tick has not met the water; neither have the drops of lists that
  // are due so late that the slowest of them would be above it.
  const float level = rain_.options().level;
  const float height = box.high[up_] + (rain_.wind().uniform() ? kOffUniform : kOff);
  const double seconds = static_cast<double>((height - level) / std::max(slowest_, 1e-3f));
  const auto reach = static_cast<std::size_t>(std::clamp(std::ceil(seconds / tick_) + 2, 0.0, 1e9));
  const std::size_t lists = std::min(lists_.size(), reach);
  std::vector<std::vector<std::size_t>> met(lists);
  parallel_for(lists, kListsTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) meet_water(from, until, height, box, water, lists_[k], met[k]);
  });
  for (std::size_t k = 0; k < lists; ++k) take_out(lists_[k], met[k], due);
}

void Flights::meet_water(double from, double until, float height, const Bounds& box, const Surface& water,
                         std::vector<Flight>& list, std::vector<std::size_t>& met) const {
  std::vector<std::size_t> places;
  std::vector<Ray> rays;
  std::vector<float> lengths;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Flight& flight = list[i];
    if (static_cast<float>(flight.drop.time - until) * flight.fall + rain_.options().level > height) continue;
    const vec3 start = rain_.position(flight.drop, from);
    const vec3 end = rain_.position(flight.drop, std::min(until, flight.hit));
    Bounds way;
    way.add(start);
    way.add(end);
    if (!overlap(way, box)) continue;
    const float length = glm::distance(start, end);
    if (!(length > 0)) continue;
    places.push_back(i);
    rays.push_back({start, (end - start) / length});
    lengths.push_back(length);
  }
  if (rays.empty()) return;
  const std::vector<float> starts(rays.size(), 0.0f);
  const std::vector<std::uint8_t> outside(rays.size(), 0);
  std::vector<Crossing> found(rays.size());
  water.crossings(rays, starts, lengths, outside, found);
  for (std::size_t n = 0; n < rays.size(); ++n) {
    if (!std::isfinite(found[n].distance)) continue;
    Flight& flight = list[places[n]];
    const double end = std::min(until, flight.hit);
    flight.hit = from + (end - from) * static_cast<double>(found[n].distance / lengths[n]);
    flight.point = rays[n].origin + found[n].distance * rays[n].direction;
    flight.normal = found[n].normal;
    flight.target = Flight::Target::water;
    met.push_back(places[n]);
  }
}

std::vector<Flight> Flights::hits(std::int64_t number, const Scene& scene, const Surface* water) {
  const double from = static_cast<double>(number) * tick_, until = static_cast<double>(number + 1) * tick_;
  next_ = number;
  if (!started_) {
    started_ = true;
    solids_ = scene.solids();
    come_in(from, from + lead_, scene);
    // What hits something high up at once has done so before.
    for (auto& list : lists_) std::erase_if(list, [&](const Flight& flight) { return flight.hit <= from; });
  }
  meet_changed_scene(from, scene);
  come_in(from + lead_, until + lead_, scene);
  std::vector<Flight> due;
  if (water) meet_water(from, until, *water, due);
  if (!lists_.empty()) {
    due.insert(due.end(), lists_.front().begin(), lists_.front().end());
    lists_.pop_front();
  }
  next_ = number + 1;
  std::sort(due.begin(), due.end(),
            [](const Flight& a, const Flight& b) { return a.hit != b.hit ? a.hit < b.hit : a.drop.id < b.drop.id; });
  return due;
}

}  // namespace meniscus
