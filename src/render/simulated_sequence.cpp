#include <fmt/format.h>

#include "meniscus/render.h"

namespace meniscus {

FrameSequence simulated_sequence(const SimulatedWater& water, std::vector<BodyOptions> bodies) {
  const auto scene = std::make_shared<SimulatedScene>(water, std::move(bodies));
  FrameSequence sequence;
  for (std::size_t i = 0; i < scene->frames(); ++i)
    sequence.frames.push_back({fmt::format("simulation {}", i), static_cast<std::int64_t>(i), std::nullopt});
  sequence.source = [scene](const FramePath& frame) {
    return scene->frame(static_cast<std::size_t>(frame.number.value_or(0)));
  };
  sequence.body_transforms = [scene] { return scene->transforms(); };
  sequence.foreseen = scene->foreseen();
  return sequence;
}

}  // namespace meniscus
