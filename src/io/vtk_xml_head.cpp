#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "io/frame_name.h"
#include "io/text.h"
#include "io/vtk_xml.h"
#include "io/vtk_xml_file.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kLookedAt = std::size_t{1} << 16;  ///< bytes of a piece that tell how many points it has

/// The values of an attribute in the order of the text.
std::vector<std::string_view> values_in(std::string_view text, std::string_view name) {
  const std::string before = fmt::format("{}=\"", name);
  std::vector<std::string_view> values;
  for (std::size_t at = text.find(before); at != std::string_view::npos; at = text.find(before, at)) {
    at += before.size();
    const std::size_t end = text.find('"', at);
    if (end == std::string_view::npos) break;
    values.push_back(text.substr(at, end - at));
  }
  return values;
}

/// The points of the pieces that the start of a file shows.
void look_at_serial(const Source& start, std::string_view text, FrameHead& head) {
  head.text = text.find("format=\"ascii\"") != std::string_view::npos;
  for (const std::string_view value : values_in(text, "NumberOfPoints")) {
    const std::vector<std::string_view> words = words_of(value);
    std::uint64_t count = 0;
    if (words.size() != 1 || !parse_count(words[0], count)) continue;
    head.particles += std::min(count, std::numeric_limits<std::uint64_t>::max() - head.particles);
    head.counted = true;
  }
  if (head.particles == 0) return;
  // Compressed particles take a byte a value at least, but for lattices at rest.
  const bool packed = text.find("compressor=\"") != std::string_view::npos;
  const std::uint64_t most = packed ? believable_size(head.plain_bytes) : head.plain_bytes;
  if (head.particles > most / (head.text ? 6 : 12))
    start.malformed("the file is shorter than its points", 0, {}, fmt::format("{} points", head.particles));
  const double a_particle = static_cast<double>(head.plain_bytes) / static_cast<double>(head.particles);
  head.values = std::max(3.0, a_particle / (head.text ? 9.0 : 4.0));
}

/// The pieces that the start of a parallel file names, each looked at in its own file; what those name is not followed.
void look_at_pieces(const Source& start, std::string_view text, FrameHead& head) {
  for (const std::string_view name : values_in(text, "Source")) {
    if (name.find("..") != std::string_view::npos || name.starts_with('/')) continue;
    const std::string path = directory_of(start.path) + std::string(name);
    const Bytes bytes = read_file(path, kLookedAt);
    const Source source{path, bytes.span()};
    if (!is_vtk_xml(source)) continue;
    FrameHead piece;
    std::error_code ignored;
    piece.file_bytes = piece.plain_bytes = std::filesystem::file_size(path, ignored);
    look_at_serial(source, {bytes.data(), bytes.size()}, piece);
    head.particles += piece.particles;
    head.counted = head.counted || piece.counted;
    head.text = piece.text;
    head.values = std::max(head.values, piece.values);
    head.file_bytes += piece.file_bytes;
    head.plain_bytes += piece.plain_bytes;
  }
}

}  // namespace

/// The start of a file tells the points of the pieces that it shows; of parallel files their pieces tell.
void look_at_vtk_xml(const Source& start, FrameHead& head) {
  const std::string_view text(start.bytes.data(), start.bytes.size());
  const std::size_t root = text.find("<VTKFile");
  const std::string_view tag = text.substr(std::min(root, text.size()), 400);
  if (tag.find("type=\"PUnstructuredGrid\"") != std::string_view::npos ||
      tag.find("type=\"PPolyData\"") != std::string_view::npos) {
    look_at_pieces(start, text, head);
    return;
  }
  look_at_serial(start, text, head);
}

}  // namespace meniscus::io
