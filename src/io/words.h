/// Words of 32 bits in a file's byte order, as floats; vectorised.
#pragma once

#include <cstddef>

namespace meniscus::io {

/// Reverses the bytes of `count` words. None of the addresses of bytes below need be aligned.
void swap_words(const char* bytes, std::size_t count, float* target);

/// Three words side by side in each row, to an array each.
/// @param stride  bytes from row to row, 12 or more
/// @param swap    reverse the bytes of each word
void split_triples(const char* bytes, std::size_t stride, bool swap, std::size_t rows, float* x, float* y, float* z);

/// The same to one array of 3 * rows floats.
void copy_triples(const char* bytes, std::size_t stride, bool swap, std::size_t rows, float* target);

}  // namespace meniscus::io
