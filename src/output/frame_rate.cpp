#include "output/frame_rate.h"

#include <fmt/format.h>
#include <cmath>

#include "meniscus/base.h"

namespace meniscus {

FrameRate frame_rate(double frames_per_second) {
  if (!(frames_per_second >= 0.01 && frames_per_second <= 1000))
    throw Error(ErrorCode::invalid_argument,
                fmt::format("a film of {} frames per second cannot be made; give 0.01 to 1000", frames_per_second));
  for (const int whole : {24, 30, 48, 60, 120}) {
    const double television = whole * 1000.0 / 1001.0;
    if (std::abs(frames_per_second - television) < 2e-4) return {whole * 1000, 1001};
  }
  // Convergents of the continued fraction, until one is as good as a double can say.
  double rest = frames_per_second;
  long p = 1, q = 0, p_before = 0, q_before = 1;
  for (;;) {
    const double whole = std::floor(rest);
    const double next_p = whole * static_cast<double>(p) + static_cast<double>(p_before);
    const double next_q = whole * static_cast<double>(q) + static_cast<double>(q_before);
    if (next_p > 1e6 || next_q > 1e6) break;
    p_before = std::exchange(p, static_cast<long>(next_p));
    q_before = std::exchange(q, static_cast<long>(next_q));
    if (std::abs(static_cast<double>(p) / static_cast<double>(q) - frames_per_second) <= 1e-12 * frames_per_second)
      break;
    rest = 1 / (rest - whole);
  }
  return {static_cast<int>(p), static_cast<int>(q)};
}

}  // namespace meniscus
