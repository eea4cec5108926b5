#pragma once

namespace meniscus {

/// Frames per second as a fraction of whole numbers.
struct FrameRate {
  int numerator;
  int denominator;
};

/// The simplest fraction that is the given number to within its digits: 25, 25/2, 1/3. The television rates
/// n 1000/1001 may be given by their usual decimals: 23.976, 29.97, 59.94.
/// @throws Error invalid_argument: not in [0.01, 1000]
FrameRate frame_rate(double frames_per_second);

}  // namespace meniscus
