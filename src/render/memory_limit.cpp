#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "meniscus/render.h"
#include "render/frame_memory.h"

namespace meniscus {
namespace {

constexpr std::uint64_t kStack = std::uint64_t{8} << 20;       ///< of a thread that may come, hardly any of it touched
constexpr std::uint64_t kUntouched = std::uint64_t{16} << 20;  ///< counted as data, but never touched

/// Bytes that the system counts as this process's own data, touched or not; 0: not known.
std::uint64_t data_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmData:")) return std::stoull(line.substr(7)) * 1024;
  return 0;
}

}  // namespace

void hold_memory_below(std::uint64_t bytes) {
  const std::uint64_t resident = resident_bytes(), data = data_bytes();
  if (bytes == 0 || data == 0) return;
  // Large arrays are given back at once, instead of being kept for later ones.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 4 << 20);
  const std::uint64_t stacks = kStack * static_cast<std::uint64_t>(std::max(thread_count() - 1, 0));
  const std::uint64_t left = bytes > resident ? bytes - resident : 0;
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, data + stacks + kUntouched + left);
  static_cast<void>(setrlimit(RLIMIT_DATA, &limit));
}

}  // namespace meniscus
