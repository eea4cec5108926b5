#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "meniscus/particles.h"
#include "particles/nearest.h"
#include "particles/surroundings.h"

namespace meniscus {
namespace {

constexpr std::size_t kIndexed = std::size_t{1} << 19;  // particles that are searched among
constexpr std::size_t kQueries = 2048;                  // particles whose surroundings are looked at
constexpr std::size_t kNeighbours = 64;                 // of each: a ball of five spacings across

// Factors between spacings: the width of a peak; how far another peak must lie below and how high it must be, as a
// part of the higher one, to go before it; how far from the peak it is the same water.
constexpr double kPeakWidth = 1.22;
constexpr double kOtherWater = 2.0, kLowerPeak = 0.25;
constexpr double kBodyLow = 1.5, kBodyHigh = 1.7;

constexpr float kToldFactor = 2.0f;     // between what the file tells and the estimate
constexpr float kNothingKnown = 0.01f;  // m: the spacing of a particle that is alone

struct Sample {
  double log_spacing;  ///< of metres
  double dimension;
};

/// What the surroundings of the queries say, smallest spacing first.
std::vector<Sample> samples_of(const NearestIndex& index) {
  const std::vector<std::uint32_t> queries = index.sample(kQueries);
  std::vector<Surroundings> all(queries.size());
  parallel_for(queries.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) all[i] = surroundings_of(index.nearest(queries[i], kNeighbours));
  });
  std::vector<Sample> samples;
  for (const Surroundings& s : all) {
    if (s.spacing > 0) samples.push_back({std::log(s.spacing * index.unit()), s.dimension});
  }
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    return a.log_spacing != b.log_spacing ? a.log_spacing < b.log_spacing : a.dimension < b.dimension;
  });
  return samples;
}

/// Samples in the narrow window of spacings that begins at each sample.
std::vector<std::size_t> window_counts(const std::vector<Sample>& samples) {
  std::vector<std::size_t> counts(samples.size());
  for (std::size_t first = 0, end = 0; first < samples.size(); ++first) {
    const double last = samples[first].log_spacing + std::log(kPeakWidth);
    while (end < samples.size() && samples[end].log_spacing <= last) ++end;
    counts[first] = end - first;
  }
  return counts;
}

/// The peak of the spacings: middle of the window that holds most samples. Spray around a body is spread wide, but
/// there may be more of it than of the body; so a lower peak goes before a higher one if a valley parts them. In
/// clouds with clumps the one peak is broad, without a valley.
double peak_of(const std::vector<Sample>& samples) {
  const std::vector<std::size_t> counts = window_counts(samples);
  const auto begin = counts.begin();
  std::size_t best = static_cast<std::size_t>(std::max_element(begin, counts.end()) - begin);
  for (;;) {
    std::ptrdiff_t end = 0;
    const double below = samples[best].log_spacing - std::log(kOtherWater);
    while (samples[static_cast<std::size_t>(end)].log_spacing < below) ++end;
    if (end == 0) break;
    const auto lower = std::max_element(begin, begin + end);
    const auto valley = std::min_element(lower, begin + static_cast<std::ptrdiff_t>(best));
    const bool high = static_cast<double>(*lower) >= kLowerPeak * static_cast<double>(counts[best]);
    if (!high || *valley > *lower / 3) break;
    best = static_cast<std::size_t>(lower - begin);
  }
  return samples[best + counts[best] / 2].log_spacing;
}

/// The mean of the volumes around the peak: particles see the clumps that they are in, and only the mean of the
/// volumes, not their median, is that of the whole body.
SpacingEstimate from_samples(const std::vector<Sample>& samples) {
  const double peak = peak_of(samples);
  double volume = 0, dimension = 0;  // volume in units of the peak's, which cannot overflow
  std::size_t count = 0;
  for (const Sample& sample : samples) {
    const double offset = sample.log_spacing - peak;
    if (offset < -std::log(kBodyLow) || offset > std::log(kBodyHigh)) continue;
    volume += std::exp(3 * offset);
    dimension += sample.dimension;
    ++count;
  }
  const double spacing = std::exp(peak) * std::cbrt(volume / static_cast<double>(count));
  dimension /= static_cast<double>(count);
  const char* shape = dimension < 1.5 ? "a thread" : dimension < 2.5 ? "a thin sheet" : "a body";
  return {
      static_cast<float>(spacing), static_cast<float>(dimension),
      fmt::format("{:.4g} m, from the room that particles have among their nearest ({} of water; {} of {} looked at)",
                  spacing, shape, count, samples.size())};
}

/// When no surroundings could be told, as with many particles in each of few places: all particles as one body.
SpacingEstimate from_all(const Particles& particles) {
  const Bounds bounds = particles.bounds();
  const glm::dvec3 middle = 0.5 * (glm::dvec3(bounds.low) + glm::dvec3(bounds.high));
  const glm::dvec3 extent = glm::dvec3(bounds.high) - glm::dvec3(bounds.low);
  const double unit = std::max({extent.x, extent.y, extent.z});
  if (unit > 0) {
    Moments moments;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      moments.add((glm::dvec3(particles.position(i)) - middle) / unit);
    }
    const Surroundings s = surroundings_of(moments);
    if (s.spacing > 0) {
      return {static_cast<float>(s.spacing * unit), static_cast<float>(s.dimension),
              fmt::format("{:.4g} m, from the volume of all particles together", s.spacing * unit)};
    }
  }
  const double farthest = std::max(glm::length(glm::dvec3(bounds.low)), glm::length(glm::dvec3(bounds.high)));
  const float spacing = std::max(kNothingKnown, static_cast<float>(1e-4 * farthest));
  return {spacing, 3.0f,
          fmt::format("{:.4g} m taken, as {}", spacing,
                      particles.size() == 1 ? "one particle tells none" : "all particles lie in one point")};
}

}  // namespace

SpacingEstimate estimate_spacing(const Particles& particles) {
  if (particles.empty()) return {0.0f, 3.0f, "no particles"};
  const NearestIndex index(particles, robust_bounds(particles), kIndexed);
  const std::vector<Sample> samples = samples_of(index);
  SpacingEstimate estimate = samples.empty() ? from_all(particles) : from_samples(samples);

  // The file knows better, unless it means something else by the word.
  const float told = particles.spacing.value_or(0.0f);
  if (!(told > 0) || !std::isfinite(told)) return estimate;
  const bool known = !samples.empty() || estimate.reasoning.find("taken") == std::string::npos;
  if (!known || (told <= kToldFactor * estimate.spacing && estimate.spacing <= kToldFactor * told)) {
    return {told, estimate.dimension, fmt::format("{:.4g} m, from the file", told)};
  }
  estimate.reasoning += fmt::format("; the file's {:.4g} m does not fit", told);
  return estimate;
}

}  // namespace meniscus
