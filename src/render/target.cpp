#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "meniscus/render.h"

namespace meniscus {
namespace {

namespace fs = std::filesystem;

struct Placeholder {
  std::size_t begin = 0, length = 0;  ///< in the path
  int digits = 0;                     ///< at least; filled with zeros
};

/// The next {} or {:04} (also {:04d}, {:4}) at or after `from`.
std::optional<Placeholder> next_placeholder(const std::string& path, std::size_t from) {
  const std::size_t open = path.find('{', from);
  if (open == std::string::npos) return {};
  const auto refuse = [&] {
    throw Error(ErrorCode::invalid_argument, {"the pattern of the output cannot be understood",
                                              "{} or {:04} for the frame number",
                                              path.substr(open),
                                              path,
                                              {},
                                              {},
                                              {}});
  };
  const std::size_t close = path.find('}', open);
  if (close == std::string::npos) refuse();
  std::string inside = path.substr(open + 1, close - open - 1);
  Placeholder found{open, close - open + 1, 0};
  if (inside.empty()) return found;
  if (inside.front() != ':') refuse();
  inside.erase(0, 1);
  if (!inside.empty() && inside.back() == 'd') inside.pop_back();
  const bool digits = std::all_of(inside.begin(), inside.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!digits || inside.size() > 2) refuse();
  if (!inside.empty()) found.digits = std::stoi(inside);
  return found;
}

PictureFormat format_of(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (extension == ".png") return PictureFormat::png;
  if (extension == ".exr") return PictureFormat::exr;
  if (extension == ".mp4") return PictureFormat::mp4;
  if (extension == ".ply") return PictureFormat::ply;
  throw Error(ErrorCode::invalid_argument, {"the kind of picture is not told by this output",
                                            ".png, .exr or .mp4",
                                            extension.empty() ? "no extension" : extension,
                                            path,
                                            {},
                                            {},
                                            {}});
}

[[noreturn]] void fail(const std::string& path, std::string problem, std::string found) {
  throw Error(ErrorCode::io_failed,
              {std::move(problem), {}, std::move(found), path, {}, {}, "write to another place, or free this one"});
}

}  // namespace

OutputTarget::OutputTarget(std::string path) : path_(std::move(path)), format_(PictureFormat::png), is_pattern_(false) {
  if (path_.empty()) throw Error(ErrorCode::invalid_argument, "the output has no name");
  format_ = format_of(path_);
  is_pattern_ = next_placeholder(path_, 0).has_value();
  if (is_pattern_ && is_film())
    throw Error(ErrorCode::invalid_argument, {"a film is one file", "a name without {}", path_, {}, {}, {}, {}});
}

std::string OutputTarget::path_of(std::int64_t number) const {
  std::string result;
  std::size_t from = 0;
  while (const auto found = next_placeholder(path_, from)) {
    result += path_.substr(from, found->begin - from) + fmt::format("{:0{}}", number, found->digits);
    from = found->begin + found->length;
  }
  return result + path_.substr(from);
}

void OutputTarget::prepare() const {
  const fs::path directory = fs::path(path_of(0)).parent_path();
  std::error_code error;
  if (!directory.empty() && !fs::is_directory(directory, error)) {
    fs::create_directories(directory, error);
    if (error) fail(path_, "the directory of the output cannot be made", error.message());
  }
  if (!is_pattern_ && fs::is_directory(path_, error)) fail(path_, "the output is a directory", "a directory");
  // Permissions tell less than trying: file systems may be read-only or full.
  const fs::path probe = directory / fmt::format(".meniscus-{}.tmp", ::getpid());
  const bool written = static_cast<bool>(std::ofstream(probe) << "probe" << std::flush);
  fs::remove(probe, error);
  if (!written) fail(path_, "the output cannot be written", "a directory that nothing can be written into");
}

}  // namespace meniscus
