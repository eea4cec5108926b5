#include <gtest/gtest.h>

#include "meniscus/base.h"

namespace meniscus {
namespace {

std::string text_of(ErrorDetail detail) { return Error(ErrorCode::malformed_file, std::move(detail)).what(); }

TEST(Error, JoinsAllPartsIntoOneLine) {
  ErrorDetail detail;
  detail.problem = "the point list ends early";
  detail.expected = "12 bytes";
  detail.found = "7 bytes";
  detail.path = "wave.bgeo";
  detail.byte_offset = 41;
  detail.line = 3;
  detail.advice = "write the frame again";
  EXPECT_EQ(text_of(detail),
            "wave.bgeo:3: the point list ends early (expected 12 bytes, found 7 bytes, at byte 41); "
            "write the frame again");
}

TEST(Error, LeavesOutWhatIsNotKnown) {
  ErrorDetail detail;
  detail.problem = "no frames";
  EXPECT_EQ(text_of(detail), "no frames");
  detail.found = "an empty folder";
  EXPECT_EQ(text_of(detail), "no frames (found an empty folder)");
  detail.path = "run/";
  EXPECT_EQ(text_of(detail), "run/: no frames (found an empty folder)");
  detail.found.clear();
  detail.byte_offset = 0;  // the first byte is a place like any other
  EXPECT_EQ(text_of(detail), "run/: no frames (at byte 0)");
}

TEST(Error, KeepsCodeAndParts) {
  const Error error(ErrorCode::not_found, "no such attribute");
  EXPECT_EQ(error.code(), ErrorCode::not_found);
  EXPECT_EQ(error.detail().problem, "no such attribute");
  EXPECT_STREQ(error.what(), "no such attribute");
}

TEST(Error, BracesInPartsAreTextAndNotFormats) {
  ErrorDetail detail;
  detail.problem = "{} names no frame {0:d}";
  detail.path = "{}.vtk";
  EXPECT_EQ(text_of(detail), "{}.vtk: {} names no frame {0:d}");
}

}  // namespace
}  // namespace meniscus
