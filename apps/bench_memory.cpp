#include "bench_memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>

namespace meniscus::apps {
namespace {

constexpr std::uint64_t kUnknown = std::numeric_limits<std::uint64_t>::max();

/// Bytes after a word of a file that tells them in KiB.
std::uint64_t bytes_of(const char* path, std::string_view name) {
  std::ifstream file(path);
  std::uint64_t kib = 0;
  for (std::string word; file >> word;)
    if (word == name && file >> kib) return 1024 * kib;
  return kUnknown;
}

}  // namespace

std::uint64_t available_bytes() {
  const std::uint64_t free = bytes_of("/proc/meminfo", "MemAvailable:");
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return free;
  const std::uint64_t used = bytes_of("/proc/self/status", "VmSize:");
  return used == kUnknown
             ? std::min<std::uint64_t>(free, limit.rlim_cur)
             : std::min<std::uint64_t>(free, limit.rlim_cur - std::min<std::uint64_t>(used, limit.rlim_cur));
}

void forget_peak() { std::ofstream("/proc/self/clear_refs") << '5'; }

}  // namespace meniscus::apps
