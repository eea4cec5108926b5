#include "io/houdini_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "io/half.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

// [UT_JSONDefines.h of Houdini's development kit describes the encoding.]
constexpr std::string_view kLittle = "\x7fNSJb", kBig(
                                                     "\x7f"
                                                     "bJSN");
constexpr std::string_view kMark = "\xef\xbb\xbf";
constexpr std::size_t kMostTokens = 65536;

enum : unsigned char {
  kNull = 0x00,
  kBool = 0x10,
  kReal16 = 0x18,
  kTokenRef = 0x26,
  kString = 0x27,
  kTokenDef = 0x2b,
  kTokenUndef = 0x2d,
  kFalse = 0x30,
  kTrue = 0x31,
  kUniform = 0x40,
};

/// Types of numbers by their mark; none for others.
std::optional<Scalar> scalar_of(unsigned char mark) {
  constexpr std::array<std::pair<unsigned char, Scalar>, 9> kTypes{{{0x11, Scalar::int8},
                                                                    {0x12, Scalar::int16},
                                                                    {0x13, Scalar::int32},
                                                                    {0x14, Scalar::int64},
                                                                    {kReal16, Scalar::uint16},
                                                                    {0x19, Scalar::float32},
                                                                    {0x1a, Scalar::float64},
                                                                    {0x21, Scalar::uint8},
                                                                    {0x22, Scalar::uint16}}};
  for (const auto& [known, type] : kTypes)
    if (mark == known) return type;
  return std::nullopt;
}

/// A code point as UTF-8. Halves of pairs come out as what is no UTF-8 and is made readable later.
void append_utf8(unsigned code, std::string& text) {
  if (code < 0x80) {
    text += static_cast<char>(code);
    return;
  }
  if (code < 0x800) {
    text += static_cast<char>(0xc0 | code >> 6);
  } else {
    text += static_cast<char>(0xe0 | code >> 12);
    text += static_cast<char>(0x80 | (code >> 6 & 0x3f));
  }
  text += static_cast<char>(0x80 | (code & 0x3f));
}

bool ends_a_word(char c) {
  return is_blank(c) || c == ',' || c == ':' || c == '[' || c == ']' || c == '{' || c == '}' || c == '"';
}

}  // namespace

bool is_houdini_json(const Source& start) {
  if (start.starts_with(kLittle) || start.starts_with(kBig)) return true;
  std::string_view text(start.bytes.data(), std::min<std::size_t>(start.bytes.size(), 1 << 12));
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  const auto first = std::find_if(text.begin(), text.end(), [](char c) { return !is_blank(c); });
  return first != text.end() && (*first == '[' || *first == '{') &&
         (text.find("\"fileversion\"") != std::string_view::npos ||
          text.find("\"pointcount\"") != std::string_view::npos);
}

HoudiniJson::HoudiniJson(const Source& source) : source_(source) {
  binary_ = source.starts_with(kLittle) || source.starts_with(kBig);
  if (source.starts_with(kBig)) order_ = std::endian::big;
  if (binary_) at_ = kLittle.size();
  if (source.starts_with(kMark)) at_ = kMark.size();
}

void HoudiniJson::malformed(std::string problem, std::size_t at, std::string expected, std::string found) const {
  source_.malformed(std::move(problem), at, std::move(expected), std::move(found));
}

void HoudiniJson::seek(const Place& place) {
  at_ = place.at;
  open_ = place.open;
  texts_ = 0;
}

HoudiniWord HoudiniJson::next() { return binary_ ? next_of_binary() : next_of_text(); }

void HoudiniJson::finish(const HoudiniWord& first) {
  if (first.kind == HoudiniWord::Kind::end) malformed("a value is missing", first.at);
  if (first.kind != HoudiniWord::Kind::begin) return;
  const std::size_t outside = open_.size() - 1;
  while (open_.size() > outside) next();
}

void HoudiniJson::for_each(FunctionRef<bool(const std::string& name)> visit) {
  const HoudiniWord first = next();
  if (first.kind != HoudiniWord::Kind::begin) malformed("names and values are missing", first.at, "a list or a map");
  while (true) {
    const HoudiniWord name = next();
    if (name.kind == HoudiniWord::Kind::end) return;
    if (name.kind != HoudiniWord::Kind::text) malformed("a name is missing", name.at, "names and values in turn");
    if (!visit(name.text)) return;
  }
}

std::uint64_t HoudiniJson::count(std::string_view what) {
  const HoudiniWord word = next();
  constexpr double kMost = 9007199254740992.0;  // 2^53: whole numbers are exact below
  const bool fits = word.kind == HoudiniWord::Kind::number && word.number >= 0 && word.number < kMost;
  const auto value = fits ? static_cast<std::uint64_t>(word.number) : 0;
  if (!fits || static_cast<double>(value) != word.number)
    malformed(fmt::format("{} is no whole number", what), word.at, "0 to 2^53",
              word.kind == HoudiniWord::Kind::number ? fmt::format("{}", word.number) : "");
  return value;
}

HoudiniWord HoudiniJson::begin(char closing, std::size_t at) {
  if (open_.size() == kDeepest) malformed("is nested too deep", at, fmt::format("{} levels", kDeepest));
  open_.push_back(closing);
  HoudiniWord word;
  word.kind = HoudiniWord::Kind::begin;
  word.at = at;
  return word;
}

HoudiniWord HoudiniJson::end(char closing, std::size_t at) {
  if (open_.empty() || open_.back() != closing)
    malformed("a bracket closes what was not opened", at, open_.empty() ? "a value" : std::string(1, open_.back()),
              std::string(1, closing));
  open_.pop_back();
  HoudiniWord word;
  word.kind = HoudiniWord::Kind::end;
  word.at = at;
  return word;
}

std::string_view HoudiniJson::bytes(std::uint64_t size, std::string_view what) {
  source_.require(at_, size, 1, what);
  const std::string_view found(source_.bytes.data() + at_, static_cast<std::size_t>(size));
  at_ += found.size();
  return found;
}

char HoudiniJson::byte(std::string_view what) { return bytes(1, what)[0]; }

// --- text ---

std::string HoudiniJson::quoted() {
  std::string text;
  for (char c = byte("texts"); c != '"'; c = byte("texts")) {
    if (c != '\\') {
      text += c;
      continue;
    }
    constexpr std::string_view kNames = "bfnrt", kMeant = "\b\f\n\r\t";
    c = byte("texts");
    if (c == 'u') {
      unsigned code = 0;
      for (const char digit : bytes(4, "texts")) {
        constexpr std::string_view kDigits = "0123456789abcdef";
        const char small = digit >= 'A' && digit <= 'F' ? static_cast<char>(digit - 'A' + 'a') : digit;
        const std::size_t value = kDigits.find(small);
        if (value == std::string_view::npos) malformed("a text has a damaged letter", at_ - 4, "four digits of 16");
        code = code << 4 | static_cast<unsigned>(value);
      }
      append_utf8(code, text);
    } else {
      const std::size_t place = kNames.find(c);
      text += place == std::string_view::npos ? c : kMeant[place];
    }
  }
  return text;
}

HoudiniWord HoudiniJson::next_of_text() {
  const auto there = [&] { return at_ < source_.bytes.size(); };
  while (there() && (is_blank(source_.bytes[at_]) || source_.bytes[at_] == ',' || source_.bytes[at_] == ':')) ++at_;
  const std::size_t start = at_;
  const char c = byte("lists");
  if (c == '[' || c == '{') return begin(c == '[' ? ']' : '}', start);
  if (c == ']' || c == '}') return end(c, start);
  HoudiniWord word;
  word.at = start;
  if (c == '"') {
    word.kind = HoudiniWord::Kind::text;
    word.text = quoted();
    return word;
  }
  while (there() && !ends_a_word(source_.bytes[at_])) ++at_;
  const std::string_view plain(source_.bytes.data() + start, at_ - start);
  if (plain == "true" || plain == "false") {
    word.kind = HoudiniWord::Kind::truth;
    word.number = plain == "true" ? 1 : 0;
  } else if (plain != "null") {
    word.kind = HoudiniWord::Kind::number;
    if (!parse_number(plain, word.number))
      malformed("is no JSON", start, "a value", fmt::format("'{}'", plain.substr(0, 40)));
  }
  return word;
}

// --- binary ---

std::uint64_t HoudiniJson::length() {
  const std::size_t start = at_;
  const auto first = static_cast<unsigned char>(byte("lengths"));
  if (first < 0xf1) return first;
  const std::size_t size = first == 0xf2 ? 2 : first == 0xf4 ? 4 : first == 0xf8 ? 8 : 0;
  if (size == 0) malformed("a length is damaged", start, "240 or less, 0xf2, 0xf4, 0xf8", fmt::format("{:#x}", first));
  std::uint64_t value = 0;
  const std::string_view digits = bytes(size, "lengths");
  for (std::size_t i = 0; i < size; ++i)
    value = value << 8 | static_cast<unsigned char>(digits[order_ == std::endian::big ? i : size - 1 - i]);
  return value;
}

void HoudiniJson::define() {
  const std::uint64_t number = length(), size = length();
  const std::string_view text = bytes(size, "texts");
  if (tokens_.size() == kMostTokens && !tokens_.contains(number))
    malformed("defines too many texts", at_, fmt::format("at most {}", kMostTokens));
  tokens_[number] = text;
}

std::string HoudiniJson::defined() {
  const std::size_t start = at_;
  const std::uint64_t number = length();
  const auto found = tokens_.find(number);
  if (found == tokens_.end()) malformed("names a text that was not defined", start, {}, fmt::format("{}", number));
  return std::string(found->second);
}

/// An array of numbers, or the begin of one of texts.
HoudiniWord HoudiniJson::uniform(std::size_t at) {
  const auto mark = static_cast<unsigned char>(byte("arrays"));
  const std::uint64_t count = length();
  if (mark == kString || mark == kTokenRef) {
    source_.require(at_, count, 1, "texts");
    texts_ = count;
    texts_are_defined_ = mark == kTokenRef;
    return begin('@', at);
  }
  HoudiniWord word;
  word.kind = HoudiniWord::Kind::run;
  word.at = at;
  word.run = {Scalar::uint8, NumberRun::Form::bits, source_.bytes.data() + at_, count};
  std::uint64_t values = count / 32 + (count % 32 > 0 ? 1 : 0), size = 4;  // words of bits
  if (mark != kBool) {
    const std::optional<Scalar> type = scalar_of(mark);
    if (!type) malformed("an array is of an unknown type", at + 1, {}, fmt::format("{:#x}", mark));
    word.run.type = *type;
    word.run.form = mark == kReal16 ? NumberRun::Form::half : NumberRun::Form::plain;
    values = count;
    size = size_of(*type);
  }
  source_.require(at_, values, size, "arrays");
  at_ += static_cast<std::size_t>(values * size);
  return word;
}

HoudiniWord HoudiniJson::next_of_texts() {
  if (texts_ == 0) return end('@', at_);
  --texts_;
  HoudiniWord word;
  word.kind = HoudiniWord::Kind::text;
  word.at = at_;
  word.text = texts_are_defined_ ? defined() : std::string(bytes(length(), "texts"));
  return word;
}

HoudiniWord HoudiniJson::next_of_binary() {
  if (!open_.empty() && open_.back() == '@') return next_of_texts();
  while (true) {
    HoudiniWord word;
    word.at = at_;
    const auto mark = static_cast<unsigned char>(byte("lists"));
    switch (mark) {
      case '[':
        return begin(']', word.at);
      case '{':
        return begin('}', word.at);
      case ']':
      case '}':
        return end(static_cast<char>(mark), word.at);
      case kTokenDef:
        define();
        continue;
      case kTokenUndef:
        tokens_.erase(length());
        continue;
      case kUniform:
        return uniform(word.at);
      case kString:
        word.kind = HoudiniWord::Kind::text;
        word.text = std::string(bytes(length(), "texts"));
        return word;
      case kTokenRef:
        word.kind = HoudiniWord::Kind::text;
        word.text = defined();
        return word;
      case kNull:
        return word;
      case kBool:
      case kFalse:
      case kTrue:
        word.kind = HoudiniWord::Kind::truth;
        word.number = mark == kTrue || (mark == kBool && byte("truths") != 0) ? 1 : 0;
        return word;
      default:
        break;
    }
    const std::optional<Scalar> type = scalar_of(mark);
    if (!type) malformed("is no binary JSON", word.at, "a value", fmt::format("{:#x}", mark));
    word.kind = HoudiniWord::Kind::number;
    const char* first = bytes(size_of(*type), "numbers").data();
    const double value = read_value(*type, order_, first);
    word.number = mark == kReal16 ? float_of_half(static_cast<unsigned>(value)) : value;
    return word;
  }
}

}  // namespace meniscus::io
