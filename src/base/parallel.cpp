#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <algorithm>
#include <atomic>

#include "meniscus/base.h"

// Debian's oneTBB is not compiled for the thread sanitizer, which then reports races inside of it. There, plain
// threads take the pieces, and what is reported is ours.
#if defined(__SANITIZE_THREAD__)
#define MENISCUS_PLAIN_THREADS 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define MENISCUS_PLAIN_THREADS 1
#endif
#endif
#ifdef MENISCUS_PLAIN_THREADS
#include <exception>
#include <mutex>
#include <thread>
#endif

namespace meniscus {
namespace {

/// Threads asked for by the innermost ThreadLimit; 0: all cores.
std::atomic<int> requested_threads{0};

/// Threads that may run now. Of nested limits, those of other libraries included, the least one holds; an arena for
/// more would make oneTBB complain.
int allowed_threads() {
  const int requested = requested_threads.load();
  if (requested <= 0) return tbb::info::default_concurrency();
  const std::size_t most = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return static_cast<int>(std::min(static_cast<std::size_t>(requested), most));
}

struct Limit {
  tbb::global_control control;
  int outer;
};

}  // namespace

void parallel_for(std::size_t count, std::size_t grain, FunctionRef<void(std::size_t, std::size_t)> body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t pieces = (count + grain - 1) / grain;
  const auto run = [&](std::size_t piece) { body(piece * grain, std::min(count, (piece + 1) * grain)); };
  if (pieces == 1) {
    run(0);
    return;
  }
#ifdef MENISCUS_PLAIN_THREADS
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    for (std::size_t piece = next++; piece < pieces; piece = next++) try {
        run(piece);
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
      }
  };
  {
    std::vector<std::jthread> helpers;
    for (int i = 1; i < thread_count(); ++i) helpers.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
#else
  const int threads = allowed_threads();
  if (threads > tbb::info::default_concurrency()) {
    // The default arena has one slot a core; more threads than cores need an arena of their own.
    tbb::task_arena(threads).execute([&] { tbb::parallel_for(std::size_t{0}, pieces, run); });
    return;
  }
  tbb::parallel_for(std::size_t{0}, pieces, run);
#endif
}

ThreadLimit::ThreadLimit(int count) : control_(nullptr) {
  if (count <= 0) return;
  control_ = new Limit{{tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)},
                       requested_threads.exchange(count)};
}

ThreadLimit::~ThreadLimit() {
  if (!control_) return;
  auto* limit = static_cast<Limit*>(control_);
  requested_threads.store(limit->outer);
  delete limit;
}

int thread_count() { return allowed_threads(); }

}  // namespace meniscus
