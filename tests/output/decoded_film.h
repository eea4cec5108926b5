#pragma once

#include <string>
#include <vector>

#include "meniscus/image.h"

namespace meniscus {

/// What a player sees of a film.
struct DecodedFilm {
  std::string codec, pixel_format, container;
  std::string matrix, primaries, transfer, range;
  int width = 0, height = 0;
  int rate_numerator = 0, rate_denominator = 0;
  double seconds = 0;
  std::vector<double> times;        ///< of the frames, s
  std::vector<Image<Rgb8>> frames;  ///< back to full-range RGB by BT.709
};

/// Decodes all of it; throws std::runtime_error where FFmpeg refuses.
DecodedFilm decoded_film(const std::string& path);

}  // namespace meniscus
