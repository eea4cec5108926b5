#include <algorithm>
#include <vector>

#include "meniscus/particles.h"
#include "particles/core.h"

namespace meniscus {
namespace {

constexpr double kTail = 0.003;
constexpr std::size_t kSample = std::size_t{1} << 18;

/// Times the core's longest edge: how far beyond the core particles still belong to the picture. A compact body ends
/// within a hundredth of it, splashes within a half.
constexpr float kMargin = 0.5f;

std::pair<float, float> core_of(const std::vector<float>& values) {
  const std::size_t step = (values.size() + kSample - 1) / kSample;
  std::vector<float> sample;
  sample.reserve(values.size() / step + 1);
  for (std::size_t i = 0; i < values.size(); i += step) sample.push_back(values[i]);
  const auto tail = static_cast<std::ptrdiff_t>(kTail * static_cast<double>(sample.size()));
  const auto low = sample.begin() + tail;
  const auto high = sample.end() - 1 - tail;
  std::nth_element(sample.begin(), low, sample.end());
  const float low_value = *low;
  std::nth_element(low, high, sample.end());
  return {low_value, *high};
}

}  // namespace

Bounds core_bounds(const Particles& particles) {
  if (particles.empty()) return {};
  const auto [x0, x1] = core_of(particles.x);
  const auto [y0, y1] = core_of(particles.y);
  const auto [z0, z1] = core_of(particles.z);
  return {{x0, y0, z0}, {x1, y1, z1}};
}

Bounds robust_bounds(const Particles& particles) {
  if (particles.empty()) return {};
  const Bounds core = core_bounds(particles);
  const vec3 extent = core.extent();
  const float longest = std::max({extent.x, extent.y, extent.z});

  // A core without extent: nearly all particles in one point. Then nothing says what is far.
  if (!(longest > 0)) return particles.bounds();
  const Bounds near = core.grown(kMargin * longest);
  Bounds bounds;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const vec3 p = particles.position(i);
    const bool inside = p.x >= near.low.x && p.y >= near.low.y && p.z >= near.low.z && p.x <= near.high.x &&
                        p.y <= near.high.y && p.z <= near.high.z;
    if (inside) bounds.add(p);
  }
  return bounds.empty() ? particles.bounds() : bounds;
}

}  // namespace meniscus
