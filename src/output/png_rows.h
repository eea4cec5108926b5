/// A picture's rows as the data of a PNG file, made on all threads.
#pragma once

#include <vector>

#include "meniscus/output.h"

namespace meniscus {

/// Pieces of one zlib stream (RFC 1950) of the filtered rows, to be written one after the other. The same bytes for any
/// number of threads.
/// @param level  of zlib, 1 .. 9
/// @throws Error limit_exceeded: zlib gets no memory
std::vector<std::vector<unsigned char>> compressed_rows(const Image<Rgb8>& picture, int level);

}  // namespace meniscus
