/// Memory for arrays about as long as the particles are many.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace meniscus {

/// Bytes of any content, aligned to 64. What takes 2 MB and more asks for pages of 2 MB: the system clears a fresh page
/// when it is first met, which costs more in pages of 4 KB than a pass over their content.
/// @throws std::bad_alloc
void* allocate_pages(std::size_t bytes);
void free_pages(void* memory, std::size_t bytes) noexcept;

/// For vectors whose values are written by many threads after resize(), which leaves them as they are.
template <class T>
struct PageAllocator {
  using value_type = T;
  PageAllocator() = default;
  template <class Other>
  explicit(false) PageAllocator(const PageAllocator<Other>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_pages(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) noexcept { free_pages(memory, count * sizeof(T)); }
  /// No value is no write: what was resized has any content.
  template <class Other>
  void construct(Other*) noexcept {}
  template <class Other, class... Values>
  void construct(Other* at, Values&&... values) {
    std::construct_at(at, std::forward<Values>(values)...);
  }
  bool operator==(const PageAllocator&) const { return true; }
};

/// Of plain values; resize() does not set the new ones.
template <class T>
using PagedVector = std::vector<T, PageAllocator<T>>;

/// `count` values of any content.
template <class T>
std::shared_ptr<T[]> paged_array(std::size_t count) {
  T* memory = PageAllocator<T>().allocate(count);
  return std::shared_ptr<T[]>(memory, [count](T* values) { PageAllocator<T>().deallocate(values, count); });
}

}  // namespace meniscus
