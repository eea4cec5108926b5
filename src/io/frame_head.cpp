#include "io/frame_head.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "io/formats.h"
#include "io/gzip.h"
#include "io/ply_header.h"
#include "io/raw.h"
#include "io/readable.h"
#include "io/readers.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kStart = std::size_t{1} << 16;     ///< bytes of a file that are looked at
constexpr std::size_t kInflated = std::size_t{1} << 14;  ///< of a compressed one, after decompression

/// The size that the end of a gzip file says, modulo 4 GiB; at least three times the compressed one is taken.
std::uint64_t inflated_size(const std::string& path, std::uint64_t compressed) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(-4, std::ios::end);
  unsigned char last[4] = {0, 0, 0, 0};
  file.read(reinterpret_cast<char*>(last), 4);
  std::uint64_t size = 0;
  for (int i = 3; i >= 0; --i) size = size << 8 | last[i];
  while (size < compressed && compressed >> 32 > 0) size += std::uint64_t{1} << 32;
  return std::min(size >= compressed / 8 ? size : 3 * compressed, believable_size(compressed));
}

}  // namespace

void look_at_ply(const Source& start, FrameHead& head) {
  const PlyHeader header = read_ply_header(start);
  head.format = "ply";
  head.text = header.ascii;
  head.spacing = header.spacing;
  for (const PlyElement& element : header.elements) {
    if (element.name != "vertex") continue;
    head.particles = element.count;
    head.counted = true;
    head.values = static_cast<double>(std::max<std::size_t>(element.properties.size(), 3));
    const std::uint64_t row = header.ascii ? 2 * element.properties.size() : element.row_size();
    if (element.count > head.plain_bytes / std::max<std::uint64_t>(row, 1))
      start.malformed("the file is shorter than its vertices", header.end);
    return;
  }
  start.malformed("has no element 'vertex'", header.end, "element vertex");
}

/// Arrays behind the points are not seen; the size of the file tells how many there can be.
void look_at_vtk(const Source& start, FrameHead& head) {
  head.format = "vtk";
  TextCursor text(start);
  text.line();  // "# vtk DataFile Version 4.1"
  text.line();  // title
  head.text = lower(text.word()) == "ascii";
  std::string bytes = lower({start.bytes.data(), start.bytes.size()});
  const std::size_t points = bytes.find("\npoints ");
  if (points == std::string::npos)
    start.malformed("has no points near its start", start.bytes.size(), "POINTS count type");
  text.seek(points + 1);
  text.word();
  head.particles = text.count("points");
  head.counted = true;
  const std::size_t size = lower(text.word()) == "double" ? 8 : 4;
  const std::uint64_t least = head.text ? 6 : 3 * size;
  if (head.particles > head.plain_bytes / least) start.malformed("the file is shorter than its points", points + 1);
  if (head.particles == 0) return;
  const double a_particle = static_cast<double>(head.plain_bytes) / static_cast<double>(head.particles);
  head.values = std::max(3.0, a_particle / (head.text ? 9.0 : static_cast<double>(size)));
}

std::uint64_t FrameHead::particle_bytes() const {
  return static_cast<std::uint64_t>(static_cast<double>(particles) * values * sizeof(float));
}

std::uint64_t FrameHead::reading_bytes() const {
  // The HDF5 library reads by itself, an array at a time; a stream that is decompressed grows by doubling.
  const bool compressed = plain_bytes > 0 && plain_bytes != file_bytes;
  const std::uint64_t wide = text ? 3 * sizeof(double) * particles : 0;  // positions in text are read as doubles
  return particle_bytes() + wide + (format == "hdf5" ? 0 : file_bytes) + (compressed ? plain_bytes : 0);
}

namespace {

FrameHead look_at_any(const std::string& path, const ReadOptions& options) {
  FrameHead head;
  const Bytes start = read_file(path, kStart);
  head.file_bytes = head.plain_bytes = start.size();
  if (std::error_code error; start.size() == kStart)
    head.file_bytes = head.plain_bytes = std::filesystem::file_size(path, error);
  const Source source{path, start.span()};
  const auto look = [&](const Source& plain) {
    if (!options.raw.empty()) {
      head.format = "raw";
      head.particles = head.plain_bytes / parse_raw_form(options.raw).row_bytes();
      head.counted = true;
      return;
    }
    const Format& format = format_of(plain);
    head.format = format.name;
    if (format.look) format.look(plain, head);
  };
  if (source.starts_with("\x1f\x8b")) {
    head.plain_bytes = inflated_size(path, head.file_bytes);
    Gunzip stream(source);
    stream.grow_to(std::min<std::uint64_t>(kInflated, std::max<std::uint64_t>(head.plain_bytes / 2, 64)));
    look(Source{path, stream.bytes()});
  } else {
    look(source);
  }
  return head;
}

}  // namespace

FrameHead look_at_frame(const std::string& path, const ReadOptions& options) {
  try {
    return look_at_any(path, options);
  } catch (const Error& error) {
    throw readable(error);
  }
}

FrameHead look_at_frame(const FramePath& frame, const ReadOptions& options) {
  FrameHead all = look_at_frame(frame.path, options);
  for (const std::string& path : frame.further) {
    const FrameHead part = look_at_frame(path, options);
    all.file_bytes += part.file_bytes;
    all.plain_bytes += part.plain_bytes;
    all.particles += part.particles;
    all.counted = all.counted && part.counted;
    all.values = std::max(all.values, part.values);
    all.text = all.text || part.text;
  }
  return all;
}

}  // namespace meniscus::io
