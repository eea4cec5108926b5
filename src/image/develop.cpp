#include <array>
#include <bit>
#include <cmath>

#include "image/tone.h"

namespace meniscus {
namespace {

constexpr std::size_t kRowsPerPiece = 8;

/// Bayer's 8 x 8 matrix of thresholds [Bayer1973], by interleaving the bits of x ^ y and y from the lowest up:
/// each of 0 .. 63 once, neighbours far apart. Returned as an offset in (-0.5, 0.5), centred.
float dither(int x, int y) {
  int order = 0;
  for (int bit = 0; bit < 3; ++bit) order = order * 4 + (((x ^ y) >> bit & 1) * 2 + (y >> bit & 1));
  return (static_cast<float>(order) + 0.5f) / 64.0f - 0.5f;
}

/// 255 srgb_from_linear(x) between points of a table, for x in [kLow, 1): 128 points to each power of two, between them
/// linear, which is off by less than 255 (1/8) (1/128)^2 0.25 = 5e-4.
class SrgbTable {
 public:
  static constexpr float kLow = 0.00390625f;  ///< 2^-8: beyond the linear part of the curve
  SrgbTable() {
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = 255.0f * srgb_from_linear(place(i));
  }
  float at(float x) const {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(x) - kFirst;
    const std::size_t i = bits >> kShift;
    const float t = static_cast<float>(bits & ((1u << kShift) - 1)) * (1.0f / (1u << kShift));
    return values_[i] + t * (values_[i + 1] - values_[i]);
  }

 private:
  static constexpr int kShift = 23 - 7;
  static constexpr std::uint32_t kFirst = std::bit_cast<std::uint32_t>(kLow);
  static float place(std::size_t i) { return std::bit_cast<float>(kFirst + (static_cast<std::uint32_t>(i) << kShift)); }
  std::array<float, 8 * 128 + 1> values_;
};

/// floor(255 srgb + offset + 1/2), by the table where this cannot round the other way.
std::uint8_t quantised(float display_linear, float offset, const SrgbTable& table) {
  constexpr float kClose = 1e-3f;
  if (display_linear >= SrgbTable::kLow && display_linear < 1.0f) {
    const float value = table.at(display_linear) + offset + 0.5f;
    const float whole = std::trunc(value);
    if (value - whole > kClose && value - whole < 1.0f - kClose) return static_cast<std::uint8_t>(whole);
  }
  return static_cast<std::uint8_t>(std::floor(255.0f * srgb_from_linear(display_linear) + offset + 0.5f));
}

}  // namespace

Image<Rgb8> developed(const Image<vec3>& radiance, const ToneOptions& options) {
  static const SrgbTable table;
  const float factor = std::exp2(options.exposure_ev);
  Image<Rgb8> picture(radiance.width(), radiance.height());
  parallel_for(static_cast<std::size_t>(radiance.height()), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      std::array<float, 8> offsets;
      for (int x = 0; x < 8; ++x) offsets[static_cast<std::size_t>(x)] = dither(x, y);
      for (int x = 0; x < radiance.width(); ++x) {
        const vec3 c = tone_mapped(radiance(x, y), factor, options.curve);
        const float offset =
            offsets[static_cast<std::size_t>(x % 8)];  // the same for all channels, so that grey stays grey
        picture(x, y) = {quantised(c.x, offset, table), quantised(c.y, offset, table), quantised(c.z, offset, table)};
      }
    }
  });
  return picture;
}

}  // namespace meniscus
