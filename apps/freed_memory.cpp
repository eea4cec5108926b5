#include "freed_memory.h"

#include <malloc.h>

namespace meniscus::apps {
namespace {

// glibc's own standards (man mallopt).
constexpr int kMappings = 65536;
constexpr int kTrimFrom = 128 << 10;

constexpr int kKeepUpTo = 2'000'000'000;  ///< bytes at the end of the heap
constexpr int kGrowBy = 64 << 20;         ///< bytes

}  // namespace

void keep_freed_memory() {
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, kKeepUpTo);
  mallopt(M_TOP_PAD, kGrowBy);
}

void return_freed_memory() {
  mallopt(M_MMAP_MAX, kMappings);
  mallopt(M_TRIM_THRESHOLD, kTrimFrom);
  mallopt(M_TOP_PAD, kTrimFrom);
  malloc_trim(0);
}

}  // namespace meniscus::apps
