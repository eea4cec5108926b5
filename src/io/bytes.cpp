#include "io/bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>

namespace meniscus::io {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 22;  ///< bytes of a file that one thread reads at once

[[noreturn]] void system_failure(const std::string& path, std::string problem) {
  const int number = errno;
  const ErrorCode code = number == ENOENT || number == ENOTDIR ? ErrorCode::not_found : ErrorCode::io_failed;
  throw Error(code, {std::move(problem), {}, std::strerror(number), path, {}, {}, {}});
}

struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

}  // namespace

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

bool Source::starts_with(std::string_view magic) const {
  return std::string_view(bytes.data(), bytes.size()).starts_with(magic);
}

Bytes read_file(const std::string& path, std::size_t most) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (file.value < 0) system_failure(path, "cannot open the file");
  struct stat status {};
  if (::fstat(file.value, &status) != 0) system_failure(path, "cannot look at the file");
  if (!S_ISREG(status.st_mode)) {
    throw Error(
        ErrorCode::io_failed,
        {"is not a regular file", {}, S_ISDIR(status.st_mode) ? "a directory" : "a device or pipe", path, {}, {}, {}});
  }

  // A file may shrink while it is read: what could be read up to the first gap is what it is. (Were it mapped instead
  // of read, the process would be killed.)
  Bytes bytes(std::min(most, static_cast<std::size_t>(status.st_size)));
  std::atomic<std::size_t> whole{bytes.size()};
  std::atomic<int> failure{0};
  parallel_for(bytes.size(), kPiece, [&](std::size_t begin, std::size_t end) {
    while (begin < end) {
      const ssize_t count = ::pread(file.value, bytes.data() + begin, end - begin, static_cast<off_t>(begin));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) failure = errno;
      if (count <= 0) break;
      begin += static_cast<std::size_t>(count);
    }
    for (std::size_t least = whole; begin < end && begin < least && !whole.compare_exchange_weak(least, begin);) {
    }
  });
  if (failure != 0) {
    errno = failure;
    system_failure(path, "cannot read the file");
  }
  if (whole < bytes.size()) bytes.resize(whole);
  return bytes;
}

std::uint64_t believable_size(std::uint64_t compressed_size) {
  return std::max<std::uint64_t>(std::uint64_t{64} << 20, 200 * compressed_size);
}

}  // namespace meniscus::io
