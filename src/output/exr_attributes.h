#pragma once

#include <span>
#include <string>

#include "meniscus/base.h"

namespace meniscus {

/// Walks over the attributes of an EXR file's header and checks that they lie in the file, so that no reader
/// makes room for a length that is only claimed.
/// @throws Error malformed_file naming the byte; unsupported: deep, tiled or multi-part files
void check_exr_attributes(const std::string& path, std::span<const unsigned char> bytes);

}  // namespace meniscus
