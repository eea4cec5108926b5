#include "surface/particle_sizes.h"

#include <fmt/format.h>

namespace meniscus {
namespace {

constexpr float kAlike = 1e-4f;  ///< relative difference of sizes that count as equal

struct Extremes {
  std::size_t least = 0, largest = 0;  ///< particles
};

Extremes checked(std::span<const float> lengths, std::string_view what) {
  Extremes found;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (!(lengths[i] > 0 && lengths[i] < std::numeric_limits<float>::infinity()))
      throw Error(ErrorCode::invalid_argument, ErrorDetail{fmt::format("the {} of a particle is not a length", what),
                                                           "more than 0 m",
                                                           fmt::format("{} of particle {}", lengths[i], i),
                                                           {},
                                                           {},
                                                           {},
                                                           {}});
    if (lengths[i] < lengths[found.least]) found.least = i;
    if (lengths[i] > lengths[found.largest]) found.largest = i;
  }
  if (lengths.empty() || lengths[found.largest] <= kLargestSizeRatio * lengths[found.least]) return found;
  throw Error(ErrorCode::limit_exceeded,
              ErrorDetail{fmt::format("the particles' {}s differ too much", what),
                          fmt::format("at most {:g} times the smallest", kLargestSizeRatio),
                          fmt::format("{} m of particle {} and {} m of particle {}", lengths[found.least], found.least,
                                      lengths[found.largest], found.largest),
                          {},
                          {},
                          {},
                          "clamp the sizes, or leave out the smallest or the largest particles"});
}

void require_count(std::span<const float> lengths, std::size_t count, std::string_view what) {
  if (!lengths.empty() && lengths.size() != count)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("{} {}s were given for {} particles", lengths.size(), what, count));
}

}  // namespace

RaycastOptions options_of_size(const RaycastOptions& options, float spacing, float smoothing_length) {
  RaycastOptions result = options;
  result.normal_radius = options.normal_radius * (spacing / options.spacing);
  result.spacing = spacing;
  result.smoothing_length = smoothing_length;
  return result;
}

ResolvedSizes resolve_sizes(const ParticleSizes& sizes, const RaycastOptions& options, std::size_t count) {
  ResolvedSizes result{options, {}, {}};
  require_count(sizes.spacing, count, "spacing");
  require_count(sizes.smoothing_length, count, "smoothing length");
  // Without a spacing of its own the options are refused elsewhere.
  if (sizes.empty() || count == 0 || !(options.spacing > 0 && std::isfinite(options.spacing))) return result;

  const float spacings = options.smoothing_length == 0 ? 2.0f : options.smoothing_length / options.spacing;
  const Extremes s = checked(sizes.spacing, "spacing"), h = checked(sizes.smoothing_length, "smoothing length");
  const auto spacing = [&](std::size_t i) { return sizes.spacing.empty() ? options.spacing : sizes.spacing[i]; };
  const auto length = [&](std::size_t i) {
    return sizes.smoothing_length.empty() ? spacings * spacing(i) : sizes.smoothing_length[i];
  };
  if (!sizes.smoothing_length.empty())
    for (std::size_t i = 0; i < count; ++i)
      if (!(length(i) >= spacing(i) && length(i) <= 20 * spacing(i)))
        throw Error(ErrorCode::invalid_argument, ErrorDetail{"the smoothing length of a particle is out of range",
                                                             fmt::format("1 to 20 spacings of {} m", spacing(i)),
                                                             fmt::format("{} of particle {}", length(i), i),
                                                             {},
                                                             {},
                                                             {},
                                                             {}});
  const std::size_t by_length = sizes.smoothing_length.empty() ? s.largest : h.largest;
  const float largest = sizes.smoothing_length.empty() && options.smoothing_length == 0 ? 0.0f : length(by_length);
  result.options = options_of_size(options, spacing(s.largest), largest);
  const auto alike = [](std::span<const float> lengths, const Extremes& of) {
    return lengths.empty() || lengths[of.largest] - lengths[of.least] <= kAlike * lengths[of.least];
  };
  if (alike(sizes.spacing, s) && alike(sizes.smoothing_length, h)) return result;
  result.spacing.resize(count);
  result.smoothing_length.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    result.spacing[i] = spacing(i);
    result.smoothing_length[i] = length(i);
  }
  return result;
}

const MassRule& SizedMassRules::rule(float spacing, float smoothing_length) {
  const float ratio = smoothing_length / spacing;
  if (std::abs(ratio - ratio_) > 1e-5f * ratio) {
    RaycastOptions unit = options_;
    unit.spacing = 1.0f;
    unit.smoothing_length = ratio_ = ratio;
    rule_ = mass_rule(unit);
  }
  return rule_;
}

}  // namespace meniscus
