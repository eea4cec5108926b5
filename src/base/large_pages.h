/// Memory in large pages.
#pragma once

#include <cstddef>

namespace meniscus {

constexpr std::size_t kLargePage = std::size_t{1} << 21;  ///< bytes

/// Asks the system for pages of 2 MB where whole ones fit into memory that is written next. It clears a page when it is
/// first met, which costs more in pages of 4 KB than a pass over their content. Where that is refused, small pages do.
void ask_for_large_pages(void* memory, std::size_t bytes);

}  // namespace meniscus
