#include <fmt/format.h>

#include "meniscus/render.h"

namespace meniscus {

FrameSequence waves_sequence(const WavesOptions& options) {
  if (options.frames < 1) throw Error(ErrorCode::invalid_argument, "waves need one frame at least");
  if (!(options.frames_per_second > 0))
    throw Error(ErrorCode::invalid_argument, "waves need a number of frames a second above 0");
  FrameSequence sequence;
  for (std::size_t i = 0; i < options.frames; ++i)
    sequence.frames.push_back({fmt::format("waves {}", i), static_cast<std::int64_t>(i), std::nullopt});
  sequence.source = [options](const FramePath& frame) {
    return synthetic_waves(options, static_cast<double>(frame.number.value_or(0)) / options.frames_per_second);
  };
  return sequence;
}

}  // namespace meniscus
