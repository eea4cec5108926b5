#include "freed_memory.h"

#include <malloc.h>

namespace meniscus::apps {
namespace {

// Larger arrays, those of many particles, come from the system each time, in large pages; glibc allows no more.
constexpr int kLargest = 32 << 20;    ///< bytes
constexpr int kKeepUpTo = 512 << 20;  ///< bytes at the end of the heap

}  // namespace

void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, kLargest);
  mallopt(M_TRIM_THRESHOLD, kKeepUpTo);
}

}  // namespace meniscus::apps
