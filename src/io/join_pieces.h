/// One frame from several pieces.
#pragma once

#include "meniscus/io.h"

namespace meniscus::io {

/// Reads `count` pieces and joins them in order. All are counted from one origin. Attributes that not all pieces with
/// particles have are left out with a note; time, spacing and up are those of the first that tells.
/// @param read  reads one piece; it may be asked twice for a piece, then with an origin
Particles join_pieces(std::size_t count, const ReadOptions& options,
                      FunctionRef<Particles(std::size_t piece, const ReadOptions&)> read);

}  // namespace meniscus::io
