#include <algorithm>
#include <array>
#include <cstddef>

#include "meniscus/sim.h"

namespace meniscus {
namespace {

/// Diameter, mm, and terminal velocity, m/s, of water drops in still air at 1013 hPa, 20 degrees C. [GunnKinzer1949]
/// tab. 2
constexpr std::array<std::array<float, 2>, 34> kMeasured{{
    {0.1f, 0.27f}, {0.2f, 0.72f}, {0.3f, 1.17f}, {0.4f, 1.62f}, {0.5f, 2.06f}, {0.6f, 2.47f}, {0.7f, 2.87f},
    {0.8f, 3.27f}, {0.9f, 3.67f}, {1.0f, 4.03f}, {1.2f, 4.64f}, {1.4f, 5.17f}, {1.6f, 5.65f}, {1.8f, 6.09f},
    {2.0f, 6.49f}, {2.2f, 6.90f}, {2.4f, 7.27f}, {2.6f, 7.57f}, {2.8f, 7.82f}, {3.0f, 8.06f}, {3.2f, 8.26f},
    {3.4f, 8.44f}, {3.6f, 8.60f}, {3.8f, 8.72f}, {4.0f, 8.83f}, {4.2f, 8.92f}, {4.4f, 8.98f}, {4.6f, 9.03f},
    {4.8f, 9.07f}, {5.0f, 9.09f}, {5.2f, 9.12f}, {5.4f, 9.14f}, {5.6f, 9.16f}, {5.8f, 9.17f},
}};

}  // namespace

float fall_speed(float diameter) {
  const float mm = 1000.0f * diameter;
  if (!(mm > 0)) return 0;
  // Smaller drops fall as Stokes has it, with the square of the diameter; larger ones break up before they fall faster.
  const auto& least = kMeasured.front();
  if (mm <= least[0]) return least[1] * (mm / least[0]) * (mm / least[0]);
  if (mm >= kMeasured.back()[0]) return kMeasured.back()[1];
  // Steps of 0.1 mm up to 1 mm, then of 0.2 mm.
  const float row = mm < 1 ? 10 * mm - 1 : 5 * mm + 4;
  const std::size_t i = std::min(static_cast<std::size_t>(row), kMeasured.size() - 2);
  const auto &below = kMeasured[i], &above = kMeasured[i + 1];
  const float t = std::clamp((mm - below[0]) / (above[0] - below[0]), 0.0f, 1.0f);
  return below[1] + t * (above[1] - below[1]);
}

}  // namespace meniscus
