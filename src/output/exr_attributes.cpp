#include "output/exr_attributes.h"

#include <fmt/format.h>
#include <algorithm>

#include "output/file_bytes.h"

namespace meniscus {
namespace {

constexpr std::size_t kLongestName = 255;

std::uint32_t little_endian(std::span<const unsigned char> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

}  // namespace

// The layout is that of "OpenEXR File Layout" (openexr.com): magic number, version and flags, then attributes of
// name\0 type\0 size value, then an empty name.
void check_exr_attributes(const std::string& path, std::span<const unsigned char> bytes) {
  constexpr std::uint32_t kMagic = 20000630;
  constexpr std::uint32_t kLongNames = 0x400;
  if (bytes.size() < 8 || little_endian(bytes, 0) != kMagic) throw malformed(path, "the file is no EXR", 0);
  const std::uint32_t version = little_endian(bytes, 4);
  if ((version & ~kLongNames) != 2) {
    ErrorDetail detail;
    detail.problem = "only plain scan-line EXR files can be read";
    detail.expected = "version 2, not tiled, deep or of several parts";
    detail.found = fmt::format("version and flags {:#x}", version);
    detail.path = path;
    detail.byte_offset = 4;
    throw Error(ErrorCode::unsupported, detail);
  }

  std::size_t at = 8;
  const auto skip_name = [&] {
    const std::size_t room = std::min(bytes.size() - at, kLongestName + 1);
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    const auto end = std::find(begin, begin + static_cast<std::ptrdiff_t>(room), 0);
    const auto length = static_cast<std::size_t>(end - begin);
    if (length == room) throw malformed(path, "the EXR header has a name without end", at);
    at += length + 1;
    return length;
  };
  while (skip_name() > 0) {
    skip_name();
    if (bytes.size() - at < 4) throw malformed(path, "the file ends inside its EXR header", bytes.size());
    const std::uint32_t size = little_endian(bytes, at);
    if (size > bytes.size() - at - 4) throw malformed(path, "an attribute of the EXR header leaves the file", at);
    at += 4 + size;
  }
}

}  // namespace meniscus
