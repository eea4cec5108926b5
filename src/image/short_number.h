#pragma once

#include <string>

namespace meniscus {

/// A number as a person would write it into a legend: `digits` significant digits, no zeros at the end,
/// "0.0123", "1.5", "12300" between 0.001 and 100,000, else "1.23e-5".
std::string short_number(double value, int digits = 3);

}  // namespace meniscus
