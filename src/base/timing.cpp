#include <sys/resource.h>
#include <chrono>

#include "meniscus/base.h"

namespace meniscus {
namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

void StageTimes::add(std::string_view stage, double ms) {
  for (auto& [name, sum] : rows_)
    if (name == stage) {
      sum += ms;
      return;
    }
  rows_.emplace_back(stage, ms);
}

void StageTimes::add(const StageTimes& other) {
  for (const auto& [name, ms] : other.rows_) add(name, ms);
}

double StageTimes::total_ms() const {
  double sum = 0;
  for (const auto& row : rows_) sum += row.second;
  return sum;
}

StageTimer::StageTimer(StageTimes* times, std::string_view stage)
    : times_(times), stage_(stage), start_ns_(times ? now_ns() : 0) {}

StageTimer::~StageTimer() {
  if (times_) times_->add(stage_, static_cast<double>(now_ns() - start_ns_) * 1e-6);
}

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024u;  // Linux counts in KiB
}

}  // namespace meniscus
