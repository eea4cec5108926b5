#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <algorithm>

#include "meniscus/base.h"

namespace meniscus {

void parallel_for(std::size_t count, std::size_t grain, FunctionRef<void(std::size_t, std::size_t)> body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t pieces = (count + grain - 1) / grain;
  const auto run = [&](std::size_t piece) { body(piece * grain, std::min(count, (piece + 1) * grain)); };
  if (pieces == 1) {
    run(0);
    return;
  }
  tbb::parallel_for(std::size_t{0}, pieces, run);
}

ThreadLimit::ThreadLimit(int count)
    : control_(count > 0 ? new tbb::global_control(tbb::global_control::max_allowed_parallelism,
                                                   static_cast<std::size_t>(count))
                         : nullptr) {}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(control_); }

int thread_count() {
  const auto allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return static_cast<int>(std::min<std::size_t>(allowed, static_cast<std::size_t>(tbb::info::default_concurrency())));
}

}  // namespace meniscus
