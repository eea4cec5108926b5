#include "io/unwritten.h"

#include "base/large_pages.h"

namespace meniscus::io {

#if defined(__GLIBCXX__) && !defined(_GLIBCXX_DEBUG) && !defined(_GLIBCXX_SANITIZE_VECTOR)

namespace {

/// A class derived from vector may name its protected members: a vector of libstdc++ ends where _M_finish says.
struct OpenVector : std::vector<float> {
  static void end_at(std::vector<float>& values, std::size_t size) {
    auto& memory = values.*(&OpenVector::_M_impl);
    memory._M_finish = memory._M_start + size;
  }
};

}  // namespace

void resize_unwritten(std::vector<float>& values, std::size_t size) {
  values.clear();
  const bool is_new = size > values.capacity();
  values.reserve(size);
  if (is_new) ask_for_large_pages(values.data(), size * sizeof(float));
  OpenVector::end_at(values, size);
}

#else

void resize_unwritten(std::vector<float>& values, std::size_t size) { values.resize(size); }

#endif

}  // namespace meniscus::io
