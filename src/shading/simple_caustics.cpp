#include "shading/simple_caustics.h"

#include <algorithm>
#include <cmath>

namespace meniscus {

PlaneMap simple_caustics(const HeightField& field, const WaterLevel& level, const EnteringLight& light,
                         const Image<float>& lit, const CausticsOptions& options) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const FieldFrame& frame = level.frame();
  PlaneMap map{frame.low, frame.step, Image<float>(frame.width, frame.height, 0.0f)};
  if (!level.any()) return map;
  const float range = level.highest() - level.lowest();
  // Rounding is not a wave.
  const bool waves = range > 1e-6f * std::max(frame.longer_side(), std::abs(level.highest()));
  const float scale = waves ? options.simple_a / range : 0.0f;
  const float base = options.simple_c + (waves ? -scale * level.lowest() : 0.5f * options.simple_a);
  std::vector<double> sums(static_cast<std::size_t>(frame.height), 0.0);
  std::vector<int> counts(static_cast<std::size_t>(frame.height), 0);
  parallel_for(static_cast<std::size_t>(frame.height), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      const float* height = field.height.row(static_cast<int>(y));
      const vec3* normal = field.normal.row(static_cast<int>(y));
      float* value = map.value.row(static_cast<int>(y));
      double sum = 0;
      for (int x = 0; x < frame.width; ++x) {
        if (!(height[x] > -kInfinity)) continue;
        const float gradient = std::abs(normal[x][frame.a] + normal[x][frame.b]);
        value[x] = std::max(0.0f, scale * height[x] + options.simple_b * gradient + base);
        sum += static_cast<double>(value[x]);
        ++counts[y];
      }
      sums[y] = sum;
    }
  });
  double sum = 0, count = 0;
  for (std::size_t y = 0; y < sums.size(); ++y) {
    sum += sums[y];
    count += counts[y];
  }
  float factor = light.transmittance;
  if (options.simple_keeps_mean && sum > 0) factor *= static_cast<float>(count / sum);
  for (std::size_t i = 0; i < map.value.size(); ++i) map.value[i] *= lit.empty() ? factor : factor * lit[i];
  return map;
}

}  // namespace meniscus
