#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>

namespace meniscus::apps {

std::string clock_text(double seconds) {
  const auto whole = static_cast<long long>(std::lround(std::max(seconds, 0.0)));
  const long long h = whole / 3600, m = whole / 60 % 60, s = whole % 60;
  return h > 0 ? fmt::format("{}:{:02}:{:02}", h, m, s) : fmt::format("{}:{:02}", m, s);
}

Progress::Progress(bool quiet)
    : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1), start_(std::chrono::steady_clock::now()) {}

void Progress::surveyed(std::size_t done, std::size_t count) {
  if (count < 2) return;
  if (terminal_ && !quiet_) bar(done, count, "looking through the frames");
  if (done == count) start_ = std::chrono::steady_clock::now();
}

void Progress::drawn(const FrameReport& frame, std::size_t index, std::size_t count) {
  const std::string name = std::filesystem::path(frame.path).filename().string();
  if (!frame.problem.empty()) tell("meniscus: left out: " + frame.problem);
  if (!frame.skipped) ++drawn_;
  if (quiet_) return;
  for (const std::string& note : frame.notes) tell(fmt::format("meniscus: {}: {}", frame.path, note));
  const std::size_t done = index + 1;
  if (terminal_) {
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double left = drawn_ > 0 ? spent / static_cast<double>(drawn_) * static_cast<double>(count - done) : 0;
    bar(done, count, fmt::format("{}  {} left", name, clock_text(left)));
    return;
  }
  if (frame.skipped)
    tell(fmt::format("{}/{} {} is there already", done, count, frame.output));
  else if (frame.problem.empty())
    tell(fmt::format("{}/{} {} -> {} ({} particles, {:.2f} s)", done, count, name, frame.output, frame.particles,
                     frame.frame_ms / 1000));
}

void Progress::finish() {
  if (bar_is_shown_) std::cerr << '\n';
  bar_is_shown_ = false;
}

void Progress::tell(const std::string& line) {
  if (bar_is_shown_) std::cerr << "\r\x1b[K";
  bar_is_shown_ = false;
  std::cerr << line << std::endl;
}

void Progress::bar(std::size_t done, std::size_t count, const std::string& words) {
  constexpr std::size_t kWidth = 30;
  const std::size_t full = kWidth * done / count;
  std::cerr << fmt::format("\r\x1b[K[{}{}] {}/{}  {}", std::string(full, '#'), std::string(kWidth - full, '.'), done,
                           count, words)
            << std::flush;
  bar_is_shown_ = true;
}

std::string timing_table(const SequenceReport& report) {
  std::string table = fmt::format("{:<14}{:>12}{:>14}{:>9}\n", "stage", "sum, ms", "a frame, ms", "share");
  const double total = report.times.total_ms();
  const double frames = static_cast<double>(std::max<std::size_t>(report.drawn, 1));
  const auto row = [&](std::string_view stage, double ms) {
    table +=
        fmt::format("{:<14}{:>12.1f}{:>14.1f}{:>8.1f}%\n", stage, ms, ms / frames, total > 0 ? 100 * ms / total : 0);
  };
  for (const auto& [stage, ms] : report.times.rows()) row(stage, ms);
  row("all stages", total);
  return table;
}

}  // namespace meniscus::apps
