#include "io/vtk_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "io/file_bytes.h"
#include "io/join_pieces.h"
#include "io/named_files.h"
#include "io/positions.h"
#include "io/series_file.h"
#include "io/text.h"
#include "io/unwritten.h"
#include "io/vtk_xml_file.h"

namespace meniscus::io {
namespace {

constexpr const char* kFormat = "vtkxml";
constexpr std::size_t kStart = std::size_t{1} << 12;  ///< bytes that tell a format
constexpr std::size_t kMostPieces = 100'000;
constexpr std::size_t kMostArrays = 1024;  ///< of a piece

/// The points of a piece as positions.
void read_points(const VtkXmlFile& file, const XmlElement& piece, std::uint64_t count, VtkXmlArrays& arrays,
                 const ReadOptions& options, Particles& particles) {
  const XmlElement* points = piece.child("Points");
  const XmlElement* array = points != nullptr ? points->child("DataArray") : nullptr;
  if (array == nullptr) file.source.malformed("a piece has no points", piece.at, "<Points> with a <DataArray>");
  const std::uint64_t components = xml_count(file.source, *array, "NumberOfComponents", 3);
  if (components != 3)
    file.source.malformed("the points are not of three components", array->at, "3", fmt::format("{}", components));
  const VtkXmlArray values = arrays.read(*array, count, 3);
  const std::size_t size = size_of(values.type);
  const Stored first = values.first;
  set_positions(values.type, values.order,
                {Column{first, 3 * size}, {first + size, 3 * size}, {first + 2 * size, 3 * size}},
                static_cast<std::size_t>(count), options, particles);
}

/// Throws if the points of a piece that says it has none have bytes. An array that names no place is none.
void check_no_points(const VtkXmlFile& file, const XmlElement& piece, VtkXmlArrays& arrays) {
  const XmlElement* points = piece.child("Points");
  const XmlElement* array = points != nullptr ? points->child("DataArray") : nullptr;
  if (array == nullptr || !arrays.type_of(*array)) return;
  std::uint64_t offset = 0;
  const bool appended = lower(array->value("format")) == "appended";
  const Source text{file.source.path, file.source.bytes.first(array->text_end)};
  const bool is_there =
      appended ? parse_count(array->value("offset"), offset) && offset < file.appended_end - file.appended_begin
               : !TextCursor(text, array->text_begin).peek().empty();
  if (is_there) arrays.read(*array, 0, 3);
}

void read_attributes(const VtkXmlFile& file, const XmlElement& data, std::uint64_t count, VtkXmlArrays& arrays,
                     Particles& particles) {
  if (data.children.size() > kMostArrays)
    file.source.malformed("has an impossible number of arrays", data.at, fmt::format("at most {}", kMostArrays),
                          fmt::format("{}", data.children.size()));
  for (const XmlElement& array : data.children) {
    if (array.name != "DataArray" && array.name != "Array") continue;
    Attribute attribute{array.value("Name"), 1, {}};
    const std::optional<Scalar> type = arrays.type_of(array);
    if (!type) {
      particles.notes.push_back(fmt::format("array '{}' holds no numbers and was left out", attribute.name));
      continue;
    }
    const std::uint64_t components = xml_count(file.source, array, "NumberOfComponents", 1);
    const VtkXmlArray values = arrays.read(array, count, components);
    attribute.components = static_cast<int>(components);
    resize_unwritten(attribute.values, static_cast<std::size_t>(count * components));
    read_columns(values.type, values.order, values.first, size_of(values.type), attribute.values.size(), 1,
                 attribute.values.data());
    particles.attributes.push_back(std::move(attribute));
  }
}

/// Leaves out points that another piece has as well, or that are hidden: their vtkGhostType is not zero.
void drop_ghosts(Particles& particles) {
  const auto ghost = std::find_if(particles.attributes.begin(), particles.attributes.end(),
                                  [](const Attribute& a) { return a.name == "vtkGhostType" && a.components == 1; });
  if (ghost == particles.attributes.end()) return;
  const std::vector<float> type = std::move(ghost->values);
  particles.attributes.erase(ghost);
  const auto keep = [&](std::vector<float>& values, std::size_t components) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < type.size(); ++i) {
      if (type[i] != 0) continue;
      for (std::size_t c = 0; c < components; ++c) values[kept * components + c] = values[i * components + c];
      ++kept;
    }
    values.resize(kept * components);
  };
  for (std::vector<float>* values : {&particles.x, &particles.y, &particles.z}) keep(*values, 1);
  for (Attribute& attribute : particles.attributes)
    keep(attribute.values, static_cast<std::size_t>(attribute.components));
  if (particles.size() < type.size()) particles.notes.push_back("points that vtkGhostType marks were left out");
}

/// The time among a data set's fields: an array TimeValue of one number.
std::optional<double> read_time(const VtkXmlFile& file, const XmlElement& set, VtkXmlArrays& arrays) {
  const XmlElement* fields = set.child("FieldData");
  if (fields == nullptr) return std::nullopt;
  for (const XmlElement& array : fields->children) {
    const std::string name = lower(array.value("Name"));
    if ((name != "timevalue" && name != "time") || !arrays.type_of(array)) continue;
    if (xml_count(file.source, array, "NumberOfTuples", 1) != 1) continue;
    if (xml_count(file.source, array, "NumberOfComponents", 1) != 1) continue;
    const VtkXmlArray value = arrays.read(array, 1, 1);
    PieceBuffer buffer;
    return read_value(value.type, value.order, buffer.bytes(value.first, size_of(value.type)));
  }
  return std::nullopt;
}

/// The <Piece> elements of a data set.
std::vector<const XmlElement*> pieces_of(const VtkXmlFile& file, const XmlElement& set) {
  std::vector<const XmlElement*> pieces;
  for (const XmlElement& child : set.children)
    if (child.name == "Piece") pieces.push_back(&child);
  if (pieces.size() > kMostPieces)
    file.source.malformed("has an impossible number of pieces", set.at, {}, fmt::format("{}", pieces.size()));
  return pieces;
}

Particles read_set(const VtkXmlFile& file, const XmlElement& set, const ReadOptions& options) {
  const std::vector<const XmlElement*> pieces = pieces_of(file, set);
  if (pieces.empty()) file.source.malformed("has no piece", set.at, "<Piece NumberOfPoints=...>");
  VtkXmlArrays arrays(file);
  // Of an empty piece among others some writers leave the places unset.
  const bool is_empty = std::all_of(pieces.begin(), pieces.end(), [&](const XmlElement* piece) {
    return xml_count(file.source, *piece, "NumberOfPoints") == 0;
  });
  if (is_empty)
    for (const XmlElement* piece : pieces) check_no_points(file, *piece, arrays);
  Particles particles = join_pieces(pieces.size(), options, [&](std::size_t i, const ReadOptions& reading) {
    Particles piece;
    const std::uint64_t count = xml_count(file.source, *pieces[i], "NumberOfPoints");
    if (count == 0) return piece;
    read_points(file, *pieces[i], count, arrays, reading, piece);
    if (const XmlElement* data = pieces[i]->child("PointData")) read_attributes(file, *data, count, arrays, piece);
    drop_ghosts(piece);
    return piece;
  });
  particles.time = read_time(file, set, arrays);
  return particles;
}

/// Reads the file that a piece of a parallel file names. What it names in turn is not followed.
Particles read_named_piece(const VtkXmlFile& file, const XmlElement& piece, std::string_view kind,
                           const ReadOptions& options) {
  const std::string path = path_of_named(file.source, piece.value("Source"), piece.at, options);
  FileBytes bytes(path);
  const Source source = bytes.source();
  source.need(0, kStart);
  if (!is_vtk_xml(source)) source.malformed("is named as a piece but is not VTK XML", 0);
  const VtkXmlFile inner = open_vtk_xml(source);
  if (inner.kind != kind)
    source.malformed("is named as a piece of another kind of data", inner.root.at, fmt::format("type '{}'", kind),
                     fmt::format("'{:.40}'", inner.kind));
  const XmlElement* set = inner.root.child(inner.kind);
  if (set == nullptr) source.malformed("has no data set", inner.root.at, fmt::format("<{}>", kind));
  return read_set(inner, *set, options);
}

Particles read_parallel(const VtkXmlFile& file, const XmlElement& set, const ReadOptions& options) {
  const std::vector<const XmlElement*> pieces = pieces_of(file, set);
  if (pieces.empty()) file.source.malformed("has no piece", set.at, "<Piece Source=...>");
  const std::string_view kind = std::string_view(file.kind).substr(1);
  std::set<std::string> names;
  for (const XmlElement* piece : pieces)
    if (!names.insert(std::filesystem::path(piece->value("Source")).lexically_normal().string()).second)
      file.source.malformed("names a piece twice", piece->at, {}, fmt::format("'{:.200}'", piece->value("Source")));
  Particles particles = join_pieces(pieces.size(), options, [&](std::size_t i, const ReadOptions& reading) {
    return read_named_piece(file, *pieces[i], kind, reading);
  });
  if (!particles.time) {
    VtkXmlArrays arrays(file);
    particles.time = read_time(file, set, arrays);
  }
  return particles;
}

}  // namespace

Particles read_vtk_xml(const Source& source, const ReadOptions& options) {
  const VtkXmlFile file = open_vtk_xml(source);
  const bool serial = file.kind == "PolyData" || file.kind == "UnstructuredGrid";
  const bool parallel = file.kind == "PPolyData" || file.kind == "PUnstructuredGrid";
  if (file.kind == "Collection") refuse_series(source, options);
  if (!serial && !parallel)
    source.unsupported(fmt::format("holds a data set of kind '{:.40}'", file.kind),
                       "particles are PolyData (.vtp) or UnstructuredGrid (.vtu)");
  const XmlElement* set = file.root.child(file.kind);
  if (set == nullptr) source.malformed("has no data set", file.root.at, fmt::format("<{}>", file.kind));
  Particles particles = serial ? read_set(file, *set, options) : read_parallel(file, *set, options);
  particles.format = kFormat;
  return particles;
}

}  // namespace meniscus::io
