#include "particles/band_memory.h"

#include <new>

#include "base/large_pages.h"

namespace meniscus {
namespace {

constexpr std::size_t kSmallAlignment = 64;

std::align_val_t alignment_of(std::size_t bytes) {
  return std::align_val_t{bytes >= kLargePage ? kLargePage : kSmallAlignment};
}

}  // namespace

void* allocate_pages(std::size_t bytes) {
  void* memory = ::operator new(bytes, alignment_of(bytes));
  ask_for_large_pages(memory, bytes);
  return memory;
}

void free_pages(void* memory, std::size_t bytes) noexcept { ::operator delete(memory, alignment_of(bytes)); }

}  // namespace meniscus
