#include <cmath>

#include "meniscus/image.h"

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

std::uint8_t quantised(float display_linear, float offset) {
  return static_cast<std::uint8_t>(std::floor(255.0f * srgb_from_linear(display_linear) + offset + 0.5f));
}

}  // namespace

Image<Rgb8> developed(const Image<vec3>& radiance, const ToneOptions& options) {
  Image<Rgb8> picture(radiance.width(), radiance.height());
  parallel_for(static_cast<std::size_t>(radiance.height()), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < radiance.width(); ++x) {
        const vec3 c = tone_mapped(radiance(x, y), options);
        const float offset = dither(x, y);  // the same for all channels, so that grey stays grey
        picture(x, y) = {quantised(c.x, offset), quantised(c.y, offset), quantised(c.z, offset)};
      }
  });
  return picture;
}

}  // namespace meniscus
