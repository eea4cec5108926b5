/// The small frame as Houdini's JSON, word by word, as text and in both byte orders of its binary encoding.
#pragma once

#include <fmt/format.h>

#include <map>

#include "small_frames.h"

namespace meniscus {

enum class HoudiniForm { text, little, big };

/// Writes lists of values. In binary files names are defined once and then named by their number.
class HoudiniWriter {
 public:
  explicit HoudiniWriter(HoudiniForm form)
      : form_(form), out_(form == HoudiniForm::big ? std::endian::big : std::endian::little) {
    if (!is_text()) out_.put<std::uint8_t>(0x7f).put<std::uint32_t>(0x624a534e);
  }
  bool is_text() const { return form_ == HoudiniForm::text; }
  HoudiniWriter& begin(char bracket = '[') { return mark(bracket); }
  HoudiniWriter& end(char bracket = ']') {
    out_.text({&bracket, 1});
    comma_ = true;
    return *this;
  }
  /// A text, which binary files may have in place or by number.
  HoudiniWriter& word(const std::string& text, bool in_place = false) {
    if (is_text()) return plain("\"" + text + "\"");
    if (in_place) {
      out_.put<std::uint8_t>(0x27);
      return length(text.size()).bytes(text);
    }
    const auto [place, is_new] = tokens_.try_emplace(text, tokens_.size());
    if (is_new) {
      out_.put<std::uint8_t>(0x2b);
      length(place->second).length(text.size()).bytes(text);
    }
    out_.put<std::uint8_t>(0x26);
    return length(place->second);
  }
  HoudiniWriter& whole(std::int64_t value) {
    if (is_text()) return plain(std::to_string(value));
    if (value >= -128 && value < 128) {
      out_.put<std::uint8_t>(0x11).put(static_cast<std::int8_t>(value));
    } else {
      out_.put<std::uint8_t>(0x14).put(value);
    }
    return *this;
  }
  HoudiniWriter& truth(bool value) {
    if (is_text()) return plain(value ? "true" : "false");
    out_.put<std::uint8_t>(value ? 0x31 : 0x30);
    return *this;
  }
  /// A list of numbers, in binary files as one run.
  template <class T>
  HoudiniWriter& run(const std::vector<T>& values) {
    if (is_text()) {
      begin();
      for (const T value : values) plain(fmt::format("{}", value));
      return end();
    }
    out_.put<std::uint8_t>(0x40).put<std::uint8_t>(sizeof(T) == 8 ? 0x1a : std::is_same_v<T, float> ? 0x19 : 0x13);
    length(values.size());
    for (const T value : values) out_.put(value);
    return *this;
  }
  /// A list of marks, in binary files as bits.
  HoudiniWriter& bits(const std::vector<bool>& values) {
    if (is_text()) {
      begin();
      for (const bool value : values) truth(value);
      return end();
    }
    out_.put<std::uint8_t>(0x40).put<std::uint8_t>(0x10);
    length(values.size());
    for (std::size_t i = 0; i < values.size(); i += 32) {
      std::uint32_t word = 0;
      for (std::size_t k = i; k < std::min(values.size(), i + 32); ++k) word |= values[k] ? 1u << (k - i) : 0u;
      out_.put(word);
    }
    return *this;
  }
  HoudiniWriter& length(std::uint64_t value) {
    if (value < 0xf1) {
      out_.put(static_cast<std::uint8_t>(value));
    } else if (value < 0x10000) {
      out_.put<std::uint8_t>(0xf2).put(static_cast<std::uint16_t>(value));
    } else if (value < 0x100000000) {
      out_.put<std::uint8_t>(0xf4).put(static_cast<std::uint32_t>(value));
    } else {
      out_.put<std::uint8_t>(0xf8).put(value);
    }
    return *this;
  }
  HoudiniWriter& bytes(std::string_view bytes) {
    out_.text(bytes);
    return *this;
  }
  /// The start of an attribute, up to the name of its values.
  HoudiniWriter& attribute(const std::string& name, const std::string& type = "numeric") {
    begin().begin().word("scope").word("public").word("type").word(type).word("name").word(name, true);
    return word("options").begin('{').end('}').end().begin();
  }
  const std::string& result() const { return out_.bytes(); }

 private:
  HoudiniWriter& mark(char bracket) {
    if (is_text() && comma_) out_.text(",");
    comma_ = false;
    out_.text({&bracket, 1});
    return *this;
  }
  HoudiniWriter& plain(const std::string& text) {
    out_.text((comma_ ? "," : "") + text);
    comma_ = true;
    return *this;
  }

  HoudiniForm form_;
  ByteWriter out_;
  bool comma_ = false;  ///< before what comes next in text
  std::map<std::string, std::size_t> tokens_;
};

/// `components` values of each particle of the small frame, one particle after the other.
template <class T, class Value>
std::vector<T> houdini_values(int count, int components, Value value) {
  std::vector<T> values;
  for (int i = 0; i < count; ++i)
    for (int c = 0; c < components; ++c) values.push_back(static_cast<T>(value(i, c)));
  return values;
}

/// P in pages, v in tuples, density as an array, kind as texts of which a page is constant, an id and a list at last.
inline std::string small_houdini(HoudiniForm form, int count = kSmallCount) {
  const bool some = count > 0;
  HoudiniWriter out(form);
  out.begin().word("fileversion").word("19.5.303").word("hasindex").truth(false).word("pointcount").whole(count);
  out.word("vertexcount").whole(0).word("primitivecount").whole(2).word("info").begin('{').word("software", true);
  out.word("Houdini 19.5").word("time").whole(7).end('}').word("topology").begin().word("pointref").begin();
  out.word("indices").begin().end().end().end().word("attributes").begin().word("vertexattributes").begin().end();
  out.word("pointattributes").begin();

  const auto position = [](int i, int c) { return small_position(i)[c]; };
  const auto velocity = [](int i, int c) { return small_velocity(i)[c]; };
  out.attribute("P").word("size").whole(3).word("storage").word("fpreal32").word("defaults").begin().word("size");
  out.whole(1).word("values").begin().whole(0).end().end().word("values").begin().word("size").whole(3);
  out.word("storage").word("fpreal32").word("packing").begin().whole(3).end().word("pagesize").whole(1024);
  out.word("constantpageflags").begin().begin().end().end();
  out.word("rawpagedata").run(houdini_values<float>(count, 3, position)).end().end().end();

  out.attribute("v").word("size").whole(3).word("values").begin().word("size").whole(3).word("tuples").begin();
  for (int i = 0; i < count; ++i) {
    std::vector<float> one;
    for (int c = 0; c < 3; ++c) one.push_back(velocity(i, c));
    out.run(one);
  }
  out.end().end().end().end();

  out.attribute("density").word("values").begin().word("size").whole(1).word("arrays").begin();
  out.run(houdini_values<double>(count, 1, [](int i, int) { return 1000 + i; })).end().end().end().end();

  // Two pages of four: the first is constant, of the second three are there.
  out.attribute("kind", "string").word("strings").begin().word("water", true).word("oil", true).end();
  out.word("indices").begin().word("size").whole(1).word("pagesize").whole(4).word("constantpageflags").begin();
  out.bits(some ? std::vector<bool>{true, false} : std::vector<bool>{}).end();
  out.word("rawpagedata").run(some ? std::vector<std::int32_t>{1, 0, 1, 0} : std::vector<std::int32_t>{});
  out.end().end().end();

  out.attribute("id").word("values").begin().word("storage").word("int32").word("pagesize").whole(2);
  out.word("rawpagedata").run(houdini_values<std::int32_t>(count, 1, [](int i, int) { return 10 * i; }));
  out.end().end().end();
  out.attribute("near", "arraydata").word("lists").begin().whole(1).end().end().end();
  out.end().end();
  out.word("primitives").begin().begin().begin().word("type").word("run").end().end().end().end();
  return out.result();
}

constexpr HoudiniForm kHoudiniForms[]{HoudiniForm::text, HoudiniForm::little, HoudiniForm::big};

inline std::string houdini_name(HoudiniForm form) { return form == HoudiniForm::text ? "f.geo" : "f.bgeo"; }

}  // namespace meniscus
