#include "sim/wind_field.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr std::size_t kNearest = 8;        ///< points that count
constexpr float kOff_rel = 1e-3f;          ///< of a lattice's step that a point may stand beside its place
constexpr float kPointsPerCell = 2;        ///< of those that are searched for the nearest
constexpr std::uint32_t kMostCells = 512;  ///< along an axis

/// Different coordinates along an axis in rising order, those nearer than the extent's 10^-5 being one.
std::vector<float> levels_of(std::vector<float> coordinates) {
  std::sort(coordinates.begin(), coordinates.end());
  const float same = 1e-5f * (coordinates.back() - coordinates.front());
  std::vector<float> levels;
  for (const float c : coordinates)
    if (levels.empty() || c - levels.back() > same) levels.push_back(c);
  return levels;
}

}  // namespace

WindField::WindField(const Particles& points) {
  const auto refuse = [](std::string problem, std::string expected, std::string found) {
    throw Error(ErrorCode::invalid_argument,
                {std::move(problem), std::move(expected), std::move(found), {}, {}, {}, {}});
  };
  if (points.empty()) refuse("the field of the wind has no points", "one at least", "0");
  const Attribute* velocity = points.find("velocity");
  if (!velocity || velocity->components != 3 || velocity->values.size() != 3 * points.size())
    refuse("the field of the wind has no velocities", "an attribute \"velocity\" of three numbers a point",
           velocity ? fmt::format("{} numbers for {} points", velocity->values.size(), points.size()) : "none");
  glm::dvec3 sum{0.0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const vec3 p = points.position(i);
    const float* v = velocity->values.data() + 3 * i;
    if (!std::isfinite(p.x + p.y + p.z) || !std::isfinite(v[0] + v[1] + v[2]))
      refuse("the field of the wind holds a number that is not finite", "", fmt::format("point {}", i));
    bounds_.add(p);
    sum += glm::dvec3{v[0], v[1], v[2]};
  }
  mean_ = vec3(sum / static_cast<double>(points.size()));
  lattice_ = fill_lattice(points);
  if (!lattice_) fill_cells(points);
}

bool WindField::fill_lattice(const Particles& points) {
  const std::vector<float>* coordinates[3] = {&points.x, &points.y, &points.z};
  pitch_ = std::numeric_limits<float>::infinity();
  std::size_t places = 1;
  for (int a = 0; a < 3; ++a) {
    const std::vector<float> levels = levels_of(*coordinates[a]);
    places *= levels.size();
    if (places > points.size()) return false;
    count_[static_cast<std::size_t>(a)] = static_cast<std::uint32_t>(levels.size());
    step_[a] = levels.size() > 1 ? bounds_.extent()[a] / static_cast<float>(levels.size() - 1) : 1.0f;
    if (levels.size() > 1) pitch_ = std::min(pitch_, step_[a]);
    for (std::size_t k = 0; k < levels.size(); ++k)
      if (std::abs(levels[k] - bounds_.low[a] - static_cast<float>(k) * step_[a]) > kOff_rel * step_[a]) return false;
  }
  if (places != points.size()) return false;
  velocities_.resize(places);
  std::vector<bool> filled(places);
  const float* values = points.find("velocity")->values.data();
  for (std::size_t i = 0; i < places; ++i) {
    const vec3 cell = glm::round((points.position(i) - bounds_.low) / step_);
    const std::size_t k = static_cast<std::size_t>(cell.x) +
                          count_[0] * (static_cast<std::size_t>(cell.y) + count_[1] * static_cast<std::size_t>(cell.z));
    if (filled[k]) return false;
    filled[k] = true;
    velocities_[k] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  }
  return true;
}

std::uint32_t WindField::cell_along(int axis, float coordinate) const {
  const float cell = (coordinate - bounds_.low[axis]) / step_[axis];
  return static_cast<std::uint32_t>(
      std::clamp(cell, 0.0f, static_cast<float>(count_[static_cast<std::size_t>(axis)] - 1)));
}

void WindField::fill_cells(const Particles& points) {
  // Cubes that hold a few points each, were these spread evenly over the box's longer sides.
  const vec3 extent = bounds_.extent();
  const float longest = std::max({extent.x, extent.y, extent.z});
  const vec3 sides = glm::max(extent, vec3(1e-3f * longest));
  const float cells = static_cast<float>(points.size()) / kPointsPerCell;
  const float edge =
      longest > 0 ? std::max(std::cbrt(sides.x * (sides.y / cells) * sides.z), longest / static_cast<float>(kMostCells))
                  : 1.0f;
  pitch_ = longest > 0 ? edge : std::numeric_limits<float>::infinity();
  step_ = vec3(edge);
  for (int a = 0; a < 3; ++a)
    count_[static_cast<std::size_t>(a)] =
        static_cast<std::uint32_t>(std::clamp(std::floor(extent[a] / edge) + 1, 1.0f, static_cast<float>(kMostCells)));
  const auto cell_of = [&](vec3 p) {
    return cell_along(0, p.x) + count_[0] * (cell_along(1, p.y) + count_[1] * std::size_t{cell_along(2, p.z)});
  };
  starts_.assign(std::size_t{count_[0]} * count_[1] * count_[2] + 1, 0);
  for (std::size_t i = 0; i < points.size(); ++i) ++starts_[cell_of(points.position(i)) + 1];
  for (std::size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  places_.resize(points.size());
  velocities_.resize(points.size());
  const float* values = points.find("velocity")->values.data();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t k = next[cell_of(points.position(i))]++;
    places_[k] = points.position(i);
    velocities_[k] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  }
}

vec3 WindField::at(vec3 place) const {
  const vec3 held = glm::clamp(place, bounds_.low, bounds_.high);
  return lattice_ ? in_lattice(held) : among_nearest(held);
}

vec3 WindField::in_lattice(vec3 place) const {
  std::size_t low[3], high[3];
  vec3 t;
  for (int a = 0; a < 3; ++a) {
    const float along = (place[a] - bounds_.low[a]) / step_[a];
    low[a] = cell_along(a, place[a]);
    high[a] = std::min<std::size_t>(low[a] + 1, count_[static_cast<std::size_t>(a)] - 1);
    t[a] = std::clamp(along - static_cast<float>(low[a]), 0.0f, 1.0f);
  }
  const auto row = [&](std::size_t y, std::size_t z) {
    const vec3* first = velocities_.data() + count_[0] * (y + count_[1] * z);
    return glm::mix(first[low[0]], first[high[0]], t.x);
  };
  return glm::mix(glm::mix(row(low[1], low[2]), row(high[1], low[2]), t.y),
                  glm::mix(row(low[1], high[2]), row(high[1], high[2]), t.y), t.z);
}

vec3 WindField::among_nearest(vec3 place) const {
  // The nearest points so far, by rising distance, one more than count; ties in the order of the cells.
  struct Near {
    float distance2;
    std::uint32_t point;
  };
  std::array<Near, kNearest + 1> nearest;
  const std::size_t wanted = std::min(nearest.size(), places_.size());
  std::size_t found = 0;
  const int middle[3] = {static_cast<int>(cell_along(0, place.x)), static_cast<int>(cell_along(1, place.y)),
                         static_cast<int>(cell_along(2, place.z))};
  const auto take = [&](std::size_t cell) {
    for (std::uint32_t k = starts_[cell]; k < starts_[cell + 1]; ++k) {
      const vec3 away = places_[k] - place;
      const float distance2 = glm::dot(away, away);
      if (found == wanted && distance2 >= nearest[found - 1].distance2) continue;
      std::size_t at = found < wanted ? found++ : found - 1;
      for (; at > 0 && nearest[at - 1].distance2 > distance2; --at) nearest[at] = nearest[at - 1];
      nearest[at] = {distance2, k};
    }
  };
  // Shells of cells outwards, until what is farther out cannot be nearer.
  const int shells = static_cast<int>(std::max({count_[0], count_[1], count_[2]}));
  for (int shell = 0; shell < shells; ++shell) {
    const float clear = static_cast<float>(shell - 1) * step_.x;  // what is not searched yet lies farther than this
    if (found == wanted && shell > 0 && clear > 0 && nearest[found - 1].distance2 <= clear * clear) break;
    int low[3], high[3];
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::max(middle[a] - shell, 0);
      high[a] = std::min(middle[a] + shell, static_cast<int>(count_[a]) - 1);
    }
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y) {
        const bool whole = std::abs(z - middle[2]) == shell || std::abs(y - middle[1]) == shell;
        const std::size_t row = count_[0] * (static_cast<std::size_t>(y) + count_[1] * static_cast<std::size_t>(z));
        if (whole) {
          for (int x = low[0]; x <= high[0]; ++x) take(row + static_cast<std::size_t>(x));
          continue;
        }
        if (middle[0] - shell >= 0) take(row + static_cast<std::size_t>(middle[0] - shell));
        if (middle[0] + shell < static_cast<int>(count_[0])) take(row + static_cast<std::size_t>(middle[0] + shell));
      }
  }
  // Weights that end where the next point begins, so that nothing jumps when the eight nearest change.
  if (nearest[0].distance2 == 0) return velocities_[nearest[0].point];
  const bool all = places_.size() <= kNearest;
  const double reach = all ? 0 : std::sqrt(double{nearest[found - 1].distance2});
  glm::dvec3 sum{0.0};
  double weights = 0;
  for (std::size_t k = 0; k < (all ? found : found - 1); ++k) {
    const double distance = std::sqrt(double{nearest[k].distance2});
    const double share = all ? 1 / distance : std::max(reach - distance, 1e-9 * reach) / (reach * distance);
    sum += share * share * glm::dvec3(velocities_[nearest[k].point]);
    weights += share * share;
  }
  return vec3(sum / weights);
}

}  // namespace meniscus
