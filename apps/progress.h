/// How far a sequence has come, on stderr: a bar with the time left on a terminal, one line a picture when piped.
#pragma once

#include <chrono>
#include <string>

#include "meniscus/render.h"

namespace meniscus::apps {

class Progress {
 public:
  explicit Progress(bool quiet);
  /// Another frame has been looked at by the survey.
  void surveyed(std::size_t done, std::size_t count);
  /// Another picture is done, or could not be drawn. Problems are told even when quiet.
  void drawn(const FrameReport& frame, std::size_t index, std::size_t count);
  /// Leaves the bar's line.
  void finish();

 private:
  void tell(const std::string& line);
  void bar(std::size_t done, std::size_t count, const std::string& words);

  bool quiet_;
  bool terminal_;
  bool bar_is_shown_ = false;
  std::chrono::steady_clock::time_point start_;
  std::size_t drawn_ = 0;  ///< pictures that took time: the skipped ones tell nothing of the time left
};

/// Seconds as "0:07", "12:34" or "1:02:03".
std::string clock_text(double seconds);

/// The table at the end of a run: a row a stage with its sum, its mean and its share.
std::string timing_table(const SequenceReport& report);

}  // namespace meniscus::apps
