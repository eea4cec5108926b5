#include "image/short_number.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace meniscus {
namespace {

void remove_trailing_zeros(std::string& number) {
  if (number.find('.') == std::string::npos) return;
  while (number.back() == '0') number.pop_back();
  if (number.back() == '.') number.pop_back();
}

}  // namespace

std::string short_number(double value, int digits) {
  if (!std::isfinite(value)) return std::isnan(value) ? "nan" : (value > 0 ? "inf" : "-inf");
  if (value == 0) return "0";
  // Round first, "d.dde+xx": the exponent of 9.996 is that of 10.0.
  const std::string scientific = fmt::format("{:.{}e}", value, digits - 1);
  const std::size_t e = scientific.find('e');
  const int exponent = std::stoi(scientific.substr(e + 1));
  if (exponent < -3 || exponent > 4) {
    std::string mantissa = scientific.substr(0, e);
    remove_trailing_zeros(mantissa);
    return fmt::format("{}e{}", mantissa, exponent);
  }
  std::string number = fmt::format("{:.{}f}", std::stod(scientific), std::max(0, digits - 1 - exponent));
  remove_trailing_zeros(number);
  return number;
}

}  // namespace meniscus
