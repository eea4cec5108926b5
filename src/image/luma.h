#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Weights of red, green and blue in BT.709 luma; they add up to 1.
constexpr double kLumaRed = 0.2126;
constexpr double kLumaGreen = 0.7152;
constexpr double kLumaBlue = 0.0722;

}  // namespace meniscus
