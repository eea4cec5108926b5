#include "io/text_numbers.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numeric>

namespace meniscus {
namespace {

const std::string kPath = "numbers.txt";

io::Source source_of(const std::string& text) { return {kPath, {text.data(), text.size()}}; }

/// The numbers 0, 1, 2 ... between blanks of all kinds; more than one piece of work.
std::string many_numbers(int count) {
  const char* blanks[] = {" ", "\r\n", "\t", "   \n", " \f\v"};
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format("{}{}", i, blanks[i % 5]);
  return text;
}

TEST(TextNumbers, AreTheSameOnAnyNumberOfThreads) {
  constexpr int kCount = 300'000;
  const std::string text = many_numbers(kCount);
  std::vector<double> expected(kCount);
  std::iota(expected.begin(), expected.end(), 0.0);
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    std::vector<double> values(kCount);
    const io::TextNumbers read = io::read_numbers(source_of(text), 0, text.size(), std::span(values), "numbers");
    EXPECT_EQ(read.count, expected.size());
    EXPECT_EQ(values, expected);
  }
}

TEST(TextNumbers, EndBehindTheLastThatIsAskedFor) {
  const std::string text = many_numbers(200'000) + "no number";
  for (const std::size_t count : {0, 1, 2, 25'000, 199'999, 200'000}) {
    std::vector<float> values(count);
    const io::TextNumbers read = io::read_numbers(source_of(text), 0, text.size(), std::span(values), "numbers");
    EXPECT_EQ(read.count, count);
    if (count == 0) continue;
    const std::string last = std::to_string(count - 1);
    EXPECT_EQ(text.substr(read.end - last.size(), last.size()), last);
    EXPECT_EQ(values.back(), static_cast<float>(count - 1));
  }
}

TEST(TextNumbers, AreFewerWhereTheTextEnds) {
  const std::string text = "  1 2\n3 ";
  std::vector<float> values(5);
  const io::TextNumbers read = io::read_numbers(source_of(text), 0, text.size(), std::span(values), "numbers");
  EXPECT_EQ(read.count, 3u);
  EXPECT_EQ(read.end, 7u);
}

TEST(TextNumbers, NameTheFirstWordThatIsNone) {
  std::string text = many_numbers(300'000);
  const std::size_t first = text.find("150000"), second = text.find("299000");
  text[first] = 'x';
  text[second] = 'y';
  for (const int threads : {1, 5}) {
    const ThreadLimit limit(threads);
    std::vector<float> values(300'000);
    try {
      io::read_numbers(source_of(text), 0, text.size(), std::span(values), "numbers");
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().byte_offset, first);
      EXPECT_EQ(error.detail().found, "'x50000'");
    }
  }
}

TEST(TextNumbers, OfOneWordOfMillionsOfDigitsEnd) {
  const std::string text = std::string(std::size_t{5} << 20, '1') + " 2";
  std::vector<double> values(2);
  EXPECT_EQ(io::read_numbers(source_of(text), 0, text.size(), std::span(values), "numbers").count, 2u);
  EXPECT_EQ(values[1], 2.0);
}

}  // namespace
}  // namespace meniscus
