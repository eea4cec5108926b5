// What is common to all formats: names, units, which particles are kept.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "io/attributes.h"
#include "io/fluid.h"
#include "io/readable.h"
#include "io/readers.h"
#include "io/text.h"
#include "io/where.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kGrain = 1 << 16;

/// Lengths and velocities in m; positions are so already.
void scale_lengths(double scale, Particles& particles) {
  if (scale == 1) return;
  const auto factor = static_cast<float>(scale);
  if (particles.spacing) *particles.spacing *= factor;
  constexpr std::array<std::string_view, 7> kLengths{"velocity",        "radius",           "radii", "h",
                                                     "smoothinglength", "smoothing_length", "hsml"};
  for (Attribute& attribute : particles.attributes) {
    if (std::find(kLengths.begin(), kLengths.end(), lower(attribute.name)) == kLengths.end()) continue;
    parallel_for(attribute.values.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) attribute.values[i] *= factor;
    });
  }
}

/// Which particles are kept, and how many of each piece of kGrain.
struct Kept {
  std::vector<std::uint8_t> marks;  ///< one a particle, 0 or 1; empty: all
  std::vector<std::size_t> before;  ///< kept ones before each piece, and of all
};

/// Keeps of `values`, of `components` a particle, those of the kept particles.
void keep(const Kept& kept, std::size_t components, std::vector<float>& values) {
  std::vector<float> left(kept.before.back() * components);
  parallel_for(kept.marks.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    float* to = left.data() + kept.before[begin / kGrain] * components;
    for (std::size_t i = begin; i < end; ++i) {
      if (kept.marks[i] == 0) continue;
      to = std::copy_n(values.data() + i * components, components, to);
    }
  });
  values = std::move(left);
}

void keep(Kept& kept, Particles& particles) {
  const std::size_t pieces = (kept.marks.size() + kGrain - 1) / kGrain;
  kept.before.assign(pieces + 1, 0);
  parallel_for(kept.marks.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) count += kept.marks[i];
    kept.before[begin / kGrain + 1] = count;
  });
  for (std::size_t piece = 0; piece < pieces; ++piece) kept.before[piece + 1] += kept.before[piece];
  if (kept.before.back() == kept.marks.size()) return;
  keep(kept, 1, particles.x);
  keep(kept, 1, particles.y);
  keep(kept, 1, particles.z);
  for (Attribute& attribute : particles.attributes)
    keep(kept, static_cast<std::size_t>(attribute.components), attribute.values);
}

/// Unmarks particles whose positions are not finite; how many there are.
std::size_t unmark_non_finite(const Particles& particles, std::vector<std::uint8_t>& marks) {
  // Which of them is asked only where set_positions() has met one.
  if (particles.dropped_non_finite == 0) return 0;
  const auto finite = [&](std::size_t i) {
    return std::isfinite(particles.x[i]) && std::isfinite(particles.y[i]) && std::isfinite(particles.z[i]);
  };
  std::atomic<std::size_t> count{0};
  parallel_for(particles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::size_t piece = 0;
    for (std::size_t i = begin; i < end; ++i) piece += finite(i) ? 0 : 1;
    count += piece;
  });
  if (marks.empty()) marks.assign(particles.size(), 1);
  parallel_for(particles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) marks[i] = marks[i] != 0 && finite(i) ? 1 : 0;
  });
  return count;
}

/// Marks the particles that are asked for, or the fluid; empty: all of them.
std::vector<std::uint8_t> marked(const ReadOptions& options, Particles& particles) {
  const std::size_t count = particles.size();
  const auto left_out = [](const std::vector<std::uint8_t>& marks) {
    return std::count(marks.begin(), marks.end(), 0);
  };
  if (!options.where.empty()) {
    const Condition condition(options.where);
    std::vector<std::uint8_t> marks(count);
    if (count > 0) condition.judge(particles, marks);
    particles.notes.push_back(
        fmt::format("{} of {} particles were left out: not {}", left_out(marks), count, options.where));
    return marks;
  }
  if (options.boundaries) return {};
  bool boundaries_only = false;
  std::optional<FluidChoice> choice = choose_fluid(particles, boundaries_only);
  if (boundaries_only) particles.notes.push_back("all particles are boundaries, not fluid; they are kept");
  if (!choice) return {};
  particles.notes.push_back(fmt::format("{} of {} particles were left out: {}; --boundaries keeps them",
                                        left_out(choice->is_fluid), count, choice->reason));
  return std::move(choice->is_fluid);
}

}  // namespace

void finish(const ReadOptions& options, Particles& particles) {
  for (Attribute& attribute : particles.attributes) make_readable(attribute.name);
  for (std::string& note : particles.notes) make_readable(note);
  if (particles.time && !std::isfinite(*particles.time)) particles.time.reset();
  unify_names(particles.attributes);
  scale_lengths(options.scale, particles);
  Kept kept{marked(options, particles), {}};
  const std::size_t lost = unmark_non_finite(particles, kept.marks);
  particles.dropped_non_finite = lost;
  if (lost > 0) {
    particles.notes.push_back(
        fmt::format("{} of {} particles were left out: their positions are not finite", lost, particles.size()));
  }
  if (!kept.marks.empty()) keep(kept, particles);
}

}  // namespace meniscus::io
