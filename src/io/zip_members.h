/// The members of a zip archive: where they are, and their bytes, checked.
#pragma once

#include "io/bytes.h"

namespace meniscus::io {

struct ZipMember {
  std::string name;
  std::uint64_t packed_size = 0;  ///< bytes in the archive
  std::uint64_t size = 0;         ///< bytes when unpacked
  std::uint32_t crc = 0;          ///< of the unpacked bytes
  bool deflated = false;          ///< else stored as they are
  std::size_t first = 0;          ///< byte offset in the archive
};

/// Of the directory at the archive's end, zip64 too. All of them lie inside the file.
/// @throws Error malformed_file; unsupported: encrypted, of several volumes, another method than deflate
std::vector<ZipMember> zip_members(const Source& source);

/// Bytes of a member: `plain` points into the archive, as Source::bytes, or into `owned`.
struct UnpackedMember {
  Bytes owned;
  std::span<const char> plain;
  FileBytes* file = nullptr;  ///< of the archive, where its bytes are not all in memory
};

/// Unpacks members in parallel and checks their sums, but for those that stay in the archive's file: these are for
/// check_stored() when their values have been read.
/// @throws Error malformed_file: damaged; limit_exceeded: all of them are larger than the archive justifies
std::vector<UnpackedMember> unpack(const Source& source, std::span<const ZipMember> members);

/// Checks the sums of the members that unpack() has left in the file.
/// @throws Error malformed_file: damaged
void check_stored(const Source& source, std::span<const ZipMember> members);

}  // namespace meniscus::io
