#include "output/file_bytes.h"

#include <fmt/format.h>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

namespace meniscus {
namespace {

/// Deflate packs at most 1032 bytes into one.
constexpr double kMostCompression = 1032;
/// No header is refused for less than this, bytes.
constexpr double kAlwaysAllowed = 64 << 20;

Error read_failed(const std::string& path, int error_number) {
  ErrorDetail detail;
  detail.problem = "cannot read the file: " + std::generic_category().message(error_number);
  detail.path = path;
  return Error(error_number == ENOENT ? ErrorCode::not_found : ErrorCode::io_failed, detail);
}

}  // namespace

std::vector<unsigned char> file_bytes(const std::string& path) {
  const auto close = [](std::FILE* file) { std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(path.c_str(), "rbe"));
  if (!file) throw read_failed(path, errno);
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw read_failed(path, EISDIR);
  std::vector<unsigned char> bytes;
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  for (std::size_t read = 1; read > 0;) {
    const std::size_t have = bytes.size();
    bytes.resize(have + kPiece);
    errno = 0;
    read = std::fread(bytes.data() + have, 1, kPiece, file.get());
    bytes.resize(have + read);
  }
  if (std::ferror(file.get())) throw read_failed(path, errno);
  return bytes;
}

Error malformed(const std::string& path, std::string problem, std::optional<std::uint64_t> byte_offset) {
  ErrorDetail detail;
  detail.problem = std::move(problem);
  detail.path = path;
  detail.byte_offset = byte_offset;
  return Error(ErrorCode::malformed_file, detail);
}

void check_size_is_justified(const std::string& path, double bytes_wanted, std::size_t file_size) {
  if (bytes_wanted <= kAlwaysAllowed || bytes_wanted <= kMostCompression * static_cast<double>(file_size)) return;
  ErrorDetail detail;
  detail.problem = "the picture's header asks for more than the file can hold";
  detail.expected = fmt::format("at most {:.0f} MB for a file of {} bytes",
                                kMostCompression * static_cast<double>(file_size) * 1e-6, file_size);
  detail.found = fmt::format("{:.0f} MB", bytes_wanted * 1e-6);
  detail.path = path;
  throw Error(ErrorCode::limit_exceeded, detail);
}

}  // namespace meniscus
