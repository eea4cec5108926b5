#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/attributes.h"
#include "io/readers.h"

namespace meniscus::io {
namespace {

/// Keeps the rows of `values` (of `components` each) that `kept` lists in ascending order.
void keep(std::vector<float>& values, std::size_t components, const std::vector<std::size_t>& kept) {
  for (std::size_t i = 0; i < kept.size(); ++i) {
    for (std::size_t c = 0; c < components; ++c) values[i * components + c] = values[kept[i] * components + c];
  }
  values.resize(kept.size() * components);
}

void drop_non_finite(Particles& particles) {
  const auto finite = [&](std::size_t i) {
    return std::isfinite(particles.x[i]) && std::isfinite(particles.y[i]) && std::isfinite(particles.z[i]);
  };
  const std::size_t count = particles.size();
  std::size_t finite_count = 0;
  for (std::size_t i = 0; i < count; ++i) finite_count += finite(i) ? 1 : 0;
  if (finite_count == count) return;

  std::vector<std::size_t> kept;
  kept.reserve(finite_count);
  for (std::size_t i = 0; i < count; ++i) {
    if (finite(i)) kept.push_back(i);
  }
  keep(particles.x, 1, kept);
  keep(particles.y, 1, kept);
  keep(particles.z, 1, kept);
  for (Attribute& attribute : particles.attributes) {
    keep(attribute.values, static_cast<std::size_t>(attribute.components), kept);
  }
  particles.dropped_non_finite = count - finite_count;
  particles.notes.push_back(
      fmt::format("{} of {} particles were left out: their positions are not finite", count - finite_count, count));
}

}  // namespace

void finish(const ReadOptions& /*options*/, Particles& particles) {
  unify_names(particles.attributes);
  drop_non_finite(particles);
}

}  // namespace meniscus::io
