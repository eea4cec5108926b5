#pragma once

#include <string>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

/// All bytes of a file.
/// @throws Error not_found, io_failed
std::vector<unsigned char> file_bytes(const std::string& path);

/// A malformed_file error about a place in a file.
Error malformed(const std::string& path, std::string problem, std::optional<std::uint64_t> byte_offset = {});

/// @param bytes_wanted  what a picture's header asks for
/// @throws Error limit_exceeded: the picture would need more memory than a file of this size can stand for
void check_size_is_justified(const std::string& path, double bytes_wanted, std::size_t file_size);

}  // namespace meniscus
