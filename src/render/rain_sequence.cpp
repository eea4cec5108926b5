#include <fmt/format.h>

#include <algorithm>

#include "base/field_axes.h"
#include "meniscus/render.h"

namespace meniscus {
namespace {

constexpr float kRoom = 2;        ///< m above the ground that belong to the scene
constexpr float kColumn = 0.02f;  ///< m: puddles are known as closely as this

}  // namespace

FrameSequence rain_sequence(const RainSettings& settings, Axis up) {
  if (settings.frames < 1) throw Error(ErrorCode::invalid_argument, "rain needs one frame at least");
  if (!(settings.frames_per_second > 0))
    throw Error(ErrorCode::invalid_argument, "rain needs a number of frames a second above 0");
  FrameSequence sequence;
  for (std::size_t i = 0; i < settings.frames; ++i)
    sequence.frames.push_back({fmt::format("rain {}", i), static_cast<std::int64_t>(i), std::nullopt});
  sequence.source = [up, per_second = settings.frames_per_second](const FramePath& frame) {
    Particles none;
    none.format = "rain";
    none.up = up;
    none.time = static_cast<double>(frame.number.value_or(0)) / per_second;
    return none;
  };
  const FieldAxes axes(up);
  const bool on_cells = settings.ground.there && settings.ground.cells.low != settings.ground.cells.high;
  const vec2 low = on_cells ? settings.ground.cells.low : settings.rain.low;
  const vec2 high = on_cells ? settings.ground.cells.high : settings.rain.high;
  Foreseen foreseen;
  if (low != high) {
    foreseen.bounds.add(axes.place(low.x, low.y, settings.ground.cells.level));
    foreseen.bounds.add(axes.place(high.x, high.y, settings.ground.cells.level + kRoom));
  }
  foreseen.spacing = kColumn;
  foreseen.up = up;
  foreseen.reasoning = "of the rain's ground";
  sequence.foreseen = std::move(foreseen);
  return sequence;
}

}  // namespace meniscus
