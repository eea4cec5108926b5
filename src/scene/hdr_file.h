/// Radiance .hdr files.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Reads a Radiance RGBE picture [Ward1994], flat or run-length encoded, rows from the top.
/// @throws Error not_found, io_failed; malformed_file with the byte offset: not a .hdr, a header that promises more
///               than the file can hold, runs that leave their row, a truncated file; unsupported: XYZE, turned
///               pictures
Image<vec3> read_hdr(const std::string& path);

}  // namespace meniscus
