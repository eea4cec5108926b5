/// Base64 as VTK's XML files use it.
#pragma once

#include "io/bytes.h"

namespace meniscus::io {

struct DecodedBase64 {
  Bytes bytes;           ///< may be larger than what was decoded
  std::size_t size = 0;  ///< bytes decoded
};

/// Decodes the first `most` bytes, or what there is, of the base64 text in [begin, end) of a source; in parallel.
/// Padding may stand within it: a header and its data are often encoded one after the other. Blanks and line ends are
/// skipped. Memory is bounded by the text.
/// @throws Error  malformed_file: a character that is none of base64
DecodedBase64 decode_base64(const Source& source, std::size_t begin, std::size_t end, std::uint64_t most);

}  // namespace meniscus::io
