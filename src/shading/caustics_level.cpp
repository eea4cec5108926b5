#include "shading/caustics_level.h"

#include <algorithm>
#include <cmath>

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Points this many steps beside the field, such as those of the walls around it, are looked up at its border.
constexpr float kBeside = 1.0f;
constexpr float kRounding = 0.01f;

}  // namespace

FieldFrame::FieldFrame(const HeightField& field)
    : a(field.up == Axis::x ? 1 : 0),
      b(field.up == Axis::z ? 1 : 2),
      up(field.up == Axis::x   ? 0
         : field.up == Axis::y ? 1
                               : 2),
      low(field.low),
      step(field.step),
      width(field.height.width()),
      height(field.height.height()) {}

float FieldFrame::longer_side() const {
  const vec2 extent = high() - low;
  return std::max(extent.x, extent.y);
}

WaterLevel::WaterLevel(const HeightField& field) : frame_(field), height_(field.height) {
  double sum = 0;
  std::size_t count = 0;
  for (const float h : height_) {
    if (!(h > -kInfinity)) {
      closed_ = false;
      continue;
    }
    sum += static_cast<double>(h);
    ++count;
    lowest_ = std::min(lowest_, h);
    highest_ = std::max(highest_, h);
  }
  if (count > 0) mean_ = static_cast<float>(sum / static_cast<double>(count));
}

float WaterLevel::depth(vec3 point) const {
  const float level = point[frame_.up];
  if (level > highest_) return highest_ - level;
  vec2 at = (frame_.across(point) - frame_.low) / frame_.step;
  const vec2 last{static_cast<float>(frame_.width - 1), static_cast<float>(frame_.height - 1)};
  if (!(at.x >= -kBeside && at.y >= -kBeside && at.x <= last.x + kBeside && at.y <= last.y + kBeside))
    return mean_ - level;
  at = {std::clamp(at.x, 0.0f, last.x), std::clamp(at.y, 0.0f, last.y)};
  if (closed_) return between(height_, at.x, at.y) - level;
  // At the rim of a hole the water goes on as high as it is beside it.
  const int i = std::min(static_cast<int>(at.x), frame_.width - 2),
            j = std::min(static_cast<int>(at.y), frame_.height - 2);
  const float s = at.x - static_cast<float>(i), t = at.y - static_cast<float>(j);
  float sum = 0, weight = 0;
  for (int n = 0; n < 4; ++n) {
    const float h = height_(i + (n & 1), j + (n >> 1));
    const float w = ((n & 1) ? s : 1.0f - s) * ((n >> 1) ? t : 1.0f - t);
    if (!(h > -kInfinity)) continue;
    sum += w * h;
    weight += w;
  }
  return weight > 1e-6f ? sum / weight - level : -kInfinity;
}

float WaterLevel::cover(vec2 place) const {
  vec2 at = (place - frame_.low) / frame_.step;
  const vec2 last{static_cast<float>(frame_.width - 1), static_cast<float>(frame_.height - 1)};
  // Walls stand on the border to rounding.
  if (!(at.x >= -kRounding && at.y >= -kRounding && at.x <= last.x + kRounding && at.y <= last.y + kRounding)) return 0;
  at = {std::clamp(at.x, 0.0f, last.x), std::clamp(at.y, 0.0f, last.y)};
  if (closed_) return 1;
  const int i = std::min(static_cast<int>(at.x), frame_.width - 2),
            j = std::min(static_cast<int>(at.y), frame_.height - 2);
  const float s = at.x - static_cast<float>(i), t = at.y - static_cast<float>(j);
  const auto wet = [&](int x, int y) { return height_(x, y) > -kInfinity ? 1.0f : 0.0f; };
  return (1.0f - t) * ((1.0f - s) * wet(i, j) + s * wet(i + 1, j)) +
         t * ((1.0f - s) * wet(i, j + 1) + s * wet(i + 1, j + 1));
}

}  // namespace meniscus
