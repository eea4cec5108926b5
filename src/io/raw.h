/// Numbers in binary without any header.
#pragma once

#include <string>

#include "io/bytes.h"
#include "io/frame_head.h"
#include "io/values.h"
#include "meniscus/io.h"

namespace meniscus::io {

/// What options.raw says: "f32x3", "f64x4", "f32bex7".
struct RawForm {
  Scalar type = Scalar::float32;
  std::endian order = std::endian::little;
  std::size_t values = 3;  ///< a particle

  std::size_t row_bytes() const { return values * size_of(type); }
};

/// @throws Error  invalid_argument
RawForm parse_raw_form(std::string_view text);

/// Whether a file named .xyz begins with little-endian float32 triples instead of text.
bool is_raw_xyz(const Source& start);
/// Reads numbers as options.raw says; else such triples.
Particles read_raw(const Source& source, const ReadOptions& options);
void look_at_raw(const Source& start, FrameHead& head);

}  // namespace meniscus::io
