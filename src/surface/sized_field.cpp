#include "surface/sized_field.h"

#include <fmt/format.h>

namespace meniscus {
namespace {

/// Particles of one level, by given index.
using Members = std::vector<std::uint32_t>;

/// Level k holds smoothing lengths up to 2^(k + 1) times the least.
std::vector<Members> sort_into_levels(const ResolvedSizes& own) {
  const float least = *std::min_element(own.smoothing_length.begin(), own.smoothing_length.end());
  std::vector<Members> levels;
  for (std::size_t i = 0; i < own.smoothing_length.size(); ++i) {
    std::size_t level = 0;
    for (float most = 2 * least; own.smoothing_length[i] > most; most *= 2) ++level;
    if (level >= levels.size()) levels.resize(level + 1);
    levels[level].push_back(static_cast<std::uint32_t>(i));
  }
  std::erase_if(levels, [](const Members& members) { return members.empty(); });
  return levels;
}

RaycastField level_of(const Particles& particles, const ResolvedSizes& own, std::span<const vec3> colours,
                      const Members& members) {
  Particles chosen;
  std::vector<vec3> chosen_colours;
  float spacing = 0, length = 0, least = std::numeric_limits<float>::infinity();
  chosen.x.reserve(members.size());
  chosen.y.reserve(members.size());
  chosen.z.reserve(members.size());
  for (const std::uint32_t i : members) {
    chosen.x.push_back(particles.x[i]);
    chosen.y.push_back(particles.y[i]);
    chosen.z.push_back(particles.z[i]);
    if (!colours.empty()) chosen_colours.push_back(colours[i]);
    spacing = std::max(spacing, own.spacing[i]);
    least = std::min(least, own.spacing[i]);
    length = std::max(length, own.smoothing_length[i]);
  }
  // The longest reach may be that of a particle with a smaller spacing: then it is more of the largest spacing's.
  RaycastField field = make_field(chosen, options_of_size(own.options, spacing, length), chosen_colours,
                                  own.options.cull_interior ? Keep::all_kinds : Keep::all, least);
  const std::size_t kept = field.grid.size();
  field.per_spacing.assign(field.mass.size(), 1.0f);
  field.per_smoothing.assign(field.mass.size(), 1.0f);
  for (std::size_t i = 0; i < kept; ++i) {
    const std::uint32_t given = members[field.grid.given_index(i)];
    field.per_spacing[i] = spacing / own.spacing[given];
    field.per_smoothing[i] = length / own.smoothing_length[given];
    field.entry_radius[i] =
        entry_radius_at(options_of_size(field.options, own.spacing[given], own.smoothing_length[given]), 1.0f);
  }
  return field;
}

}  // namespace

RaycastField make_sized_field(const Particles& particles, const ResolvedSizes& own, std::span<const vec3> colours) {
  if (own.empty()) return make_field(particles, own.options, colours);
  if (!colours.empty() && colours.size() != particles.size())
    throw Error(ErrorCode::invalid_argument,
                fmt::format("{} colours were given for {} particles", colours.size(), particles.size()));
  const std::vector<Members> levels = sort_into_levels(own);
  RaycastField field = level_of(particles, own, colours, levels.front());
  for (std::size_t k = 1; k < levels.size(); ++k) field.coarser.push_back(level_of(particles, own, colours, levels[k]));
  for (const RaycastField& level : field.coarser)
    field.least_spacing = std::min(field.least_spacing, level.least_spacing);
  field.widest_entry = 1;
  field.step = field.options.step * *std::min_element(own.smoothing_length.begin(), own.smoothing_length.end());
  return field;
}

}  // namespace meniscus
