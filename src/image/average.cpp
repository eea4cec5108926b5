#include <fmt/format.h>
#include <algorithm>

#include "image/luma.h"
#include "meniscus/image.h"

namespace meniscus {
namespace {

constexpr std::size_t kRowsPerPiece = 8;

double usable(float value) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  return value == value ? static_cast<double>(std::clamp(value, -kLargest, kLargest)) : 0.0;
}

/// The sums of one pixel; in double, so that equal samples give exactly their value back.
class WeightedMean {
 public:
  void add(vec3 sample) {
    const double r = usable(sample.x), g = usable(sample.y), b = usable(sample.z);
    const double weight = 1.0 / (1.0 + std::max(0.0, kLumaRed * r + kLumaGreen * g + kLumaBlue * b));
    red_ += weight * r;
    green_ += weight * g;
    blue_ += weight * b;
    weight_ += weight;
  }
  vec3 value() const {
    if (weight_ <= 0) return vec3{0.0f};
    return {static_cast<float>(red_ / weight_), static_cast<float>(green_ / weight_),
            static_cast<float>(blue_ / weight_)};
  }

 private:
  double red_ = 0, green_ = 0, blue_ = 0, weight_ = 0;
};

}  // namespace

vec3 averaged(std::span<const vec3> samples) {
  WeightedMean mean;
  for (const vec3 sample : samples) mean.add(sample);
  return mean.value();
}

Image<vec3> downsampled(const Image<vec3>& radiance, int factor) {
  if (factor < 1 || radiance.width() % factor != 0 || radiance.height() % factor != 0)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("a picture of {} x {} pixels cannot be reduced by a factor of {}", radiance.width(),
                            radiance.height(), factor));
  Image<vec3> small(radiance.width() / factor, radiance.height() / factor);
  parallel_for(static_cast<std::size_t>(small.height()), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < small.width(); ++x) {
        WeightedMean mean;
        for (int row = 0; row < factor; ++row)
          for (int column = 0; column < factor; ++column) mean.add(radiance(x * factor + column, y * factor + row));
        small(x, y) = mean.value();
      }
  });
  return small;
}

}  // namespace meniscus
