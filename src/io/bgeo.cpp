#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "io/frame_head.h"
#include "io/index_texts.h"
#include "io/particle_rows.h"
#include "io/readers.h"

namespace meniscus::io {
namespace {

// Header: "Bgeo" "V", then nine 32-bit numbers: version, points, primitives, point groups, primitive groups,
// point attributes, vertex attributes, primitive attributes, detail attributes.
constexpr std::size_t kHeaderSize = 5 + 9 * 4;
constexpr std::size_t kWord = 4;
constexpr std::uint32_t kMostAttributes = 65536;

enum class Kind : std::uint32_t { real = 0, integer = 1, text = 2, mixed = 3, index = 4, vector = 5 };

struct PointAttribute {
  std::string name;
  std::size_t words = 0;  ///< 32-bit values a point
  Kind kind = Kind::real;
  IndexTexts texts;  ///< of an index
};

struct Header {
  std::uint64_t points = 0;
  std::uint64_t primitives = 0;
  std::vector<PointAttribute> attributes;
  std::uint64_t first_point = 0;  ///< byte offset of the first point
  std::uint64_t stride = 0;       ///< bytes a point: x, y, z, w and the attributes
  bool has_others = false;        ///< vertices, primitives or the whole have attributes

  std::uint64_t end() const { return first_point + points * stride; }
};

/// A position in the header that knows when the bytes are not enough.
struct HeaderCursor {
  const Source& source;
  std::uint64_t at;
  bool short_of_bytes = false;

  bool has(std::uint64_t size) {
    if (size <= source.bytes.size() - at) {
      source.need(at, size);
      return true;
    }
    short_of_bytes = true;
    return false;
  }
  std::uint32_t number_32() {
    if (!has(4)) return 0;
    at += 4;
    return big_endian_32(source.bytes.data() + at - 4);
  }
  std::uint16_t number_16() {
    if (!has(2)) return 0;
    at += 2;
    return big_endian_16(source.bytes.data() + at - 2);
  }
  std::string text() {
    const std::uint16_t size = number_16();
    if (short_of_bytes || !has(size)) return {};
    at += size;
    return std::string(source.bytes.data() + at - size, size);
  }
  void skip(std::uint64_t size) {
    if (has(size)) at += size;
  }
};

/// The header and the point attributes' descriptions; none if the bytes end inside them.
std::optional<Header> header_of(const Source& source) {
  if (source.bytes.size() < kHeaderSize) return std::nullopt;
  HeaderCursor cursor{source, 5};
  if (const std::uint32_t version = cursor.number_32(); version != 5) {
    source.unsupported(fmt::format("is BGEO of version {}; only version 5 is read", version),
                       "export it as classic BGEO version 5");
  }
  Header header;
  header.points = cursor.number_32();
  header.primitives = cursor.number_32();
  cursor.skip(2 * kWord);  // numbers of groups
  const std::uint32_t attribute_count = cursor.number_32();
  for (int i = 0; i < 3; ++i) header.has_others |= cursor.number_32() > 0;

  if (attribute_count > kMostAttributes)
    source.malformed("has an impossible number of point attributes", 25, fmt::format("at most {}", kMostAttributes),
                     fmt::format("{}", attribute_count));

  // Each description: name, number of values, type; then a default value each, or the table of strings.
  header.stride = 4 * kWord;
  for (std::uint32_t i = 0; i < attribute_count; ++i) {
    PointAttribute attribute;
    const std::uint64_t start = cursor.at;
    attribute.name = cursor.text();
    attribute.words = cursor.number_16();
    attribute.kind = static_cast<Kind>(cursor.number_32());
    if (cursor.short_of_bytes) return std::nullopt;
    switch (attribute.kind) {
      case Kind::real:
      case Kind::integer:
      case Kind::vector:
        cursor.skip(attribute.words * kWord);
        break;
      case Kind::index: {
        const std::uint32_t strings = cursor.number_32();
        for (std::uint32_t s = 0; s < strings && !cursor.short_of_bytes; ++s) attribute.texts.add(cursor.text());
        break;
      }
      case Kind::text:
      case Kind::mixed:
      default:
        source.malformed(fmt::format("point attribute '{}' is of an unknown type", attribute.name), start,
                         "0, 1, 4 or 5", fmt::format("{}", static_cast<std::uint32_t>(attribute.kind)));
    }
    if (cursor.short_of_bytes) return std::nullopt;
    header.stride += attribute.words * kWord;
    header.attributes.push_back(std::move(attribute));
  }
  header.first_point = cursor.at;
  return header;
}

/// Throws if a further point follows: four numbers of which the last is 1. Nothing else that may follow where only
/// points have attributes begins like this.
void check_end(const Source& source, const Header& header) {
  const std::uint64_t end = header.end();
  if (header.has_others || source.bytes.size() - end < std::max<std::uint64_t>(header.stride, 4 * kWord)) return;
  source.need(end, 4 * kWord);
  const char* fourth = source.bytes.data() + end + 3 * kWord;
  if (read_value(Scalar::float32, std::endian::big, fourth) != 1) return;
  source.malformed("there are more points than its header says", end, fmt::format("{} points", header.points));
}

Particles points_of(const Source& source, const Header& header, const ReadOptions& options) {
  source.require(header.first_point, header.points, header.stride, "points");
  check_end(source, header);
  const auto count = static_cast<std::size_t>(header.points);
  const auto stride = static_cast<std::size_t>(header.stride);
  const Stored first = source.stored(static_cast<std::size_t>(header.first_point));
  Particles particles;
  particles.format = "bgeo";
  std::size_t word = 4;  // the fourth is the homogeneous w, 1
  std::vector<RowValue> values;
  for (const PointAttribute& description : header.attributes) {
    const bool is_index = description.kind == Kind::index;
    const Scalar type = is_index || description.kind == Kind::integer ? Scalar::int32 : Scalar::float32;
    if (description.words > 0) values.push_back({description.name, type, word * kWord, description.words});
    if (is_index) particles.notes.push_back(description.texts.note(description.name));
    word += description.words;
  }
  set_rows(first, stride, count, std::endian::big, values, options, particles);
  note_primitives(header.primitives, particles);
  return particles;
}

[[noreturn]] void short_header(const Source& source) {
  source.malformed("the file ends inside its header", source.bytes.size());
}

}  // namespace

void look_at_bgeo(const Source& start, FrameHead& head) {
  const std::optional<Header> header = header_of(start);
  if (!header) short_header(start);
  if (header->points > (head.plain_bytes - std::min(head.plain_bytes, header->first_point)) / header->stride)
    start.malformed("the file is shorter than its points", header->first_point);
  head.format = "bgeo";
  head.particles = header->points;
  head.counted = true;
  std::size_t values = 3;
  for (const PointAttribute& attribute : header->attributes) values += attribute.words;
  head.values = static_cast<double>(values);
}

Particles read_bgeo(const Source& source, const ReadOptions& options) {
  const std::optional<Header> header = header_of(source);
  if (!header) short_header(source);
  return points_of(source, *header, options);
}

Particles read_bgeo(const std::string& path, Gunzip& stream, const ReadOptions& options) {
  // Decompress until the header is whole, then as much as its points take.
  std::uint64_t size = 1 << 12;
  std::optional<Header> header;
  while (true) {
    stream.grow_to(size);
    header = header_of(Source{path, stream.bytes()});
    if (header || stream.ended()) break;
    size = 2 * stream.bytes().size();
  }
  if (!header) short_header(Source{path, stream.bytes()});
  stream.grow_to(header->end() + header->stride);  // and a further one, if there is one
  const Source source{path, stream.bytes()};
  source.require(header->first_point, header->points, header->stride, "points");
  stream.check_rest();
  return points_of(source, *header, options);
}

}  // namespace meniscus::io
