#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "image/ssim.h"
#include "meniscus/image.h"

namespace meniscus {

ImageDifference compare(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  if (a.width() != b.width() || a.height() != b.height())
    throw Error(ErrorCode::invalid_argument,
                ErrorDetail{.problem = "pictures of different sizes cannot be compared",
                            .expected = fmt::format("{} x {} pixels", a.width(), a.height()),
                            .found = fmt::format("{} x {}", b.width(), b.height()),
                            .path = {},
                            .byte_offset = {},
                            .line = {},
                            .advice = {}});
  ImageDifference difference;
  std::uint64_t squares = 0;  // whole numbers: exact in any order
  int largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const int dr = std::abs(a[i].r - b[i].r), dg = std::abs(a[i].g - b[i].g), db = std::abs(a[i].b - b[i].b);
    squares += static_cast<std::uint64_t>(dr * dr + dg * dg + db * db);
    largest = std::max({largest, dr, dg, db});
    difference.pixels_differing += a[i] != b[i];
  }
  difference.max_difference = largest;
  difference.psnr_db =
      squares == 0 ? std::numeric_limits<double>::infinity()
                   : 10 * std::log10(255.0 * 255.0 * 3 * static_cast<double>(a.size()) / static_cast<double>(squares));
  difference.ssim = mean_ssim(a, b);
  return difference;
}

}  // namespace meniscus
