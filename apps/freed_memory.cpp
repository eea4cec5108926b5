#include "freed_memory.h"

#include <malloc.h>

namespace meniscus::apps {
namespace {

constexpr int kKeepUpTo = 2'000'000'000;  ///< bytes at the end of the heap
constexpr int kGrowBy = 64 << 20;         ///< bytes

}  // namespace

void keep_freed_memory() {
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, kKeepUpTo);
  mallopt(M_TOP_PAD, kGrowBy);
}

}  // namespace meniscus::apps
