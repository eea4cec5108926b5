/// Water as a height field without particles: waves, a picture, or waves on top of a picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "meniscus/render.h"

namespace meniscus {
namespace {

/// Brightness, 0 to 1, as the file has it: a height, not a light.
Image<float> brightness_of(const std::string& path) {
  const Image<Rgb8> picture = read_png(path);
  Image<float> heights(picture.width(), picture.height());
  for (std::size_t i = 0; i < picture.size(); ++i)
    heights[i] = (0.2126f * picture[i].r + 0.7152f * picture[i].g + 0.0722f * picture[i].b) / 255.0f;
  return heights;
}

/// Waves of still water at the region's upper end, put on the heights of `base`.
HeightField on_top(const HeightField& base, HeightField waves, float level) {
  for (int j = 0; j < waves.height.height(); ++j)
    for (int i = 0; i < waves.height.width(); ++i) {
      float& height = waves.height(i, j);
      const vec2 place = base.grid_point(waves.point(static_cast<float>(i), static_cast<float>(j), level));
      const HeightField::Sample below = base.at(place.x, place.y);
      height = below.water() ? below.height + (height - level) : below.height;
    }
  find_normals(waves);
  return waves;
}

float rise_of(const MadeHeights& heights) {
  float rise = 0;
  for (const WaveTrain& wave : heights.waves) rise += wave.amplitude;
  return rise;
}

}  // namespace

std::function<HeightField(double)> made_heights(const MadeHeights& heights, Axis up) {
  if (heights.region.empty()) throw Error(ErrorCode::invalid_argument, "made-up heights need a region");
  WaveFieldOptions options;
  options.waves = heights.waves;
  options.up = up;
  options.region = heights.region;
  options.step = heights.step;
  if (heights.image.empty()) return [options](double time) { return height_field(options, time); };
  const auto base = std::make_shared<const HeightField>(
      height_field(brightness_of(heights.image), up, heights.region, heights.smoothing));
  if (heights.waves.empty()) return [base](double) { return *base; };
  if (!(options.step > 0)) options.step = std::min(base->step.x, base->step.y);
  const float level = heights.region.high[static_cast<int>(up)];
  return [options, base, level](double time) { return on_top(*base, height_field(options, time), level); };
}

FrameSequence heights_sequence(const MadeHeights& heights, Axis up) {
  if (heights.frames < 1) throw Error(ErrorCode::invalid_argument, "made-up heights need one frame at least");
  if (!(heights.frames_per_second > 0))
    throw Error(ErrorCode::invalid_argument, "made-up heights need a number of frames a second above 0");
  FrameSequence sequence;
  for (std::size_t i = 0; i < heights.frames; ++i)
    sequence.frames.push_back({fmt::format("heights {}", i), static_cast<std::int64_t>(i), std::nullopt});
  sequence.source = [up, per_second = heights.frames_per_second](const FramePath& frame) {
    Particles none;
    none.format = "heights";
    none.up = up;
    none.time = static_cast<double>(frame.number.value_or(0)) / per_second;
    return none;
  };
  Foreseen foreseen;
  foreseen.bounds = heights.region;
  foreseen.bounds.high += direction_of(up) * rise_of(heights);
  const vec3 extent = heights.region.extent();
  foreseen.spacing = heights.step > 0 ? heights.step : std::max({extent.x, extent.y, extent.z}) / 256;
  foreseen.up = up;
  foreseen.reasoning = "of the made-up heights";
  sequence.foreseen = std::move(foreseen);
  return sequence;
}

}  // namespace meniscus
