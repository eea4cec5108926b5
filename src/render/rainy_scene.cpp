/// Rain, ground, splashes and ripples, tick by tick.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/field_axes.h"
#include "base/random.h"
#include "meniscus/render.h"
#include "render/rain_depths.h"
#include "render/rain_flights.h"
#include "render/rain_ground.h"
#include "render/rain_panes.h"
#include "render/rain_puddles.h"
#include "render/rain_streaks.h"

namespace meniscus {
namespace {

/// s: everything happens in ticks of this length, whatever the film's frames are.
constexpr double kTick = 0.01;
constexpr int kTicksOfFlow = 4;        ///< water runs every so many ticks
constexpr int kTicksOfDepths = 25;     ///< and ripples are told how deep it is
constexpr int kTicksOfRetiring = 16;   ///< and splashes that are over are forgotten
constexpr std::size_t kImpacts = 256;  ///< of one piece of parallel work
constexpr double kLongest = 86400;     ///< s that may be gone on at once
/// s of rain before a film that begins on wet ground, so that splashes and rings are there in its first picture.
constexpr double kBefore = 1;
constexpr double kSoonWet = 1;         ///< s of rain after which bodies count as wet
constexpr float kSteepest = 0.5f;      ///< cosine of the steepest water that splashes
constexpr float kBelow = 0.01f;        ///< m under the lowest cell where drops end
constexpr float kPlane = 1e-3f;        ///< m under the lowest cell where the plane around the cells is
constexpr float kDeep = 1;             ///< m, of water whose depth is not known
constexpr double kMostPoints = 1.5e6;  ///< of ripples on deep water

/// The rain with its time before the film, down to the lowest cell.
RainOptions rain_onto(const RainSettings& settings, const WetGround* ground) {
  RainOptions options = settings.rain;
  if (ground) {
    const float level = std::min(options.level, lowest_bed(*ground) - kBelow);
    options.top += options.level - level;
    options.level = level;
  }
  if (settings.rained_mm > 0 && options.start == 0) {
    options.start -= kBefore;
    options.duration += kBefore;
  }
  return options;
}

std::optional<WetGround> ground_of(const RainSettings& settings, const Scene* seen) {
  if (!settings.ground.there) return std::nullopt;
  std::optional<WetGround> ground(ground_cells(settings.ground, seen));
  if (settings.rained_mm > 0) {
    ground->rain(settings.rained_mm * 1e-3);
    ground->settle();
  }
  return ground;
}

/// The region of the cells, where nothing else is said.
RippleOptions on_ground(RippleOptions options, const GroundOptions& cells) {
  options.up = cells.up;
  if (options.low == options.high) {
    options.low = cells.low;
    options.high = cells.high;
  }
  return options;
}

/// Rings on deep water: steps so wide that there are not too many points.
RippleOptions on_water(RippleOptions options, Axis up, const Bounds& water) {
  const FieldAxes axes(up);
  options.up = up;
  options.low = {water.low[axes.a], water.low[axes.b]};
  options.high = {water.high[axes.a], water.high[axes.b]};
  const vec2 size = options.high - options.low;
  options.step =
      std::max(options.step, static_cast<float>(std::sqrt(static_cast<double>(size.x) * size.y / kMostPoints)));
  return options;
}

}  // namespace

struct RainyScene::Parts {
  Parts(const RainSettings& asked, const Scene* seen)
      : settings(asked),
        ground(ground_of(asked, seen)),
        rain(rain_onto(asked, ground ? &*ground : nullptr)),
        on_cells(asked.splashes),
        elsewhere(asked.splashes) {
    const RainOptions& options = rain.options();
    tick = static_cast<std::int64_t>(std::floor(std::min(options.start, 0.0) / kTick));
    up = direction_of(options.up);
    if (settings.look.haze == 0) settings.look.haze = rain.extinction();
    // What is too small to be made drop by drop comes down with the drops that are, so that roofs keep it off too.
    const double rate = options.rate_mm_h / 3.6e6;
    with_mist = rate > rain.rate_of_mist() ? rate / (rate - rain.rate_of_mist()) : 1;
    if (ground) {
      fallen = ground->budget().fallen;
      relief = make_solid(relief_mesh(*ground, lowest_bed(*ground) - kPlane));
      if (settings.with_ripples) {
        rings_on_ground.emplace(on_ground(settings.ripples, ground->options()));
        rings_on_ground->set_depths(puddle_depths(*ground, *rings_on_ground));
      }
    }
    flights.emplace(rain, ground ? &*ground : nullptr, kTick);
  }

  void one_tick(const Scene& scene, const Surface* water) {
    const double from = static_cast<double>(tick) * kTick, until = static_cast<double>(tick + 1) * kTick;
    hit(flights->hits(tick, scene, water));
    land(from, until);
    ++tick;
    if (ground && tick % kTicksOfFlow == 0) ground->flow(kTick * kTicksOfFlow);
    if (rings_on_ground) {
      if (tick % kTicksOfDepths == 0) rings_on_ground->set_depths(puddle_depths(*ground, *rings_on_ground));
      rings_on_ground->advance(kTick);
    }
    if (rings_on_water) rings_on_water->advance(kTick);
    if (tick % kTicksOfRetiring == 0) retire();
  }

  /// A picture may be of any time in the last tick: what was over at its beginning is not seen.
  void retire() {
    const double over = static_cast<double>(tick - 1) * kTick;
    on_cells.retire(over);
    elsewhere.retire(over);
  }

  /// The drops of a tick, in order of time. How wet the ground is counts as it was when the tick began.
  void hit(std::vector<Flight> flights_of_tick) {
    std::erase_if(flights_of_tick, [](const Flight& flight) { return flight.target == Flight::Target::nothing; });
    hits += flights_of_tick.size();
    const auto middle = std::stable_partition(flights_of_tick.begin(), flights_of_tick.end(), [](const Flight& flight) {
      return flight.target == Flight::Target::ground;
    });
    const std::span<const Flight> drops(flights_of_tick);
    const auto on_ground = static_cast<std::size_t>(middle - flights_of_tick.begin());
    std::vector<Impact> impacts(drops.size());
    parallel_for(drops.size(), kImpacts, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) impacts[i] = impact_of(drops[i]);
    });
    std::vector<double> flies(drops.size());
    on_cells.add(std::span(impacts).first(on_ground), std::span(flies).first(on_ground));
    elsewhere.add(std::span(impacts).subspan(on_ground), std::span(flies).subspan(on_ground));
    for (std::size_t i = 0; i < on_ground; ++i) {
      const std::size_t cell = drops[i].cell;
      const double brought = rain.volume(drops[i].drop) * with_mist;
      in_air += flies[i];
      ground->add(cell, std::max(brought - flies[i], 0.0));
      fallen += std::max(brought, flies[i]);
      if (rings_on_ground && ground->depth(cell) > kPuddle) ring(*rings_on_ground, impacts[i]);
    }
    if (rings_on_water)
      for (std::size_t i = on_ground; i < drops.size(); ++i)
        if (drops[i].target == Flight::Target::water) ring(*rings_on_water, impacts[i]);
  }

  Impact impact_of(const Flight& flight) const {
    Impact impact;
    impact.id = flight.drop.id;
    impact.time = flight.hit;
    impact.point = flight.point;
    impact.normal = flight.normal;
    impact.velocity = rain.velocity(flight.drop, flight.hit);
    impact.diameter = flight.drop.diameter;
    impact.wind = rain.wind().at(flight.point, flight.hit);
    switch (flight.target) {
      case Flight::Target::ground:
        impact.material = ground->material(flight.cell);
        impact.wetness = ground->wetness(flight.cell);
        impact.point += static_cast<float>(ground->depth(flight.cell)) * up;
        break;
      case Flight::Target::water:
        // Crowns and cones rise upright, whatever the waves; on the steep side of a breaking one they do not rise.
        impact.wetness = glm::dot(flight.normal, up) > kSteepest ? Wetness::puddle_10mm : Wetness::dry;
        impact.material = GroundMaterial::concrete;
        impact.normal = up;
        break;
      case Flight::Target::plane:
        impact.material = settings.ground.cells.material;
        impact.wetness = Wetness::wet;
        break;
      case Flight::Target::body: {
        const bool wet = settings.rained_mm > 0 || flight.hit > rain.options().start + kSoonWet;
        impact.material = settings.bodies;
        impact.wetness = wet ? Wetness::wet : Wetness::dry;
        break;
      }
      case Flight::Target::nothing:
        break;
    }
    return impact;
  }

  void ring(Ripples& ripples, const Impact& impact) const {
    ripples.hit(impact.point, impact.diameter, std::max(0.0f, -glm::dot(impact.velocity, up)));
  }

  /// Droplets of splashes come down.
  void land(double from, double until) {
    for (const Landing& landing : on_cells.landings(from, until)) {
      in_air -= landing.volume;
      const std::optional<std::size_t> cell = ground->cell_at(landing.point);
      if (!cell) {
        outside += landing.volume;
        continue;
      }
      ground->add(*cell, landing.volume);
      if (rings_on_ground && ground->depth(*cell) > kPuddle)
        rings_on_ground->hit(landing.point, 2 * landing.radius, landing.speed);
      if (settings.splashes.secondary) splash_again(landing, ground->material(*cell), ground->wetness(*cell));
    }
    if (!rings_on_water) return;
    for (const Landing& landing : elsewhere.landings(from, until))
      rings_on_water->hit(landing.point, 2 * landing.radius, landing.speed);
  }

  /// Their droplets bring no water: it has been counted already.
  void splash_again(const Landing& landing, GroundMaterial material, Wetness wetness) {
    Impact impact;
    impact.id = mixed(mixed(settings.splashes.seed) ^ ++again);
    impact.time = landing.time;
    impact.point = landing.point;
    impact.normal = up;
    impact.velocity = -landing.speed * up;
    impact.diameter = 2 * landing.radius;
    impact.wind = rain.wind().at(landing.point, landing.time);
    impact.material = material;
    impact.wetness = wetness;
    elsewhere.add(impact);
  }

  RainSettings settings;
  std::optional<WetGround> ground;
  Rain rain;
  Splashes on_cells, elsewhere;  ///< what comes down from the first goes back into the ground
  std::optional<Ripples> rings_on_ground, rings_on_water;
  std::optional<Flights> flights;
  std::shared_ptr<const Solid> relief;
  std::optional<std::vector<PlacedSolid>> panes;  ///< of the tank, that drops do not go through
  vec3 up{0, 1, 0};
  std::int64_t tick = 0;                                   ///< the next one
  double time = -std::numeric_limits<double>::infinity();  ///< that was asked for last
  double with_mist = 1;                                    ///< factor of the drops' water
  std::size_t hits = 0;
  std::uint64_t again = 0;  ///< secondary splashes so far
  double fallen = 0;        ///< m^3 on cells since the beginning
  double in_air = 0;        ///< m^3, of droplets
  double outside = 0;       ///< m^3, of droplets that came down beside the cells
};

RainyScene::RainyScene(const RainSettings& settings, const Scene* seen_from_above)
    : parts_(std::make_unique<Parts>(settings, seen_from_above)) {}
RainyScene::~RainyScene() = default;

const RainSettings& RainyScene::settings() const { return parts_->settings; }
double RainyScene::time() const { return parts_->time; }
std::size_t RainyScene::splashes() const { return parts_->on_cells.size() + parts_->elsewhere.size(); }
std::size_t RainyScene::hits() const { return parts_->hits; }

void RainyScene::advance(double time, const Scene& scene, const Surface* water, StageTimes* times) {
  Parts& parts = *parts_;
  const double now = static_cast<double>(parts.tick) * kTick;
  if (!(time >= parts.time) || !(time - now <= kLongest))
    throw Error(ErrorCode::invalid_argument, {"the rain cannot go to this time",
                                              fmt::format("from {} s on, by a day at most", std::max(parts.time, now)),
                                              fmt::format("{} s", time),
                                              {},
                                              {},
                                              {},
                                              {}});
  const StageTimer timer(times, "rain");
  parts.time = time;
  const Surface* deep = water && water->can_march() && !water->bounds().empty() ? water : nullptr;
  if (deep && parts.settings.with_ripples && !parts.rings_on_water) {
    const Bounds where = parts.settings.water.empty() ? deep->bounds() : parts.settings.water;
    parts.rings_on_water.emplace(on_water(parts.settings.ripples, parts.rain.options().up, where));
    parts.rings_on_water->set_depths(water_depths(*parts.rings_on_water, *deep, scene, kDeep));
  }
  if (!parts.panes) parts.panes = glass_panes(scene.tank());
  const Scene met = parts.panes->empty() ? scene : with_solids(scene, *parts.panes);
  const std::int64_t before = parts.tick;
  while (static_cast<double>(parts.tick) * kTick < time) parts.one_tick(met, deep);
  if (parts.tick > before) parts.retire();
}

WaterBudget RainyScene::budget() const {
  const Parts& parts = *parts_;
  WaterBudget budget;
  if (!parts.ground) return budget;
  budget = parts.ground->budget();
  budget.fallen = parts.fallen;
  budget.standing += parts.in_air;
  budget.drained += parts.outside;
  return budget;
}

std::shared_ptr<const Solid> RainyScene::relief() const { return parts_->relief; }

std::shared_ptr<const GroundCover> RainyScene::cover() const {
  return parts_->ground ? wet_ground_cover(*parts_->ground, parts_->settings.ground.look) : nullptr;
}

HeightField RainyScene::puddles() const {
  if (!parts_->ground) return {};
  return puddle_field(*parts_->ground, parts_->rings_on_ground ? &*parts_->rings_on_ground : nullptr);
}

HeightField RainyScene::rings() const {
  HeightField field;
  if (!parts_->rings_on_water) return field;
  const Ripples& ripples = *parts_->rings_on_water;
  const FieldAxes axes(ripples.options().up);
  const vec3 low = ripples.place(0, 0, 0);
  field.up = ripples.options().up;
  field.low = {low[axes.a], low[axes.b]};
  field.step = vec2(ripples.options().step);
  field.height = Image<float>(ripples.width(), ripples.height());
  std::copy(ripples.heights().begin(), ripples.heights().end(), field.height.begin());
  find_normals(field);
  return field;
}

std::vector<WaterPiece> RainyScene::pieces(const View& view) const {
  const Parts& parts = *parts_;
  std::vector<WaterPiece> pieces;
  const RainShown shown = parts.settings.shown;
  if (shown == RainShown::all || shown == RainShown::splashes) {
    parts.on_cells.pieces(parts.time, &view, pieces);
    parts.elsewhere.pieces(parts.time, &view, pieces);
  }
  if (shown == RainShown::all || shown == RainShown::streaks)
    add_streaks(parts.rain, *parts.flights, parts.settings, parts.time, view, pieces);
  return pieces;
}

}  // namespace meniscus
