/// Reads the next frame of a sequence while the one before it is drawn.
#pragma once

#include <future>

#include "meniscus/io.h"

namespace meniscus {

/// Holds at most one frame that nobody has taken yet, so that with the one being drawn there are two in memory.
class ReadAhead {
 public:
  /// @param sequence  must outlive this. Frames that come out of a source are made when they are taken
  explicit ReadAhead(const FrameSequence& sequence) : sequence_(sequence) {}
  ~ReadAhead();
  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// Begins to read a frame. Does nothing where one thread is all that there may be.
  void begin(const FramePath& frame);
  /// The particles of a frame: those that were begun, or read now.
  /// @throws Error  as read_frame()
  std::shared_ptr<const Particles> take(const FramePath& frame);

 private:
  const FrameSequence& sequence_;
  FramePath frame_;  ///< that was begun
  std::future<std::shared_ptr<const Particles>> begun_;
};

}  // namespace meniscus
