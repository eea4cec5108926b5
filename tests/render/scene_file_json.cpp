#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "render/json_text.h"
#include "render/nearest_name.h"

namespace meniscus {
namespace {

/// What stands at the place of a pointer, up to the end of its line.
std::string text_at(const std::string& text, const std::string& pointer, bool of_key = false) {
  const JsonText json("x.json", text);
  const TextPosition position = json.position_of(pointer, of_key);
  std::size_t begin = 0;
  for (std::uint64_t line = 1; line < position.line; ++line) begin = text.find('\n', begin) + 1;
  begin += position.column - 1;
  return text.substr(begin, text.find('\n', begin) - begin);
}

const char* const kNested = R"({
  // "b": 1 is no field, nor is this quote: "
  "a": [1, [2, "x, ]}\" // no comment"], {"b": /* "c": { */ true}],
  "a/b": {"~": null, "": -1.5e-3},
  "\u0063": {"d": {"e": [[], {}, [[7]]]}}, "last" : "end"
})";

TEST(JsonPositions, AreFoundInNestedTextsWithEscapesAndComments) {
  EXPECT_EQ(text_at(kNested, "").substr(0, 1), "{");
  EXPECT_EQ(text_at(kNested, "/a").substr(0, 3), "[1,");
  EXPECT_EQ(text_at(kNested, "/a/0").substr(0, 2), "1,");
  EXPECT_EQ(text_at(kNested, "/a/1").substr(0, 3), "[2,");
  EXPECT_EQ(text_at(kNested, "/a/1/1").substr(0, 6), "\"x, ]}");
  EXPECT_EQ(text_at(kNested, "/a/2").substr(0, 4), "{\"b\"");
  EXPECT_EQ(text_at(kNested, "/a/2/b").substr(0, 4), "true");
  EXPECT_EQ(text_at(kNested, "/a~1b/~0").substr(0, 4), "null");
  EXPECT_EQ(text_at(kNested, "/a~1b/").substr(0, 5), "-1.5e");
  EXPECT_EQ(text_at(kNested, "/c").substr(0, 4), "{\"d\"");
  EXPECT_EQ(text_at(kNested, "/c/d/e/2/0/0").substr(0, 2), "7]");
  EXPECT_EQ(text_at(kNested, "/last"), "\"end\"");
  EXPECT_EQ(text_at(kNested, "/last", true), "\"last\" : \"end\"");
}

TEST(JsonPositions, AgreeWithTheParserOnEveryValue) {
  // The token that stands at a scalar's place parses to the scalar that the pointer names.
  const JsonText json("x.json", kNested);
  std::size_t values = 0;
  const std::string text = kNested;
  const auto on_value = [&](const std::string& pointer, std::size_t, std::size_t at) {
    const nlohmann::json& value = json.root().at(nlohmann::json::json_pointer(pointer));
    ++values;
    if (value.is_structured()) {
      EXPECT_EQ(text[at], value.is_object() ? '{' : '[') << pointer;
    } else {
      const std::string token = value.dump();
      if (!value.is_number_float()) {
        EXPECT_EQ(text.substr(at, token.size()), token) << pointer;
      } else {
        EXPECT_EQ(std::stod(text.substr(at)), value.get<double>()) << pointer;
      }
    }
    return true;
  };
  scan_json(text, on_value);
  EXPECT_EQ(values, 20u);
}

Error error_of(const std::string& text) {
  try {
    const JsonText json("x.json", text);
  } catch (const Error& error) {
    return error;
  }
  return {ErrorCode::invalid_argument, "nothing was refused"};
}

TEST(JsonText, SaysWhereItIsNoJson) {
  const Error error = error_of("{\n  \"a\": [1, 2,, 3]\n}");
  EXPECT_EQ(error.code(), ErrorCode::malformed_file);
  EXPECT_EQ(error.detail().line, 2u);
  EXPECT_NE(error.detail().problem.find("column 14"), std::string::npos) << error.what();
  EXPECT_EQ(error_of("").code(), ErrorCode::malformed_file);
  EXPECT_EQ(error_of("{\"a\": 1} x").code(), ErrorCode::malformed_file);
  EXPECT_EQ(error_of("{\"a\": \"\xff\"}").code(), ErrorCode::malformed_file);
  EXPECT_EQ(error_of("{\"a\": 1 /* no end").code(), ErrorCode::malformed_file);
}

TEST(JsonText, RefusesEveryBeginningOfAFile) {
  const std::string text = kNested;
  for (std::size_t length = 0; length < text.size(); ++length)
    EXPECT_EQ(error_of(text.substr(0, length)).code(), ErrorCode::malformed_file) << length;
  EXPECT_NO_THROW(JsonText("x.json", text));
}

TEST(JsonText, RefusesNumbersThatNoDoubleHolds) {
  const Error error = error_of("{\n\n \"a\": 1e999}");
  EXPECT_EQ(error.code(), ErrorCode::malformed_file);
  EXPECT_EQ(error.detail().line, 3u);
}

TEST(JsonText, RefusesAKeyThatStandsTwiceInOneObject) {
  const Error error = error_of("{\"a\": {\"b\": 1},\n\"c\": [{\"b\": 1}, {\"b\": 2,\n  \"\\u0062\": 3}]}");
  EXPECT_EQ(error.code(), ErrorCode::malformed_file);
  EXPECT_EQ(error.detail().line, 3u);
  EXPECT_NE(error.detail().problem.find("column 3"), std::string::npos) << error.what();
  EXPECT_NO_THROW(JsonText("x.json", "[{\"b\": 1}, {\"b\": 2}]"));
}

TEST(JsonText, RefusesDeepNestingInLittleTime) {
  EXPECT_EQ(error_of(std::string(1000000, '[')).code(), ErrorCode::malformed_file);
  EXPECT_EQ(error_of(std::string(40, '[') + std::string(40, ']')).code(), ErrorCode::malformed_file);
}

TEST(NearestName, CountsLettersToChange) {
  EXPECT_EQ(edit_distance("iso", "iso"), 0u);
  EXPECT_EQ(edit_distance("", "iso"), 3u);
  EXPECT_EQ(edit_distance("isso", "iso"), 1u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("retfraction", "refraction"), 1u);
  EXPECT_EQ(edit_distance("tnak", "tank"), 1u);
  EXPECT_EQ(edit_distance("Tank", "tank"), 0u);
}

TEST(NearestName, IsNoneWhereNothingIsNear) {
  const std::vector<std::string> known{"size", "show", "exposure"};
  EXPECT_EQ(nearest_name("sise", known), "size");
  EXPECT_EQ(nearest_name("expsure", known), "exposure");
  EXPECT_EQ(nearest_name("camera", known), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'x'), known), "");
}

}  // namespace
}  // namespace meniscus
