#include "scene/hdr_file.h"

#include <gtest/gtest.h>

#include "hdr_writing.h"

namespace meniscus {
namespace {

using tests::flat_hdr;
using tests::hdr_header;
using tests::rgbe;
using tests::TemporaryFile;

vec3 colour_at(int x, int y) { return {static_cast<float>(x) + 1.0f, static_cast<float>(y) * 2.0f, 0.5f}; }

/// The same picture with rows in runs: pairs of equal bytes as runs of two, the last byte as a literal.
std::string run_length_hdr(int width, int height) {
  std::string bytes = hdr_header(width, height);
  for (int y = 0; y < height; ++y) {
    bytes += {2, 2, static_cast<char>(width >> 8), static_cast<char>(width & 255)};
    for (std::size_t channel = 0; channel < 4; ++channel)
      for (int x = 0; x < width;) {
        const char value = rgbe(colour_at(x, y))[channel];
        if (x + 1 < width && rgbe(colour_at(x + 1, y))[channel] == value) {
          bytes += {static_cast<char>(128 + 2), value};
          x += 2;
        } else {
          bytes += {1, value};
          x += 1;
        }
      }
  }
  return bytes;
}

ErrorCode code_of(const std::string& bytes) {
  const TemporaryFile file(bytes);
  try {
    read_hdr(file.path());
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, file.path());
    return error.code();
  }
  ADD_FAILURE() << "was read without an error";
  return ErrorCode::invalid_argument;
}

TEST(HdrFile, KeepsColoursToOnePartIn128) {
  const TemporaryFile file(flat_hdr(5, 3, colour_at));
  const Image<vec3> picture = read_hdr(file.path());
  ASSERT_EQ(picture.width(), 5);
  ASSERT_EQ(picture.height(), 3);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x)
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(picture(x, y)[k], colour_at(x, y)[k], 5.0f / 128.0f);
}

TEST(HdrFile, ReadsRunsLikeFlatRows) {
  const TemporaryFile flat(flat_hdr(11, 4, colour_at)), runs(run_length_hdr(11, 4));
  const Image<vec3> a = read_hdr(flat.path()), b = read_hdr(runs.path());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i], b[i]);
}

TEST(HdrFile, RefusesEveryPrefixOfAFile) {
  for (const std::string& whole : {flat_hdr(9, 2, colour_at), run_length_hdr(9, 2)})
    for (std::size_t length = 0; length < whole.size(); ++length)
      EXPECT_EQ(code_of(whole.substr(0, length)), ErrorCode::malformed_file) << length;
}

TEST(HdrFile, NamesAMissingFile) {
  try {
    read_hdr("/nowhere/sky.hdr");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::not_found);
    EXPECT_EQ(error.detail().path, "/nowhere/sky.hdr");
  }
}

TEST(HdrFile, RefusesOtherFormats) {
  EXPECT_EQ(code_of("\x89PNG\r\n\x1a\n and so on"), ErrorCode::malformed_file);
  EXPECT_EQ(code_of("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n...."), ErrorCode::unsupported);
  EXPECT_EQ(code_of("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n+Y 1 +X 1\n...."), ErrorCode::unsupported);
}

TEST(HdrFile, DoesNotBelieveASizeThatTheFileCannotHold) {
  EXPECT_EQ(code_of(hdr_header(32000, 32000) + "few bytes"), ErrorCode::malformed_file);
  EXPECT_EQ(code_of(hdr_header(0, 4)), ErrorCode::malformed_file);
  EXPECT_EQ(code_of("#?RADIANCE\n\n-Y 99999999999 +X 4\n"), ErrorCode::malformed_file);
}

TEST(HdrFile, RefusesRunsThatLeaveTheirRow) {
  std::string bytes = hdr_header(8, 1) + std::string{2, 2, 0, 8};
  bytes += {static_cast<char>(128 + 9), 1};
  EXPECT_EQ(code_of(bytes + std::string(64, '\1')), ErrorCode::malformed_file);
  std::string none = hdr_header(8, 1) + std::string{2, 2, 0, 8};
  EXPECT_EQ(code_of(none + std::string(64, '\0')), ErrorCode::malformed_file);
}

}  // namespace
}  // namespace meniscus
