#include "particles/band_memory.h"

#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace meniscus {
namespace {

constexpr std::size_t kPage = std::size_t{1} << 21, kSmallAlignment = 64;

std::align_val_t alignment_of(std::size_t bytes) { return std::align_val_t{bytes >= kPage ? kPage : kSmallAlignment}; }

}  // namespace

void* allocate_pages(std::size_t bytes) {
  void* memory = ::operator new(bytes, alignment_of(bytes));
#ifdef __linux__
  // Whole pages only, so that no more is taken than was asked for. Where it is refused, small pages do.
  if (bytes >= kPage) madvise(memory, bytes / kPage * kPage, MADV_HUGEPAGE);
#endif
  return memory;
}

void free_pages(void* memory, std::size_t bytes) noexcept { ::operator delete(memory, alignment_of(bytes)); }

}  // namespace meniscus
