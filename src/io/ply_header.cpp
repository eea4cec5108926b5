#include "io/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr std::array<std::pair<std::string_view, Scalar>, 16> kTypes{{{"char", Scalar::int8},
                                                                      {"int8", Scalar::int8},
                                                                      {"uchar", Scalar::uint8},
                                                                      {"uint8", Scalar::uint8},
                                                                      {"short", Scalar::int16},
                                                                      {"int16", Scalar::int16},
                                                                      {"ushort", Scalar::uint16},
                                                                      {"uint16", Scalar::uint16},
                                                                      {"int", Scalar::int32},
                                                                      {"int32", Scalar::int32},
                                                                      {"uint", Scalar::uint32},
                                                                      {"uint32", Scalar::uint32},
                                                                      {"float", Scalar::float32},
                                                                      {"float32", Scalar::float32},
                                                                      {"double", Scalar::float64},
                                                                      {"float64", Scalar::float64}}};

class HeaderReader {
 public:
  explicit HeaderReader(const Source& source) : source_(source), text_(source) {}

  PlyHeader read() {
    text_.line();  // "ply"
    while (true) {
      if (text_.at_end()) source_.malformed("the file ends inside its header", source_.bytes.size(), "end_header");
      start_ = text_.at();
      const std::vector<std::string_view> words = words_of(text_.line());
      if (words.empty() || words[0] == "obj_info") continue;
      if (words[0] == "comment") {
        if (words.size() == 3) read_comment(words[1], words[2]);
        continue;
      }
      if (words[0] == "end_header") break;
      if (words[0] == "format") {
        read_format(words);
      } else if (words[0] == "element") {
        read_element(words);
      } else if (words[0] == "property") {
        read_property(words);
      } else {
        fail("the header has an unknown line", words[0]);
      }
    }
    if (!has_format_) source_.malformed("the header has no format line", text_.at());
    header_.end = text_.at();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(std::string problem, std::string_view found) const {
    source_.malformed(std::move(problem), start_, {}, fmt::format("'{}'", found.substr(0, 40)));
  }

  /// What the particles are, in comments of two words; any other comment is for people.
  void read_comment(std::string_view name, std::string_view value) {
    double time = 0;
    float spacing = 0;
    if (name == "up") {
      for (const Axis axis : {Axis::x, Axis::y, Axis::z})
        if (value == name_of(axis)) header_.up = axis;
    } else if (name == "time" && parse_number(value, time) && std::isfinite(time)) {
      header_.time = time;
    } else if (name == "spacing" && parse_number(value, spacing) && spacing > 0 && std::isfinite(spacing)) {
      header_.spacing = spacing;
    }
  }

  void read_format(const std::vector<std::string_view>& words) {
    if (words.size() < 2) fail("the format line names no format", "format");
    has_format_ = true;
    if (words[1] == "ascii") {
      header_.ascii = true;
    } else if (words[1] == "binary_big_endian") {
      header_.order = std::endian::big;
    } else if (words[1] != "binary_little_endian") {
      fail("the format is unknown", words[1]);
    }
  }

  void read_element(const std::vector<std::string_view>& words) {
    PlyElement element;
    if (words.size() != 3 || !parse_count(words[2], element.count)) fail("an element has no count", words.back());
    element.name = std::string(words[1]);
    header_.elements.push_back(std::move(element));
  }

  void read_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail("a property stands before any element", words.back());
    PlyProperty property;
    if (words.size() == 5 && words[1] == "list") {
      property.list_count_type = type_of(words[2]);
      property.type = type_of(words[3]);
    } else if (words.size() == 3) {
      property.type = type_of(words[1]);
    } else {
      fail("a property line is neither a value nor a list", words.back());
    }
    property.name = std::string(words.back());
    header_.elements.back().properties.push_back(std::move(property));
  }

  Scalar type_of(std::string_view name) const {
    for (const auto& [known, type] : kTypes) {
      if (name == known) return type;
    }
    fail("a property's type is unknown", name);
  }

  Source source_;
  TextCursor text_;
  std::size_t start_ = 0;
  bool has_format_ = false;
  PlyHeader header_;
};

}  // namespace

bool PlyElement::has_list() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& property) { return property.list_count_type.has_value(); });
}

std::size_t PlyElement::row_size() const {
  std::size_t size = 0;
  for (const PlyProperty& property : properties) size += size_of(property.list_count_type.value_or(property.type));
  return size;
}

PlyHeader read_ply_header(const Source& source) { return HeaderReader(source).read(); }

}  // namespace meniscus::io
