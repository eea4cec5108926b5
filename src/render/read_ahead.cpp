#include "render/read_ahead.h"

namespace meniscus {

ReadAhead::~ReadAhead() {
  if (begun_.valid()) begun_.wait();
}

void ReadAhead::begin(const FramePath& frame) {
  if (sequence_.source || thread_count() < 2 || begun_.valid()) return;
  frame_ = frame;
  begun_ = std::async(std::launch::async, [this, frame]() -> std::shared_ptr<const Particles> {
    return std::make_shared<Particles>(read_frame(sequence_, frame));
  });
}

std::shared_ptr<const Particles> ReadAhead::take(const FramePath& frame) {
  if (begun_.valid()) {
    if (frame_.path == frame.path && frame_.further == frame.further) return begun_.get();
    try {
      begun_.get();
    } catch (const Error&) {  // of a frame that nobody asked for
    }
  }
  return std::make_shared<Particles>(read_frame(sequence_, frame));
}

}  // namespace meniscus
