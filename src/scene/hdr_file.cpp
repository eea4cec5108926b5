// Written here and not taken from stb_image because that one fills the rest of a truncated file with zeros, keeps
// silent and cannot say where a file is broken.
#include "scene/hdr_file.h"

#include <fmt/format.h>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace meniscus {
namespace {

constexpr int kMaxEdge = 65535;

/// The bytes of a file with a position and errors that tell it.
class Reader {
 public:
  Reader(const std::string& path, std::vector<unsigned char> bytes) : path_(path), bytes_(std::move(bytes)) {}

  [[noreturn]] void fail(std::string problem, std::string expected = {}, std::string found = {},
                         ErrorCode code = ErrorCode::malformed_file) const {
    throw Error(code, {std::move(problem),
                       std::move(expected),
                       std::move(found),
                       path_,
                       position_,
                       {},
                       "give an equirectangular environment map in Radiance's .hdr format"});
  }
  /// Next line of the header without its end.
  std::string line() {
    std::string text;
    while (position_ < bytes_.size() && bytes_[position_] != '\n') {
      if (text.size() > 4096) fail("a line of the header does not end");
      text.push_back(static_cast<char>(bytes_[position_++]));
    }
    if (position_ == bytes_.size()) fail("the file ends inside its header");
    ++position_;
    return text;
  }
  std::size_t left() const { return bytes_.size() - position_; }
  unsigned char byte() {
    if (position_ == bytes_.size()) fail("the file ends inside its picture");
    return bytes_[position_++];
  }
  const unsigned char* peek() const { return bytes_.data() + position_; }

 private:
  std::string path_;
  std::vector<unsigned char> bytes_;
  std::size_t position_ = 0;
};

std::vector<unsigned char> bytes_of(const std::string& path) {
  std::error_code status;
  if (!std::filesystem::exists(path, status))
    throw Error(ErrorCode::not_found, {"there is no such environment map", {}, {}, path, {}, {}, {}});
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file || std::filesystem::is_directory(path, status))
    throw Error(ErrorCode::io_failed,
                {"the environment map cannot be read", {}, std::strerror(errno), path, {}, {}, {}});
  std::vector<unsigned char> bytes(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file) throw Error(ErrorCode::io_failed, {"reading the environment map failed", {}, {}, path, {}, {}, {}});
  return bytes;
}

vec3 decoded(const unsigned char* rgbe) {
  if (rgbe[3] == 0) return vec3{0.0f};
  const float scale = std::ldexp(1.0f, static_cast<int>(rgbe[3]) - 128 - 8);
  return {static_cast<float>(rgbe[0]) * scale, static_cast<float>(rgbe[1]) * scale,
          static_cast<float>(rgbe[2]) * scale};
}

/// Reads "-Y height +X width".
void read_size(Reader& file, int& width, int& height) {
  const std::string line = file.line();
  int values[2] = {0, 0};
  const char* at = line.data();
  const char* end = at + line.size();
  for (int k = 0; k < 2; ++k) {
    const std::string_view mark = k == 0 ? "-Y " : " +X ";
    if (!std::string_view(at, static_cast<std::size_t>(end - at)).starts_with(mark))
      file.fail("the picture is not stored in rows from the top left", "-Y height +X width", line,
                ErrorCode::unsupported);
    const auto [after, error] = std::from_chars(at + mark.size(), end, values[k]);
    if (error != std::errc{} || values[k] < 1 || values[k] > kMaxEdge)
      file.fail("the picture's size is not a number from 1 to 65535", "-Y height +X width", line);
    at = after;
  }
  height = values[0];
  width = values[1];
}

/// One channel of a row in runs: a count above 128 repeats one byte count - 128 times, another is followed by as many.
void read_runs(Reader& file, int width, unsigned char* out) {
  for (int x = 0; x < width;) {
    const int count = file.byte();
    const int length = count > 128 ? count - 128 : count;
    if (length == 0 || length > width - x)
      file.fail("a run leaves its row", fmt::format("1 to {} pixels", width - x), fmt::format("{}", length));
    const unsigned char value = count > 128 ? file.byte() : 0;
    for (int k = 0; k < length; ++k, ++x) out[4 * x] = count > 128 ? value : file.byte();
  }
}

}  // namespace

Image<vec3> read_hdr(const std::string& path) {
  Reader file(path, bytes_of(path));
  if (file.left() < 2 || file.peek()[0] != '#' || file.peek()[1] != '?')
    file.fail("this is not a Radiance .hdr file", "#?RADIANCE", file.left() == 0 ? "an empty file" : "other bytes");
  for (std::string line = file.line(); !line.empty(); line = file.line())
    if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
      file.fail("the pixels' format is not known", "32-bit_rle_rgbe", line.substr(7), ErrorCode::unsupported);
  int width = 0, height = 0;
  read_size(file, width, height);

  // The smallest file of this size has rows of longest runs, where rows may have runs at all.
  const bool runs_possible = width >= 8 && width < 32768;
  const std::size_t row_bytes =
      runs_possible ? 4 + 8 * ((static_cast<std::size_t>(width) + 126) / 127) : 4 * static_cast<std::size_t>(width);
  if (file.left() < row_bytes * static_cast<std::size_t>(height))
    file.fail("the file is too short for its picture",
              fmt::format("at least {} bytes for {} x {} pixels", row_bytes * static_cast<std::size_t>(height), width,
                          height),
              fmt::format("{} bytes", file.left()));

  Image<vec3> picture(width, height);
  std::vector<unsigned char> row(4 * static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) {
    const bool in_runs = runs_possible && file.left() >= 4 && file.peek()[0] == 2 && file.peek()[1] == 2 &&
                         file.peek()[2] == width >> 8 && file.peek()[3] == (width & 255);
    if (in_runs) {
      for (int k = 0; k < 4; ++k) file.byte();
      for (int channel = 0; channel < 4; ++channel) read_runs(file, width, row.data() + channel);
    } else {
      for (unsigned char& value : row) value = file.byte();
    }
    for (int x = 0; x < width; ++x) picture(x, y) = decoded(row.data() + 4 * x);
  }
  return picture;
}

}  // namespace meniscus
