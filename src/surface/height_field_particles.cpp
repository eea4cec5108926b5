// Height fields from particles [Cords2008] 3.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "meniscus/particles.h"
#include "surface/column_potential.h"
#include "surface/height_field_axes.h"
#include "surface/height_field_grid.h"

namespace meniscus {
namespace {

constexpr float kDry = -std::numeric_limits<float>::infinity();
constexpr float kReach = 2.0f;       ///< spacings; default of the iso-radius
constexpr float kSmoothing = 0.75f;  ///< spacings; default of the smoothing
constexpr float kSunken = 1.25f;     ///< spacings around solids where the raw surface is not believed
constexpr float kDrop = 4.0f;        ///< spacings; default thickness of drops

[[noreturn]] void fail(std::string problem, std::string expected, std::string found) {
  throw Error(ErrorCode::invalid_argument,
              ErrorDetail{std::move(problem), std::move(expected), std::move(found), {}, {}, {}, {}});
}

/// A column sums over all particles within the iso-radius: beyond this many spacings nothing is gained.
constexpr float kLargestRadius_rel = 12;

HeightFieldOptions resolved(const HeightFieldOptions& given, const Particles& particles,
                            std::span<const vec3> colours) {
  const auto length = [](float value) { return value >= 0 && std::isfinite(value); };
  if (!(given.spacing > 0) || !std::isfinite(given.spacing))
    fail("the spacing of the particles is out of range", "more than 0 m", fmt::format("{} m", given.spacing));
  if (!length(given.iso_radius) || (given.iso_radius > 0 && given.iso_radius < 0.5f * given.spacing) ||
      given.iso_radius > kLargestRadius_rel * given.spacing)
    fail("the iso-radius is out of range", fmt::format("0 for the default, or 0.5 to {} spacings", kLargestRadius_rel),
         fmt::format("{} m at a spacing of {} m", given.iso_radius, given.spacing));
  if (!length(given.iso)) fail("the iso-value is out of range", "more than 0", fmt::format("{}", given.iso));
  if (!length(given.step))
    fail("the step is out of range", "0 m for the default or more", fmt::format("{} m", given.step));
  if (!length(given.drop))
    fail("the drops' thickness is out of range", "0 m for the default or more", fmt::format("{} m", given.drop));
  if (std::isnan(given.smoothing) || given.smoothing == std::numeric_limits<float>::infinity())
    fail("the smoothing is out of range", "0 m or more", fmt::format("{} m", given.smoothing));
  if (!colours.empty() && colours.size() != particles.size())
    fail("there is not one colour for each particle", fmt::format("{}", particles.size()),
         fmt::format("{}", colours.size()));
  HeightFieldOptions options = given;
  if (options.iso_radius == 0) options.iso_radius = kReach * options.spacing;
  // Half of what the potential is inside the water: h^3 / spacing^3 times 4 pi int r^2 sqrt(1 - r^2) dr = pi^2 / 4.
  const float in_spacings = options.iso_radius / options.spacing;
  if (options.iso == 0) options.iso = in_spacings * in_spacings * in_spacings * 1.2337006f;
  if (options.step == 0) options.step = 0.5f * options.spacing;
  if (options.smoothing < 0) options.smoothing = kSmoothing * options.spacing;
  if (options.drop == 0) options.drop = kDrop * options.spacing;
  if (options.region.empty()) {
    options.region = robust_bounds(particles);
    if (!options.region.empty()) options.region = options.region.grown(0.5f * options.spacing);
  }
  return options;
}

/// Columns within `radius` m of a marked one.
Image<std::uint8_t> grown(const Image<std::uint8_t>& marked, vec2 step, float radius) {
  Image<std::uint8_t> result(marked.width(), marked.height(), 0);
  const int reach_a = static_cast<int>(radius / step.x), reach_b = static_cast<int>(radius / step.y);
  for (int j = 0; j < marked.height(); ++j)
    for (int i = 0; i < marked.width(); ++i) {
      if (!marked(i, j)) continue;
      for (int q = std::max(j - reach_b, 0); q <= std::min(j + reach_b, marked.height() - 1); ++q)
        for (int p = std::max(i - reach_a, 0); p <= std::min(i + reach_a, marked.width() - 1); ++p) {
          const float a = static_cast<float>(p - i) * step.x, b = static_cast<float>(q - j) * step.y;
          if (a * a + b * b <= radius * radius) result(p, q) = 1;
        }
    }
  return result;
}

/// Lets the field go on through solids: there, and as far as they take particles away, it is a sheet between the rest.
void fill_solids(HeightField& field, const HeightFieldOptions& options) {
  const int width = field.height.width(), height = field.height.height();
  // Where a solid leaves no water at all, its level is guessed from the water around.
  Image<float> guess = field.height;
  Image<std::uint8_t> dry(width, height, 0), solid(width, height, 0);
  for (std::size_t i = 0; i < guess.size(); ++i) dry[i] = !(guess[i] > kDry);
  if (std::find(dry.begin(), dry.end(), 0) == dry.end()) return;
  fill_unknown(guess, dry);
  parallel_for(static_cast<std::size_t>(height), 4, [&](std::size_t begin, std::size_t end) {
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
      for (int i = 0; i < width; ++i) {
        // Under a floating body the raw surface lies a little below it.
        const vec3 at = field.point(static_cast<float>(i), static_cast<float>(j), guess(i, j));
        solid(i, j) = options.in_solid(at) || options.in_solid(at + options.spacing * direction_of(options.up));
      }
  });
  fill_unknown(field.height, grown(solid, field.step, kSunken * options.spacing));
}

}  // namespace

HeightField height_field(const Particles& particles, const HeightFieldOptions& given, std::span<const vec3> colours,
                         StageTimes* times) {
  const HeightFieldOptions options = resolved(given, particles, colours);
  if (options.region.empty()) {
    HeightField nothing;
    nothing.up = options.up;
    nothing.step = {options.step, options.step};
    nothing.spacing = options.spacing;
    return nothing;
  }
  HeightField field = blank_field(options.up, options.region, options.step);
  field.spacing = options.spacing;
  const int width = field.height.width();
  const FieldAxes axes(options.up);
  std::optional<ColumnPotential> potential;
  {
    StageTimer timer(times, "sort");
    potential.emplace(particles, options.up, options.region,
                      ColumnOptions{options.spacing, options.iso_radius, options.iso, options.drop});
  }
  const auto for_each_column = [&](auto visit) {
    parallel_for(field.height.size(), 256, [&](std::size_t begin, std::size_t end) {
      thread_local ColumnPotential::Near near;
      for (std::size_t c = begin; c < end; ++c) {
        const auto i = static_cast<float>(c % static_cast<std::size_t>(width)),
                   j = static_cast<float>(c / static_cast<std::size_t>(width));
        visit(c, field.low.x + i * field.step.x, field.low.y + j * field.step.y, near);
      }
    });
  };
  {
    StageTimer timer(times, "columns");
    for_each_column([&](std::size_t c, float a, float b, ColumnPotential::Near& near) {
      const auto in_solid = [&](float z) { return options.in_solid && options.in_solid(axes.place(a, b, z)); };
      field.height[c] = potential->height(a, b, in_solid, near);
    });
  }
  {
    StageTimer timer(times, "smooth");
    if (options.in_solid) fill_solids(field, options);
    smooth_heights(field, options.smoothing);
  }
  if (!colours.empty()) {
    StageTimer timer(times, "colours");
    field.colour = Image<vec3>(width, field.height.height(), vec3{0.0f});
    for_each_column([&](std::size_t c, float a, float b, ColumnPotential::Near& near) {
      if (field.height[c] > kDry) field.colour[c] = potential->colour(a, b, field.height[c], colours, near);
    });
  }
  if (options.want_normals) {
    StageTimer timer(times, "normals");
    find_normals(field);
  }
  return field;
}

}  // namespace meniscus
