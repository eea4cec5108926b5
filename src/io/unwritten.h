/// Memory for values that are all written next.
#pragma once

#include <cstddef>
#include <vector>

namespace meniscus::io {

/// Gives a vector `size` values without writing them: what they are is not known until they are written, and what the
/// vector held before is lost. std::vector::resize() writes zeros, by one thread, which takes as long as the file's
/// bytes take to be read; here the first to touch the memory are the threads that convert. As resize() where the
/// standard library is not libstdc++, or checks its vectors.
void resize_unwritten(std::vector<float>& values, std::size_t size);

}  // namespace meniscus::io
