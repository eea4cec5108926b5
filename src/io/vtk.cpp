#include <fmt/format.h>

#include <algorithm>

#include "io/readers.h"
#include "io/vtk_arrays.h"

namespace meniscus::io {
namespace {

class VtkReader {
 public:
  VtkReader(const Source& source, const ReadOptions& options)
      : source_(source), options_(options), text_(source), arrays_(read_header()) {
    particles_.format = "vtk";
  }

  Particles read() {
    while (step()) {
    }
    if (!has_points_) source_.malformed("has no points", text_.at(), "POINTS count type");
    return std::move(particles_);
  }

 private:
  /// What the arrays belong to that come next.
  enum class Part { dataset, points, cells };

  VtkArrays read_header() {
    text_.line();  // "# vtk DataFile Version 4.1"
    text_.line();  // title
    const std::size_t start = text_.at();
    const std::string form = lower(text_.word());
    if (form != "ascii" && form != "binary") {
      source_.malformed("the third line does not say how the values are written", start, "ASCII or BINARY");
    }
    text_.line();
    if (form == "ascii") source_.need_all();
    return {source_, text_, form == "binary"};
  }

  /// Reads one keyword and what belongs to it; false at the end.
  bool step() {
    const std::size_t start = text_.at();
    const std::string word = lower(text_.word());
    if (word.empty()) return false;
    if (word == "dataset") {
      read_dataset();
    } else if (word == "points") {
      read_points(start);
    } else if (word == "dimensions" || word == "spacing" || word == "origin") {
      text_.line();
    } else if (word == "vertices" || word == "lines" || word == "polygons" || word == "triangle_strips" ||
               word == "cells") {
      skip_cells();
    } else if (word == "cell_types") {
      const std::uint64_t count = text_.count("cell types");
      arrays_.begin();
      arrays_.skip({VtkType::Kind::number, Scalar::int32}, count, 1, "cell types");
    } else if (word == "point_data") {
      begin_part(Part::points, start);
    } else if (word == "cell_data") {
      begin_part(Part::cells, start);
    } else if (word == "metadata") {
      skip_metadata();
    } else if (word == "field") {
      read_field();
    } else if (!read_attribute(word)) {
      return stop_at_unknown(word, start);
    }
    return true;
  }

  void read_dataset() {
    const std::string kind = lower(text_.word());
    if (kind != "polydata" && kind != "unstructured_grid" && kind != "structured_grid") {
      source_.unsupported(fmt::format("holds a data set of kind '{}'", kind.substr(0, 40)),
                          "particles are POLYDATA or UNSTRUCTURED_GRID");
    }
    text_.line();
  }

  void read_points(std::size_t start) {
    if (has_points_) source_.malformed("has a second list of points", start);
    const std::uint64_t count = text_.count("points");
    const VtkType type = arrays_.type_of(text_.word());
    arrays_.begin();
    arrays_.read_points(type, count, options_, particles_);
    has_points_ = true;
    points_end_ = text_.at();
  }

  /// "CELLS cells integers" and that many 32-bit integers; since version 5 "CELLS offsets connections" and two
  /// arrays with types of their own.
  void skip_cells() {
    const std::uint64_t first = text_.count("cells");
    const std::uint64_t second = text_.count("cells");
    arrays_.begin();
    if (lower(text_.peek()) != "offsets") {
      arrays_.skip({VtkType::Kind::number, Scalar::int32}, second, 1, "cells");
      return;
    }
    skip_typed(first, "cell offsets");
    if (lower(text_.peek()) != "connectivity") {
      source_.malformed("the cells have no connectivity", text_.at(), "CONNECTIVITY type");
    }
    skip_typed(second, "cell connectivity");
  }

  /// "KEYWORD type" and `count` values.
  void skip_typed(std::uint64_t count, std::string_view what) {
    text_.word();
    const VtkType type = arrays_.type_of(text_.word());
    arrays_.begin();
    arrays_.skip(type, count, 1, what);
  }

  void begin_part(Part part, std::size_t start) {
    part_ = part;
    tuples_ = text_.count(part == Part::points ? "point data" : "cell data");
    if (part == Part::points && has_points_ && tuples_ != particles_.size()) {
      source_.malformed("the point data are not as many as the points", start, fmt::format("{}", particles_.size()),
                        fmt::format("{}", tuples_));
    }
    text_.line();
  }

  /// METADATA ends with an empty line.
  void skip_metadata() {
    text_.line();
    while (!text_.at_end() && !words_of(text_.line()).empty()) {
    }
  }

  void read_field() {
    text_.word();  // the field's name
    const std::uint64_t count = text_.count("field");
    for (std::uint64_t i = 0; i < count; ++i) {
      while (lower(text_.peek()) == "metadata") skip_metadata();
      const std::string name = vtk_name(text_.word());
      // An empty array is written as "NULL_ARRAY", without anything else.
      if (name == "NULL_ARRAY") continue;
      const std::uint64_t components = text_.count("field");
      const std::uint64_t tuples = text_.count("field");
      const VtkType type = arrays_.type_of(text_.word());
      arrays_.begin();
      if (part_ == Part::dataset) {
        read_time(name, type, tuples, components);
      } else {
        read_array(name, type, tuples, components);
      }
    }
  }

  /// A field of the whole data set: of interest only where it is the time.
  void read_time(const std::string& name, VtkType type, std::uint64_t tuples, std::uint64_t components) {
    const std::string plain = lower(name);
    const bool is_time = plain == "time" || plain == "timevalue";
    if (!is_time || tuples != 1 || components != 1 || type.kind != VtkType::Kind::number) {
      arrays_.skip(type, tuples, components, "field");
      return;
    }
    if (arrays_.binary()) {
      source_.require(text_.at(), 1, size_of(type.scalar), "field");
      source_.need(text_.at(), size_of(type.scalar));
      particles_.time = read_value(type.scalar, std::endian::big, source_.bytes.data() + text_.at());
      text_.seek(text_.at() + size_of(type.scalar));
    } else {
      double time = 0;
      if (parse_number(text_.word(), time)) particles_.time = time;
    }
  }

  /// Keeps an array of the points, moves over any other.
  void read_array(const std::string& name, VtkType type, std::uint64_t tuples, std::uint64_t components) {
    if (part_ != Part::points || !has_points_ || tuples != particles_.size() || components == 0 ||
        type.kind != VtkType::Kind::number) {
      arrays_.skip(type, tuples, components, name);
      if (part_ != Part::points) return;
      particles_.notes.push_back(
          type.kind == VtkType::Kind::number
              ? fmt::format("array '{}' has {} values for {} points and was left out", name, tuples, particles_.size())
              : fmt::format("array '{}' holds no numbers and was left out", name));
      return;
    }
    std::vector<float> values = arrays_.read(type, tuples, components, name);
    particles_.attributes.push_back({name, static_cast<int>(components), std::move(values)});
  }

  /// SCALARS, VECTORS ...: "KEYWORD name type". False for a keyword that is none of them.
  bool read_attribute(const std::string& word) {
    if (word == "lookup_table") {
      text_.word();
      const std::uint64_t colours = text_.count("lookup table");
      arrays_.begin();
      arrays_.skip({VtkType::Kind::number, Scalar::uint8}, colours, 4, "lookup table");
      return true;
    }
    if (word == "color_scalars") {
      const std::string name = vtk_name(text_.word());
      const std::uint64_t components = text_.count("colours");
      arrays_.begin();
      read_array(name, {VtkType::Kind::number, Scalar::uint8}, tuples_, components);
      return true;
    }
    std::uint64_t components = 0;
    if (word == "vectors" || word == "normals") components = 3;
    if (word == "tensors") components = 9;
    if (word == "tensors6") components = 6;
    if (word == "global_ids" || word == "pedigree_ids" || word == "edge_flags") components = 1;
    const bool scalars = word == "scalars", texture = word == "texture_coordinates";
    if (components == 0 && !scalars && !texture) return false;

    const std::string name = vtk_name(text_.word());
    if (texture) components = text_.count("texture coordinates");
    const VtkType type = arrays_.type_of(text_.word());
    if (scalars) {
      // The number of components may be missing, and so may the line that names a table.
      const std::vector<std::string_view> rest = words_of(text_.line());
      if (rest.empty() || !parse_count(rest[0], components)) components = 1;
      if (lower(text_.peek()) == "lookup_table") {
        text_.word();
        text_.line();
      }
    } else {
      arrays_.begin();
    }
    read_array(name, type, tuples_, components);
    return true;
  }

  /// Behind the points an unknown word ends the reading with a note; before them it is an error, and so is, next to
  /// them, what is no word: numbers of further points.
  bool stop_at_unknown(const std::string& word, std::size_t start) {
    std::string shown = word.substr(0, 24);
    for (char& c : shown) {
      if (c < ' ' || c > '~') c = '?';
    }
    if (!has_points_) source_.malformed("has an unknown keyword", start, "POINTS", "'" + shown + "'");
    const auto is_of_word = [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; };
    if (start == points_end_ && !std::all_of(word.begin(), word.end(), is_of_word))
      source_.malformed("has more points than it says", start, "a keyword or the end", "'" + shown + "'");
    particles_.notes.push_back(fmt::format("reading stopped at byte {}, at the unknown word '{}'", start, shown));
    return false;
  }

  Source source_;
  const ReadOptions& options_;
  TextCursor text_;
  VtkArrays arrays_;
  Particles particles_;
  bool has_points_ = false;
  std::size_t points_end_ = 0;  ///< byte offset
  Part part_ = Part::dataset;
  std::uint64_t tuples_ = 0;
};

}  // namespace

Particles read_vtk(const Source& source, const ReadOptions& options) { return VtkReader(source, options).read(); }

}  // namespace meniscus::io
