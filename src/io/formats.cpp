#include "io/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "io/csv_write.h"
#include "io/houdini_json.h"
#include "io/particle_writers.h"
#include "io/raw.h"
#include "io/readers.h"
#include "io/series_file.h"
#include "io/text.h"
#include "io/vtk_xml.h"
#include "io/vtk_xml_file.h"
#include "io/vtp_write.h"

namespace meniscus::io {
namespace {

/// Whether bytes look like text: no control characters but blanks near the start.
bool is_text(const Source& start) {
  const auto bytes = start.bytes.first(std::min<std::size_t>(start.bytes.size(), 1024));
  return std::none_of(bytes.begin(), bytes.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && !is_blank(c)) || byte == 0x7f;
  });
}

bool is_bgeo(const Source& start) { return start.starts_with("BgeoV"); }
bool is_geo(const Source& start) {
  return start.starts_with("PGEOMETRY") || start.starts_with("\xef\xbb\xbfPGEOMETRY");
}
bool is_vtk(const Source& start) {
  return start.starts_with("# vtk DataFile") || start.starts_with("\xef\xbb\xbf# vtk DataFile");
}
bool is_ply(const Source& start) { return start.starts_with("ply\n") || start.starts_with("ply\r"); }
bool is_hdf5(const Source& start) { return start.starts_with({"\x89HDF\r\n\x1a\n", 8}); }

bool is_npy(const Source& start) { return start.starts_with("\x93NUMPY"); }
bool is_zip(const Source& start) { return start.starts_with("PK\x03\x04") || start.starts_with("PK\x05\x06"); }

void look_at_hdf5_file(const Source& start, FrameHead& head) { look_at_hdf5(start.path, head); }

using Fetching = Format::Fetching;

const std::array kFormats{
    Format{"bgeo", "classic BGEO", {".bgeo"}, is_bgeo, read_bgeo, look_at_bgeo, Fetching::reader},
    Format{"houdini", "Houdini geometry", {".geo"}, is_houdini_json, read_houdini, look_at_houdini},
    Format{"geo", "Houdini's classic text", {}, is_geo, read_geo, look_at_geo},
    Format{"pdb", "Maya's PDB", {".pdb"}, is_pdb, read_pdb, look_at_pdb},
    Format{"realflow", "RealFlow's BIN", {}, is_realflow, read_realflow, look_at_realflow},
    Format{"vtk", "legacy VTK", {".vtk"}, is_vtk, read_vtk, look_at_vtk, Fetching::reader},
    Format{"vtkxml",
           "VTK XML",
           {".vtu", ".vtp", ".pvtu", ".pvtp"},
           is_vtk_xml,
           read_vtk_xml,
           look_at_vtk_xml,
           Fetching::reader},
    Format{"series", "a list of frames", {".pvd", ".series"}, is_json_series, refuse_series},
    Format{"ply", "PLY", {".ply"}, is_ply, read_ply, look_at_ply, Fetching::reader},
    Format{"hdf5", "HDF5", {".hdf5", ".h5"}, is_hdf5, read_hdf5, look_at_hdf5_file, Fetching::library},
    Format{"npy", "NPY", {".npy"}, is_npy, read_npy, look_at_npy, Fetching::reader},
    Format{"npz", "NPZ", {".npz"}, is_zip, read_npz, look_at_npz, Fetching::reader},
    // Numbers without a header: where the options say so, or in an .xyz that is no text.
    Format{"raw", "raw numbers", {}, is_raw_xyz, read_raw, look_at_raw, Fetching::reader},
    // Numbers in text have no mark: after all that have one.
    Format{"xyz", "text of x y z", {".xyz", ".txt", ".csv", ".dat"}, is_text, read_xyz, look_at_xyz},
};

const std::vector<Writer> kWriters{
    // In the order in which messages list them.
    {".npz", write_npz},      {".ply", write_ply}, {".bgeo", write_bgeo},
    {".bgeo.gz", write_bgeo}, {".vtp", write_vtp}, {".csv", write_csv},
};

/// The name without directories, in lower case and without .gz.
std::string plain_name(const std::string& path) {
  std::string name = lower(path.substr(path.find_last_of('/') + 1));
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  return name;
}

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
  if (source.starts_with("scf1"))
    source.unsupported("is Houdini geometry compressed with Blosc (.bgeo.sc)",
                       "decompress it with Houdini: gconvert FILE.bgeo.sc FILE.bgeo, or write .bgeo or .bgeo.gz");
  if (source.starts_with("<?xml"))
    source.unsupported("is XML, but not of VTK", "export it as .vtu, .vtp or legacy .vtk");
}

}  // namespace

std::span<const Format> formats() { return kFormats; }

std::span<const Writer> writers() { return kWriters; }

const Format& format_of(const Source& start) {
  const auto is_marked = [](const Format& format) { return format.recognises && format.recognises != is_text; };
  for (const Format& format : kFormats)
    if (is_marked(format) && format.recognises(start)) return format;
  refuse_known(start);

  // The content does not tell: the name says what was expected.
  const std::string name = plain_name(start.path);
  const auto named = [&](const Format& format) {
    return std::any_of(format.endings.begin(), format.endings.end(),
                       [&](std::string_view ending) { return name.ends_with(ending); });
  };
  for (const Format& format : kFormats)
    if (is_marked(format) && named(format))
      start.malformed(fmt::format("is named {} but is not {}", format.endings.front(), format.title), 0, {},
                      shown_start(start.bytes));
  if (name.ends_with(".bin") && (start.bytes.empty() || !is_text(start)))
    start.unsupported("is a .bin file of a program's own", "plain numbers: --raw f32x3");
  for (const std::string_view extension : {".obj", ".stl", ".abc", ".vdb", ".usd", ".png"})
    if (name.ends_with(extension)) start.unsupported(fmt::format("a {} file holds no particles to read", extension));
  for (const Format& format : kFormats)
    if (format.recognises == is_text && (is_text(start) || name.ends_with(".csv"))) return format;
  std::string names;
  for (const Format& format : kFormats) names += fmt::format("{}{}", names.empty() ? "" : ", ", format.title);
  start.unsupported(fmt::format("is of an unknown format (it starts with {})", shown_start(start.bytes)),
                    "formats read: " + names);
}

}  // namespace meniscus::io
