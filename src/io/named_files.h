/// Names of files that stand in other files.
#pragma once

#include "io/bytes.h"
#include "meniscus/io.h"

namespace meniscus::io {

/// The path of a file that `source` names, relative to the directory of that file.
/// @param at  byte offset of the name, for the message
/// @throws Error  malformed_file: an empty name; invalid_argument: the name leads out of the directory and
///                options.allow_outside is not set
std::string path_of_named(const Source& source, const std::string& name, std::size_t at, const ReadOptions& options);

}  // namespace meniscus::io
