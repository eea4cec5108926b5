#include "io/npy_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace meniscus::io {
namespace {

constexpr std::size_t kMagic = 8;                            ///< bytes of magic and version
constexpr std::size_t kMostHeader = std::size_t{1} << 16;    ///< NumPy refuses more than 10,000 itself
constexpr std::uint64_t kMostItem = std::uint64_t{1} << 30;  ///< bytes an element
constexpr int kMostDepth = 16;

/// A Python literal of the kinds that headers are written in.
struct Literal {
  enum class Kind { text, number, flag, list, dictionary };
  Kind kind = Kind::text;
  std::string text;
  std::uint64_t number = 0;    ///< of a flag: 1 for True
  std::vector<Literal> items;  ///< of a dictionary: key, value, key, value ...
};

class LiteralReader {
 public:
  LiteralReader(const Source& source, std::size_t at, std::size_t end) : source_(source), at_(at), end_(end) {}

  Literal read(int depth = 0) {
    if (depth > kMostDepth) fail("a header nested less deeply");
    const char c = next();
    if (c == '\'' || c == '"') return text(c);
    if (c == '(') return list(')', Literal::Kind::list, depth);
    if (c == '[') return list(']', Literal::Kind::list, depth);
    if (c == '{') return list('}', Literal::Kind::dictionary, depth);
    if (c >= '0' && c <= '9') return number();
    if (takes("True")) return {Literal::Kind::flag, {}, 1, {}};
    if (takes("False")) return {Literal::Kind::flag, {}, 0, {}};
    fail("a text, a number, True, False, a tuple, a list or a dictionary");
  }

 private:
  [[noreturn]] void fail(std::string expected) const {
    const std::string_view rest(source_.bytes.data() + at_, std::min<std::size_t>(end_ - at_, 12));
    std::string shown;
    for (const char c : rest) shown += c >= ' ' && c <= '~' ? c : '?';
    source_.malformed("the NumPy header is damaged", at_, std::move(expected), "'" + shown + "'");
  }
  /// The next character that is no blank; zero at the end.
  char next() {
    while (at_ < end_ && (source_.bytes[at_] == ' ' || source_.bytes[at_] == '\n')) ++at_;
    return at_ < end_ ? source_.bytes[at_] : '\0';
  }
  bool takes(std::string_view word) {
    if (!std::string_view(source_.bytes.data() + at_, end_ - at_).starts_with(word)) return false;
    at_ += word.size();
    return true;
  }
  Literal text(char quote) {
    Literal result;
    for (++at_; at_ < end_ && source_.bytes[at_] != quote; ++at_) {
      if (source_.bytes[at_] == '\\' && at_ + 1 < end_) ++at_;
      result.text += source_.bytes[at_];
    }
    if (at_ >= end_) fail("the end of a text");
    ++at_;
    return result;
  }
  Literal number() {
    Literal result{Literal::Kind::number, {}, 0, {}};
    const char* first = source_.bytes.data() + at_;
    const auto [end, error] = std::from_chars(first, source_.bytes.data() + end_, result.number);
    if (error != std::errc()) fail("a whole number below 2^64");
    at_ += static_cast<std::size_t>(end - first);
    takes("L");  // as Python 2 wrote
    return result;
  }
  Literal list(char closing, Literal::Kind kind, int depth) {
    Literal result{kind, {}, 0, {}};
    ++at_;
    while (next() != closing) {
      result.items.push_back(read(depth + 1));
      if (kind == Literal::Kind::dictionary) {
        if (next() != ':') fail("':'");
        ++at_;
        result.items.push_back(read(depth + 1));
      }
      if (next() == ',') {
        ++at_;
      } else if (next() != closing) {
        fail(fmt::format("',' or '{}'", closing));
      }
    }
    ++at_;
    return result;
  }

  const Source& source_;
  std::size_t at_, end_;
};

std::optional<Scalar> scalar_of(char kind, std::uint64_t size) {
  if (kind == 'b' && size == 1) return Scalar::uint8;
  if (kind == 'f')
    return size == 4 ? std::optional(Scalar::float32) : size == 8 ? std::optional(Scalar::float64) : std::nullopt;
  if (kind != 'i' && kind != 'u') return std::nullopt;
  const bool is_signed = kind == 'i';
  switch (size) {
    case 1:
      return is_signed ? Scalar::int8 : Scalar::uint8;
    case 2:
      return is_signed ? Scalar::int16 : Scalar::uint16;
    case 4:
      return is_signed ? Scalar::int32 : Scalar::uint32;
    case 8:
      return is_signed ? Scalar::int64 : Scalar::uint64;
    default:
      return std::nullopt;
  }
}

class HeaderReader {
 public:
  HeaderReader(const Source& source, std::size_t first) : source_(source) { header_.first = first; }

  NpyHeader read(const Literal& literal) {
    const Literal* descr = entry(literal, "descr");
    const Literal* fortran = entry(literal, "fortran_order");
    const Literal* shape = entry(literal, "shape");
    if (descr == nullptr || fortran == nullptr || fortran->kind != Literal::Kind::flag || shape == nullptr)
      fail("lacks what describes the array", "descr, fortran_order and shape");
    header_.fortran = fortran->number == 1;
    header_.shape = lengths(*shape);
    // The number of elements, unless it is beyond counting.
    const bool empty = std::count(header_.shape.begin(), header_.shape.end(), 0u) > 0;
    for (const std::uint64_t length : header_.shape) {
      if (empty) {
        header_.items = 0;
      } else if (header_.items > ~std::uint64_t{0} / length) {
        fail("claims more values than can be counted", {});
      } else {
        header_.items *= length;
      }
    }
    if (descr->kind == Literal::Kind::text) {
      NpyField field = field_of({}, *descr, 0);
      header_.item_size = field.size;
      header_.fields.push_back(std::move(field));
    } else {
      header_.item_size = static_cast<std::size_t>(read_fields(*descr, &header_.fields, 0));
    }
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(std::string problem, std::string expected) const {
    source_.malformed("the NumPy header " + problem, kMagic, std::move(expected));
  }
  static const Literal* entry(const Literal& dictionary, std::string_view key) {
    if (dictionary.kind != Literal::Kind::dictionary) return nullptr;
    for (std::size_t i = 0; i + 1 < dictionary.items.size(); i += 2)
      if (dictionary.items[i].text == key) return &dictionary.items[i + 1];
    return nullptr;
  }
  std::vector<std::uint64_t> lengths(const Literal& tuple) const {
    std::vector<std::uint64_t> result;
    if (tuple.kind == Literal::Kind::number) return {tuple.number};
    if (tuple.kind != Literal::Kind::list || tuple.items.size() > 32) fail("has no shape", "at most 32 lengths");
    for (const Literal& item : tuple.items) {
      if (item.kind != Literal::Kind::number) fail("has no shape", "lengths");
      result.push_back(item.number);
    }
    return result;
  }
  /// Of a type that is written as "<f4".
  NpyField field_of(std::string name, const Literal& type, std::size_t offset) const {
    NpyField field;
    field.name = std::move(name);
    field.type_name = type.text;
    field.offset = offset;
    std::string_view text = type.text;
    if (!text.empty() && (text[0] == '<' || text[0] == '>' || text[0] == '|' || text[0] == '=')) {
      if (text[0] == '>') field.order = std::endian::big;
      text.remove_prefix(1);
    }
    if (text.empty()) fail("names no type", "'<f4' and the like");
    const char kind = text[0];
    text = text.substr(1, text.find('[') - 1);  // without the unit of times
    std::uint64_t size = kind == 'O' && text.empty() ? 8 : 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
    const bool digits = error == std::errc() && end == text.data() + text.size();
    if ((!digits && !(kind == 'O' && text.empty())) || size > kMostItem)
      fail(fmt::format("names the type '{}'", type.text.substr(0, 20)), "'<f4' and the like");
    if (kind == 'U') size *= 4;
    field.size = static_cast<std::size_t>(size);
    field.object = kind == 'O';
    field.half = kind == 'f' && size == 2;
    field.type = scalar_of(kind, size);
    return field;
  }
  /// The fields of a structured type; their names come to `fields` unless it is null. Returns the bytes of all.
  std::uint64_t read_fields(const Literal& list, std::vector<NpyField>* fields, int depth) const {
    if (list.kind != Literal::Kind::list) fail("describes no type", "a text or a list of fields");
    std::uint64_t size = 0;
    for (const Literal& item : list.items) {
      if (item.kind != Literal::Kind::list || item.items.size() < 2 || item.items.size() > 3)
        fail("describes a field of the type badly", "(name, type) or (name, type, shape)");
      // A name may be a pair: title and name.
      const Literal& name = item.items[0].kind == Literal::Kind::list && item.items[0].items.size() == 2
                                ? item.items[0].items[1]
                                : item.items[0];
      NpyField field;
      if (item.items[1].kind == Literal::Kind::text) {
        field = field_of(name.text, item.items[1], static_cast<std::size_t>(size));
      } else {
        std::vector<NpyField> inner;
        field.name = name.text;
        field.type_name = "structured";
        field.size = static_cast<std::size_t>(read_fields(item.items[1], &inner, depth + 1));
        field.object = std::any_of(inner.begin(), inner.end(), [](const NpyField& f) { return f.object; });
      }
      if (item.items.size() == 3) {
        field.shape = lengths(item.items[2]);
        std::uint64_t all = field.size;
        for (const std::uint64_t length : field.shape) {
          if (length > kMostItem || all * length > kMostItem) fail("describes elements that are too large", {});
          all *= length;
        }
        field.size = static_cast<std::size_t>(all);
      }
      size += field.size;
      if (size > kMostItem) fail("describes elements that are too large", fmt::format("at most {} bytes", kMostItem));
      if (fields != nullptr) fields->push_back(std::move(field));
    }
    return size;
  }

  const Source& source_;
  NpyHeader header_;
};

}  // namespace

bool NpyHeader::has_object() const {
  return std::any_of(fields.begin(), fields.end(), [](const NpyField& field) { return field.object; });
}

std::optional<NpyHeader> npy_header_of(const Source& source) {
  // Magic, version, length of the header in 16 or 32 bits, little-endian.
  source.need(0, kMagic + sizeof(std::uint32_t));
  if (source.bytes.size() < kMagic) return std::nullopt;
  const int version = static_cast<unsigned char>(source.bytes[6]);
  if (version < 1 || version > 3)
    source.unsupported(fmt::format("is an array of NumPy's format {}; versions 1 to 3 are read", version),
                       "save it with numpy.save()");
  const std::size_t width = version == 1 ? 2 : 4;
  const std::size_t start = kMagic + width;
  if (source.bytes.size() < start) return std::nullopt;
  const auto length = static_cast<std::uint64_t>(
      read_value(width == 2 ? Scalar::uint16 : Scalar::uint32, std::endian::little, source.bytes.data() + kMagic));
  if (length > kMostHeader)
    throw Error(
        ErrorCode::limit_exceeded,
        {"the NumPy header is too long", fmt::format("at most {} bytes", kMostHeader), fmt::format("{} bytes", length),
         source.path, kMagic, std::nullopt, "save it with numpy.save() again"});
  if (source.bytes.size() - start < length) return std::nullopt;
  source.need(start, length);
  const std::size_t end = start + static_cast<std::size_t>(length);
  return HeaderReader(source, end).read(LiteralReader(source, start, end).read());
}

}  // namespace meniscus::io
