#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "meniscus/sim.h"
#include "sim/splash_make.h"
#include "sim/splash_shapes.h"
#include "sim/splash_view.h"

namespace meniscus {
namespace {

// Of a piece of parallel work: splashes that are drawn, that may have landings, impacts.
constexpr std::size_t kPiece = 256, kSplashes = 4096, kImpacts = 64;
/// Most shapes of one splash: a pile and a droplet each, a cone and its drop.
constexpr std::size_t kMostShapes = 2 * (kMostDroplets + 1);

bool finite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool within(vec3 v, float most) { return finite(v) && glm::length(v) <= most; }

void require(bool holds, const char* what, const char* expected, double found) {
  if (!holds) throw Error(ErrorCode::invalid_argument, {what, expected, std::to_string(found), {}, {}, {}, {}});
}
void require(bool holds, const char* what, const char* expected, vec3 v) {
  if (!holds)
    throw Error(ErrorCode::invalid_argument,
                {what,
                 expected,
                 std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z),
                 {},
                 {},
                 {},
                 {}});
}

void check(const SplashOptions& o) {
  require(finite(o.up) && std::abs(glm::length(o.up) - 1) < 1e-3f, "the way up of splashes is not a direction",
          "a unit vector", o.up);
  require(within(o.gravity, 1000), "the gravity of splashes is out of range", "finite, up to 1000 m/s^2", o.gravity);
  require(o.growth_time > 0 && o.growth_time <= 10, "the growth time of splashes is out of range",
          "above 0, up to 10 s", o.growth_time);
  require(o.growth_length > 0 && o.growth_length <= 10, "the growth length of splashes is out of range",
          "above 0, up to 10 m", o.growth_length);
  require(o.size >= 0.01f && o.size <= 100, "the size of splashes is out of range", "0.01 to 100", o.size);
  require(o.most_time >= 0.1f && o.most_time <= 60, "the longest time of splashes is out of range", "0.1 to 60 s",
          o.most_time);
}

void check(const Impact& i) {
  require(std::isfinite(i.time), "the time of an impact is not a number", "seconds", i.time);
  require(finite(i.point), "the place of an impact is not finite", "metres", i.point);
  require(finite(i.normal) && glm::length(i.normal) > 1e-6f, "an impact has no normal", "a direction", i.normal);
  require(within(i.velocity, 1000), "the velocity of an impact is out of range", "up to 1000 m/s", i.velocity);
  require(within(i.wind, 1000), "the wind over an impact is out of range", "up to 1000 m/s", i.wind);
  require(i.diameter >= 1e-6f && i.diameter <= 1, "the diameter of a drop is out of range", "1e-6 to 1 m", i.diameter);
}

/// A droplet as it comes down.
Landing landing_of(const Splash& splash, const Droplet& droplet, const SplashOptions& options) {
  // The drop of a cone sets out with it, and moves upright whatever the wind.
  const bool of_cone = splash.kind == SplashKind::crown_cone;
  const vec3 wind = of_cone ? vec3(0.0f) : splash.impact.wind;
  const float flight = of_cone ? droplet.lands - splash.cone_starts : droplet.lands;
  const vec3 way = formulas::orbit_offset(droplet.velocity, wind, options.gravity, droplet.drag, flight);
  const vec3 velocity = formulas::orbit_velocity(droplet.velocity, wind, options.gravity, droplet.drag, flight);
  return {splash.impact.time + droplet.lands, droplet.start + way, volume_of(droplet), droplet.radius,
          glm::length(velocity)};
}

}  // namespace

Splashes::Splashes(const SplashOptions& options) : options_(options) { check(options); }

double Splashes::add(const Impact& impact) {
  double flies = 0;
  add({&impact, 1}, {&flies, 1});
  return flies;
}

void Splashes::add(std::span<const Impact> impacts, std::span<double> flies) {
  if (impacts.size() != flies.size())
    throw Error(ErrorCode::invalid_argument, "the lists of impacts and of what flies from them differ in length");
  for (const Impact& impact : impacts) check(impact);
  // Each piece makes its own; they are put one behind the other.
  struct Made {
    std::vector<Splash> splashes;
    std::vector<Droplet> droplets;
  };
  std::vector<Made> pieces((impacts.size() + kImpacts - 1) / kImpacts);
  parallel_for(impacts.size(), kImpacts, [&](std::size_t begin, std::size_t end) {
    Made& made = pieces[begin / kImpacts];
    for (std::size_t i = begin; i < end; ++i) {
      Impact impact = impacts[i];
      impact.normal = glm::normalize(impact.normal);
      const Splash splash = make_splash(impact, options_, made.droplets);
      flies[i] = 0;
      if (splash.kind == SplashKind::none) continue;
      made.splashes.push_back(splash);
      for (std::size_t d = splash.first; d < made.droplets.size(); ++d) flies[i] += volume_of(made.droplets[d]);
    }
  });
  for (Made& made : pieces) {
    for (Splash& splash : made.splashes) splash.first += droplets_.size();
    splashes_.insert(splashes_.end(), made.splashes.begin(), made.splashes.end());
    droplets_.insert(droplets_.end(), made.droplets.begin(), made.droplets.end());
    flying_ += made.droplets.size();
  }
}

std::vector<Landing> Splashes::landings(double from, double until) const {
  std::vector<std::vector<Landing>> pieces((splashes_.size() + kSplashes - 1) / kSplashes);
  parallel_for(splashes_.size(), kSplashes, [&](std::size_t piece_begin, std::size_t piece_end) {
    std::vector<Landing>& found = pieces[piece_begin / kSplashes];
    for (std::size_t i = piece_begin; i < piece_end; ++i) {
      const Splash& splash = splashes_[i];
      const double start = splash.impact.time;
      if (splash.count == 0 || start > until || start + splash.ends <= from) continue;
      const auto time_of = [&](const Droplet& droplet) { return start + droplet.lands; };
      // Of a crown-cone only the first droplet flies; the others are its crown.
      const std::size_t flying = splash.kind == SplashKind::crown_cone ? 1 : splash.count;
      const auto begin = droplets_.begin() + static_cast<std::ptrdiff_t>(splash.first);
      const auto end = begin + static_cast<std::ptrdiff_t>(flying);
      auto droplet = std::upper_bound(begin, end, from, [&](double t, const Droplet& d) { return t < time_of(d); });
      for (; droplet != end && time_of(*droplet) <= until; ++droplet)
        found.push_back(landing_of(splash, *droplet, options_));
    }
  });
  std::vector<Landing> landings;
  for (const auto& piece : pieces) landings.insert(landings.end(), piece.begin(), piece.end());
  std::stable_sort(landings.begin(), landings.end(),
                   [](const Landing& a, const Landing& b) { return a.time < b.time; });
  return landings;
}

void Splashes::retire(double time) {
  const auto over = [&](const Splash& splash) { return splash.impact.time + splash.ends <= time; };
  std::erase_if(splashes_, over);
  flying_ = 0;
  for (const Splash& splash : splashes_) flying_ += splash.count;
  // The droplets of forgotten splashes are cleared out when they are more than the others: on the whole each droplet is
  // moved about once.
  if (droplets_.size() <= 2 * flying_ + 1024) return;
  std::size_t to = 0;
  for (Splash& splash : splashes_) {
    const auto first = droplets_.begin() + static_cast<std::ptrdiff_t>(splash.first);
    std::copy(first, first + static_cast<std::ptrdiff_t>(splash.count),
              droplets_.begin() + static_cast<std::ptrdiff_t>(to));
    splash.first = to;
    to += splash.count;
  }
  droplets_.resize(to);
}

void Splashes::pieces(double time, const View* view, std::vector<WaterPiece>& pieces) const {
  const auto age_of = [&](const Splash& splash) { return static_cast<float>(time - splash.impact.time); };
  const auto droplets_of = [&](const Splash& splash) {
    return std::span<const Droplet>(droplets_).subspan(splash.first, splash.count);
  };
  const auto count = [&](const Splash& splash, float age) {
    std::size_t shapes = 0;
    SplashShapes(splash, options_, age, [&](auto&&) { ++shapes; }).show(droplets_of(splash));
    return shapes;
  };
  const auto fill = [&](const Splash& splash, float age, WaterPiece* out) {
    SplashShapes(splash, options_, age, [&](auto&& make) { *out++ = make(); }).show(droplets_of(splash));
    return out;
  };
  // As much as the splash can have grown to by now, against a pixel where it is.
  const auto is_small = [&](const Splash& splash, float age) {
    if (!view) return false;
    const float reach = std::min(splash.reach, splash.circle + splash.width + splash.fastest * age);
    float depth = glm::dot(splash.impact.point - view->eye, view->forward);
    if (view->projection == Projection::cube) depth = glm::length(splash.impact.point - view->eye) / std::sqrt(3.0f);
    return 2 * reach <= view->pixel_size(std::max(depth - reach, 0.0f));
  };

  // How many pieces each splash has, and where they begin.
  std::vector<std::size_t> ends(splashes_.size());
  parallel_for(splashes_.size(), kPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Splash& splash = splashes_[i];
      const float age = age_of(splash);
      ends[i] = 0;
      if (!(age > 0 && age < splash.ends) || (view && !may_show(*view, splash.impact.point, splash.reach))) continue;
      ends[i] = count(splash, age);
      if (ends[i] > 1 && is_small(splash, age)) ends[i] = 1;
    }
  });
  std::size_t sum = pieces.size();
  for (std::size_t& end : ends) end = sum += end;

  const std::size_t before = pieces.size();
  pieces.resize(sum);
  parallel_for(splashes_.size(), kPiece, [&](std::size_t begin, std::size_t end) {
    std::array<WaterPiece, kMostShapes> whole;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t first = i > 0 ? ends[i - 1] : before, shown = ends[i] - first;
      if (shown == 0) continue;
      const Splash& splash = splashes_[i];
      const float age = age_of(splash);
      if (shown == 1 && is_small(splash, age)) {
        const WaterPiece* last = fill(splash, age, whole.data());
        pieces[first] = merged(std::span<const WaterPiece>(whole.data(), last), *view);
      } else {
        fill(splash, age, pieces.data() + first);
      }
    }
  });
}

}  // namespace meniscus
