// Houdini's classic geometry as text. [GPD.txt, "Documentation on the Public Domain Geometry Library, version 5"]
#include <fmt/format.h>

#include <algorithm>

#include "io/frame_head.h"
#include "io/index_texts.h"
#include "io/positions.h"
#include "io/readers.h"
#include "io/text.h"
#include "io/unwritten.h"

namespace meniscus::io {
namespace {

constexpr std::uint64_t kMostAttributes = 65536;
constexpr std::uint64_t kMostComponents = 65535;
constexpr std::string_view kMark = "\xef\xbb\xbf";

/// A position in the text that moves over words and brackets, which need no blanks around them.
class GeoCursor {
 public:
  explicit GeoCursor(const Source& source) : source_(source), at_(source.starts_with(kMark) ? kMark.size() : 0) {}
  std::size_t at() const { return at_; }

  /// The next word or bracket; "ends" for the message if there is none.
  std::string_view word(std::string_view what) {
    skip_blanks();
    const std::size_t start = at_;
    if (start == source_.bytes.size()) source_.malformed(fmt::format("the file ends inside its {}", what), start);
    if (is_bracket(source_.bytes[at_])) {
      ++at_;
    } else {
      while (at_ < source_.bytes.size() && !is_blank(source_.bytes[at_]) && !is_bracket(source_.bytes[at_])) ++at_;
    }
    return {source_.bytes.data() + start, at_ - start};
  }
  void expect(std::string_view wanted, std::string_view what) {
    if (const std::string_view found = word(what); found != wanted) fail(what, wanted, found);
  }
  std::uint64_t count(std::string_view what, std::uint64_t most) {
    const std::string_view found = word(what);
    std::uint64_t value = 0;
    if (!parse_count(found, value) || value > most) fail(what, fmt::format("0 to {}", most), found);
    return value;
  }
  double number(std::string_view what) {
    const std::string_view found = word(what);
    double value = 0;
    if (!parse_number(found, value)) fail(what, "a number", found);
    return value;
  }
  /// Throws if the next word is a number.
  void expect_no_number(std::string_view what) {
    skip_blanks();
    double value = 0;
    if (at_ == source_.bytes.size()) return;
    if (const std::string_view found = word(what); parse_number(found, value)) fail(what, "the end of them", found);
  }
  /// A word, or a text between quotes.
  std::string text(std::string_view what) {
    skip_blanks();
    if (at_ == source_.bytes.size() || source_.bytes[at_] != '"') return std::string(word(what));
    std::string result;
    const std::size_t start = at_++;
    for (; at_ < source_.bytes.size() && source_.bytes[at_] != '"'; ++at_) {
      if (source_.bytes[at_] == '\\' && at_ + 1 < source_.bytes.size()) ++at_;
      result += source_.bytes[at_];
    }
    if (at_ == source_.bytes.size()) source_.malformed(fmt::format("the file ends inside its {}", what), start);
    ++at_;
    return result;
  }
  [[noreturn]] void fail(std::string_view what, std::string_view expected, std::string_view found) const {
    source_.malformed(fmt::format("there is something wrong in the {}", what), at_ - found.size(),
                      std::string(expected), fmt::format("'{}'", found.substr(0, 24)));
  }

 private:
  static bool is_bracket(char c) { return c == '(' || c == ')'; }
  void skip_blanks() {
    while (at_ < source_.bytes.size() && is_blank(source_.bytes[at_])) ++at_;
  }
  const Source& source_;
  std::size_t at_;
};

struct GeoAttribute {
  std::string name;
  std::size_t components = 0;
  bool is_index = false;
  IndexTexts texts;
};

struct GeoHeader {
  std::uint64_t points = 0;
  std::uint64_t primitives = 0;
  std::vector<GeoAttribute> attributes;
  std::uint64_t values = 0;  ///< of all attributes of a point
  std::uint64_t first_point = 0;

  /// Bytes that a point takes at least: "0 0 0 1" and a blank, or "0 0 0 1(0 0)" with its values.
  std::uint64_t least_bytes() const { return 8 + 2 * values; }
};

GeoAttribute attribute_at(GeoCursor& text) {
  constexpr std::string_view kWhat = "attributes";
  GeoAttribute attribute;
  attribute.name = text.text(kWhat);
  attribute.components = static_cast<std::size_t>(text.count(kWhat, kMostComponents));
  const std::string_view type = text.word(kWhat);
  attribute.is_index = type == "index";
  if (attribute.is_index) {
    const std::uint64_t texts = text.count(kWhat, ~std::uint64_t{0});
    for (std::uint64_t i = 0; i < texts; ++i) attribute.texts.add(text.text(kWhat));
  } else if (type == "float" || type == "int" || type == "vector") {
    for (std::size_t i = 0; i < attribute.components; ++i) text.number(kWhat);  // defaults
  } else {
    text.fail(kWhat, "float, int, vector or index", type);
  }
  return attribute;
}

GeoHeader header_at(const Source& source, GeoCursor& text) {
  constexpr std::string_view kWhat = "header";
  constexpr std::uint64_t kMost = ~std::uint64_t{0} >> 8;
  text.expect("PGEOMETRY", kWhat);
  if (const std::string_view version = text.word(kWhat); version != "V5")
    source.unsupported(fmt::format("is Houdini geometry of version '{:.8}'; only V5 is read", version),
                       "export it as classic BGEO version 5");
  GeoHeader header;
  std::uint64_t attributes = 0;
  for (const std::string_view name : {"NPoints", "NPrims", "NPointGroups", "NPrimGroups", "NPointAttrib",
                                      "NVertexAttrib", "NPrimAttrib", "NAttrib"}) {
    text.expect(name, kWhat);
    const std::uint64_t count = text.count(kWhat, name == "NPointAttrib" ? kMostAttributes : kMost);
    if (name == "NPoints") header.points = count;
    if (name == "NPrims") header.primitives = count;
    if (name == "NPointAttrib") attributes = count;
  }
  if (attributes > 0) text.expect("PointAttrib", kWhat);
  for (std::uint64_t i = 0; i < attributes; ++i) {
    header.attributes.push_back(attribute_at(text));
    header.values += header.attributes.back().components;
  }
  header.first_point = text.at();
  return header;
}

}  // namespace

void look_at_geo(const Source& start, FrameHead& head) {
  GeoCursor text(start);
  const GeoHeader header = header_at(start, text);
  if (header.points > head.plain_bytes / header.least_bytes())
    start.malformed("the file is shorter than its points", header.first_point);
  head.format = "geo";
  head.text = true;
  head.particles = header.points;
  head.counted = true;
  head.values = static_cast<double>(3 + header.values);
}

Particles read_geo(const Source& source, const ReadOptions& options) {
  GeoCursor text(source);
  const GeoHeader header = header_at(source, text);
  // The last one needs no end of its line.
  source.require(header.first_point + (header.points > 0 ? 1 : 0), header.points, header.least_bytes() - 1, "points");
  Particles particles;
  particles.format = "geo";
  const auto count = static_cast<std::size_t>(header.points);
  for (const GeoAttribute& described : header.attributes) {
    if (described.is_index) particles.notes.push_back(described.texts.note(described.name));
    if (described.components == 0) continue;
    Attribute& attribute = particles.attributes.emplace_back();
    attribute.name = described.name;
    attribute.components = static_cast<int>(described.components);
    resize_unwritten(attribute.values, count * described.components);
  }
  std::vector<double> positions(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) positions[3 * i + axis] = text.number("points");
    text.number("points");  // the homogeneous w, 1
    if (header.attributes.empty()) continue;
    text.expect("(", "points");
    for (Attribute& attribute : particles.attributes) {
      const auto components = static_cast<std::size_t>(attribute.components);
      for (std::size_t c = 0; c < components; ++c)
        attribute.values[i * components + c] = static_cast<float>(text.number("points"));
    }
    text.expect(")", "points");
  }
  text.expect_no_number("points");  // of a further point
  set_positions(positions, options, particles);
  note_primitives(header.primitives, particles);
  return particles;
}

}  // namespace meniscus::io
