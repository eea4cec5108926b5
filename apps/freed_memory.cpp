#include "freed_memory.h"

#include <malloc.h>

namespace meniscus::apps {
namespace {

constexpr int kKeepUpTo = 512 << 20;  ///< bytes at the end of the heap

}  // namespace

void keep_freed_memory() {
  mallopt(M_MMAP_MAX, 0);  // arrays of the system go back to it, and its threshold is 32 MB at most
  mallopt(M_TRIM_THRESHOLD, kKeepUpTo);
}

}  // namespace meniscus::apps
