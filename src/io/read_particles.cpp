#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/readers.h"
#include "io/text.h"
#include "meniscus/io.h"

namespace meniscus {
namespace {

using namespace io;

constexpr std::string_view kHdf5Magic("\x89HDF\r\n\x1a\n", 8);

/// The first bytes for a message.
std::string shown_start(std::span<const char> bytes) {
  std::string shown;
  for (const char c : bytes.first(std::min<std::size_t>(bytes.size(), 16))) {
    const auto byte = static_cast<unsigned char>(c);
    shown += c >= ' ' && c <= '~' ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
  }
  return "'" + shown + "'";
}

/// Formats that are known not to be read, by their first bytes.
void refuse_known(const Source& source) {
  if (source.starts_with("\x7fNSJ") || source.starts_with("[\n") || source.starts_with("PGEOMETRY")) {
    source.unsupported("is Houdini geometry, but not classic binary BGEO", "export it as classic BGEO version 5");
  }
  if (source.starts_with("<?xml") || source.starts_with("<VTKFile")) {
    source.unsupported("is XML; of VTK's formats the legacy one is read", "export it as legacy .vtk");
  }
  if (source.starts_with("PK\x03\x04") || source.starts_with("\x93NUMPY")) {
    source.unsupported("is an archive or array of NumPy", "PySPH: write frames as HDF5 (--output-format hdf5)");
  }
}

/// The name without directories, in lower case and without .gz.
std::string plain_name(const std::string& path) {
  std::string name = lower(path.substr(path.find_last_of('/') + 1));
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  return name;
}

/// Whether bytes look like text: no control characters but blanks near the start.
bool is_text(std::span<const char> bytes) {
  const auto start = bytes.first(std::min<std::size_t>(bytes.size(), 1024));
  return std::none_of(start.begin(), start.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && !is_blank(c)) || byte == 0x7f;
  });
}

Particles read_plain(const Source& source) {
  if (source.starts_with("BgeoV")) return read_bgeo(source);
  if (source.starts_with("# vtk DataFile")) return read_vtk(source);
  if (source.starts_with("ply\n") || source.starts_with("ply\r")) return read_ply(source);
  refuse_known(source);

  // The content does not tell: numbers in text have no mark. The name decides what is expected.
  const std::string name = plain_name(source.path);
  const auto expect = [&](std::string_view extension, std::string_view what) {
    if (name.ends_with(extension)) {
      source.malformed(fmt::format("is named {} but is not {}", extension, what), 0, {}, shown_start(source.bytes));
    }
  };
  expect(".bgeo", "a classic BGEO file");
  expect(".vtk", "a legacy VTK file");
  expect(".ply", "a PLY file");
  expect(".hdf5", "an HDF5 file");
  expect(".h5", "an HDF5 file");
  for (const std::string_view extension : {".obj", ".stl", ".abc", ".vdb", ".usd", ".npz", ".bin", ".pdb", ".png"}) {
    if (name.ends_with(extension)) source.unsupported(fmt::format("a {} file holds no particles to read", extension));
  }
  if (!name.ends_with(".csv") && !is_text(source.bytes)) {
    source.unsupported(fmt::format("is of an unknown format (it starts with {})", shown_start(source.bytes)),
                       "formats read: bgeo, vtk (legacy), ply, hdf5 (PySPH), and text of x y z");
  }
  return read_xyz(source);
}

Particles read_compressed(const Source& source) {
  Gunzip stream(source);
  stream.grow_to(16);
  if (Source{source.path, stream.bytes()}.starts_with("BgeoV")) return read_bgeo(source.path, stream);
  if (Source{source.path, stream.bytes()}.starts_with(kHdf5Magic)) {
    source.unsupported("is compressed HDF5", "decompress it with gunzip; HDF5 can compress by itself");
  }
  stream.grow_to(believable_size(source.bytes.size()) + 1);
  return read_plain(Source{source.path, stream.bytes()});
}

Particles read_any(const std::string& path) {
  // The HDF5 library reads by itself: look at the first bytes before all are fetched.
  if (const Bytes start = read_file(path, kHdf5Magic.size()); Source{path, start.span()}.starts_with(kHdf5Magic)) {
    return read_hdf5(path);
  }
  const Bytes bytes = read_file(path);
  const Source source{path, bytes.span()};
  return source.starts_with("\x1f\x8b") ? read_compressed(source) : read_plain(source);
}

}  // namespace

Particles read_frame(const FrameSequence& sequence, const FramePath& frame) {
  return sequence.source ? sequence.source(frame) : read_particles(frame.path);
}

Particles read_particles(const std::string& path) {
  try {
    Particles particles = read_any(path);
    finish(particles);
    return particles;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::limit_exceeded,
                {"there is not enough memory for the frame", {}, {}, path, {}, {}, "use fewer particles a frame"});
  }
}

}  // namespace meniscus
