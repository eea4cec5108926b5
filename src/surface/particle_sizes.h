/// Spacings and smoothing lengths of single particles, checked and resolved.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// Largest ratio of the largest to the smallest of the particles' spacings, or smoothing lengths.
constexpr float kLargestSizeRatio = 64.0f;

struct ResolvedSizes {
  /// The given options with the lengths of the largest particle: its spacing, smoothing length, and normal radius.
  RaycastOptions options;
  /// m, by given index; both are empty where all particles are alike (to a ten-thousandth).
  std::vector<float> spacing, smoothing_length;

  bool empty() const { return spacing.empty(); }
};

/// @param options  as given by the caller: unresolved, and unchecked if sizes is empty
/// @throws Error   invalid_argument: sizes of another number than the particles, not positive and finite, a smoothing
///                 length of less than 1 or more than 20 of its particle's spacings; limit_exceeded: a ratio of more
///                 than kLargestSizeRatio
ResolvedSizes resolve_sizes(const ParticleSizes& sizes, const RaycastOptions& options, std::size_t count);

/// The options with the lengths of one particle; those that were 0 stay so.
RaycastOptions options_of_size(const RaycastOptions& options, float spacing, float smoothing_length);

/// Mass rules by size: a rule depends on smoothing_length / spacing alone, so that those of equal ratio share one.
class SizedMassRules {
 public:
  explicit SizedMassRules(const RaycastOptions& options) : options_(options) {}
  const MassRule& rule(float spacing, float smoothing_length);

 private:
  RaycastOptions options_;
  float ratio_ = 0;
  MassRule rule_;
};

}  // namespace meniscus
