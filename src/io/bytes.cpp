#include "io/bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "io/file_bytes.h"

namespace meniscus::io {

void Bytes::resize(std::size_t size) {
  auto larger = std::make_unique_for_overwrite<char[]>(size);
  if (const std::size_t kept = std::min(size, size_); kept > 0) std::memcpy(larger.get(), data_.get(), kept);
  data_ = std::move(larger);
  size_ = size;
}

void Source::malformed(std::string problem, std::uint64_t byte_offset, std::string expected, std::string found) const {
  throw Error(ErrorCode::malformed_file,
              {std::move(problem), std::move(expected), std::move(found), path, byte_offset, {}, {}});
}

void Source::unsupported(std::string problem, std::string advice) const {
  throw Error(ErrorCode::unsupported, {std::move(problem), {}, {}, path, {}, {}, std::move(advice)});
}

void Source::require(std::uint64_t offset, std::uint64_t count, std::uint64_t item_size, std::string_view what) const {
  const std::uint64_t left = offset <= bytes.size() ? bytes.size() - offset : 0;
  if (item_size == 0 || count <= left / item_size) return;
  malformed(fmt::format("the file ends inside its {}", what), offset, fmt::format("{} x {} bytes", count, item_size),
            fmt::format("{} bytes", left));
}

void Source::require_end(std::uint64_t offset, std::string_view what) const {
  if (offset == bytes.size()) return;
  malformed(fmt::format("there is more behind its {} than its header says", what), offset, "the end",
            fmt::format("{} bytes", bytes.size() - offset));
}

void Source::need(std::uint64_t offset, std::uint64_t size) const {
  if (file == nullptr || offset >= bytes.size()) return;
  const auto first = static_cast<std::size_t>(offset);
  file->fetch(bytes.data() + first, static_cast<std::size_t>(std::min<std::uint64_t>(size, bytes.size() - first)));
}

bool Source::starts_with(std::string_view magic) const {
  return std::string_view(bytes.data(), bytes.size()).starts_with(magic);
}

std::uint64_t believable_size(std::uint64_t compressed_size) {
  return std::max<std::uint64_t>(std::uint64_t{64} << 20, 200 * compressed_size);
}

}  // namespace meniscus::io
