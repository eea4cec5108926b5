#include <algorithm>
#include <cmath>

#include "meniscus/output.h"
#include "output/decoded_film.h"
#include "output/frame_rate.h"
#include "output/scratch.h"

namespace meniscus {
namespace {

/// A gradient that moves to the right.
Image<Rgb8> moving_gradient(int width, int height, int frame) {
  Image<Rgb8> picture(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double phase = 0.05 * (x - 3 * frame);
      const auto eight = [](double v) { return static_cast<std::uint8_t>(std::lround(127.5 + 110 * v)); };
      picture(x, y) = {eight(std::sin(phase)), eight(std::cos(0.04 * y)), eight(std::sin(phase + 0.03 * y))};
    }
  return picture;
}

void write_film(const std::string& path, int width, int height, int frames, const VideoOptions& options = {}) {
  VideoWriter writer(path, width, height, options);
  for (int i = 0; i < frames; ++i) writer.add(moving_gradient(width, height, i));
  writer.finish();
}

/// The upper left part of a picture.
Image<Rgb8> cropped(const Image<Rgb8>& picture, int width, int height) {
  Image<Rgb8> part(width, height);
  for (int y = 0; y < height; ++y) std::copy_n(picture.row(y), width, part.row(y));
  return part;
}

TEST(Film, IsWhatWasPutIn) {
  const Scratch scratch;
  write_film(scratch / "a.mp4", 160, 96, 12);
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"a.mp4"});
  const DecodedFilm film = decoded_film(scratch / "a.mp4");
  EXPECT_EQ(film.codec, "h264");
  EXPECT_NE(film.container.find("mp4"), std::string::npos);
  EXPECT_EQ(film.pixel_format, "yuv420p");
  EXPECT_EQ(film.width, 160);
  EXPECT_EQ(film.height, 96);
  EXPECT_EQ(film.rate_numerator, 25);
  EXPECT_EQ(film.rate_denominator, 1);
  EXPECT_NEAR(film.seconds, 12 / 25.0, 1e-9);
  ASSERT_EQ(film.frames.size(), 12u);
  for (int i = 0; i < 12; ++i) {
    const auto index = static_cast<std::size_t>(i);
    EXPECT_NEAR(film.times[index], i / 25.0, 1e-9);
    EXPECT_GT(compare(film.frames[index], moving_gradient(160, 96, i)).psnr_db, 30) << i;
  }
}

TEST(Film, IsTaggedAsBt709InLimitedRange) {
  const Scratch scratch;
  write_film(scratch / "a.mp4", 64, 48, 1);
  const DecodedFilm film = decoded_film(scratch / "a.mp4");
  EXPECT_EQ(film.matrix, "bt709");
  EXPECT_EQ(film.primaries, "bt709");
  EXPECT_EQ(film.transfer, "bt709");
  EXPECT_EQ(film.range, "tv");
}

TEST(Film, KeepsFlatColours) {
  const Scratch scratch;
  for (const Rgb8 colour :
       {Rgb8{255, 0, 0}, Rgb8{0, 255, 0}, Rgb8{0, 0, 255}, Rgb8{0, 0, 0}, Rgb8{255, 255, 255}, Rgb8{90, 140, 180}}) {
    VideoWriter writer(scratch / "a.mp4", 64, 64, {.quality_crf = 4});
    writer.add(Image<Rgb8>(64, 64, colour));
    writer.finish();
    const DecodedFilm film = decoded_film(scratch / "a.mp4");
    ASSERT_EQ(film.frames.size(), 1u);
    EXPECT_LE(compare(film.frames[0], Image<Rgb8>(64, 64, colour)).max_difference, 3);
  }
}

TEST(Film, OfAnOddSizeRepeatsItsLastRowAndColumn) {
  const Scratch scratch;
  for (const auto& [width, height] : {std::pair{101, 67}, std::pair{100, 67}, std::pair{101, 66}, std::pair{1, 1}}) {
    write_film(scratch / "a.mp4", width, height, 12, {.quality_crf = 10});
    const DecodedFilm film = decoded_film(scratch / "a.mp4");
    EXPECT_EQ(film.width, width + width % 2);
    EXPECT_EQ(film.height, height + height % 2);
    ASSERT_EQ(film.frames.size(), 12u);
    Image<Rgb8> expected(film.width, film.height);
    for (int i = 0; i < 12; ++i) {
      const Image<Rgb8> given = moving_gradient(width, height, i);
      for (int y = 0; y < film.height; ++y)
        for (int x = 0; x < film.width; ++x) expected(x, y) = given(std::min(x, width - 1), std::min(y, height - 1));
      const Image<Rgb8>& shown = film.frames[static_cast<std::size_t>(i)];
      EXPECT_GT(compare(cropped(shown, width, height), given).psnr_db, 30) << width << " x " << height;
      EXPECT_GT(compare(shown, expected).psnr_db, 30) << width << " x " << height;
    }
  }
}

TEST(Film, HasExactlyTheFrameRateThatWasAskedFor) {
  const Scratch scratch;
  struct Case {
    double rate;
    int numerator, denominator;
  };
  for (const Case& c : {Case{24, 24, 1}, Case{30000.0 / 1001, 30000, 1001}, Case{12.5, 25, 2}, Case{120, 120, 1}}) {
    write_film(scratch / "a.mp4", 32, 32, 12, {.frames_per_second = c.rate});
    const DecodedFilm film = decoded_film(scratch / "a.mp4");
    EXPECT_EQ(film.rate_numerator, c.numerator) << c.rate;
    EXPECT_EQ(film.rate_denominator, c.denominator) << c.rate;
  }
}

TEST(Film, CanBePlayedBeforeItIsWhollyThere) {
  const Scratch scratch;
  write_film(scratch / "a.mp4", 64, 48, 3);
  const std::string bytes = bytes_of(scratch / "a.mp4");
  EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));
}

TEST(Film, IsTheSameFileForAnyNumberOfThreadsAndAnyName) {
  const Scratch scratch;
  write_film(scratch / "many.mp4", 160, 96, 30);
  const ThreadLimit one(1);
  write_film(scratch / "one: with a colon", 160, 96, 30);
  const std::string many = bytes_of(scratch / "many.mp4"), single = bytes_of(scratch / "one: with a colon");
  EXPECT_EQ(many.size(), single.size());
  const auto difference = std::mismatch(many.begin(), many.end(), single.begin(), single.end());
  EXPECT_TRUE(many == single) << "from byte " << difference.first - many.begin() << " of " << many.size();
}

TEST(Film, OfLowerQualityIsSmaller) {
  const Scratch scratch;
  write_film(scratch / "good.mp4", 160, 96, 12, {.quality_crf = 10});
  write_film(scratch / "poor.mp4", 160, 96, 12, {.quality_crf = 40});
  EXPECT_LT(2 * bytes_of(scratch / "poor.mp4").size(), bytes_of(scratch / "good.mp4").size());
}

TEST(Film, LeavesNothingBehindUnlessItIsFinished) {
  const Scratch scratch;
  {
    VideoWriter writer(scratch / "a.mp4", 64, 48, {});
    writer.add(moving_gradient(64, 48, 0));
    const VideoWriter moved(std::move(writer));
    ASSERT_EQ(scratch.names().size(), 1u);
    EXPECT_EQ(scratch.names()[0].rfind(".a.mp4.tmp-" + std::to_string(getpid()), 0), 0u) << scratch.names()[0];
  }
  EXPECT_TRUE(scratch.names().empty());
}

TEST(Film, KeepsTheOldFileUntilItIsFinished) {
  const Scratch scratch;
  write_bytes(scratch / "a.mp4", "old");
  {
    VideoWriter writer(scratch / "a.mp4", 64, 48, {});
    writer.add(moving_gradient(64, 48, 0));
  }
  EXPECT_EQ(bytes_of(scratch / "a.mp4"), "old");
  write_film(scratch / "a.mp4", 64, 48, 1);
  EXPECT_EQ(decoded_film(scratch / "a.mp4").frames.size(), 1u);
}

TEST(Film, WithoutPicturesIsRefused) {
  const Scratch scratch;
  refusal(ErrorCode::invalid_argument, scratch / "a.mp4", [&] { write_film(scratch / "a.mp4", 64, 48, 0); });
  EXPECT_TRUE(scratch.names().empty());
}

TEST(Film, RefusesPicturesOfAnotherSizeAndGoesOn) {
  const Scratch scratch;
  VideoWriter writer(scratch / "a.mp4", 64, 48, {});
  writer.add(moving_gradient(64, 48, 0));
  const std::string message =
      refusal(ErrorCode::invalid_argument, scratch / "a.mp4", [&] { writer.add(moving_gradient(48, 64, 0)); });
  EXPECT_NE(message.find("48 x 64"), std::string::npos) << message;
  writer.finish();
  EXPECT_EQ(decoded_film(scratch / "a.mp4").frames.size(), 1u);
}

TEST(Film, CannotBeFinishedTwice) {
  const Scratch scratch;
  VideoWriter writer(scratch / "a.mp4", 64, 48, {});
  writer.add(moving_gradient(64, 48, 0));
  writer.finish();
  EXPECT_THROW(writer.finish(), Error);
  EXPECT_THROW(writer.add(moving_gradient(64, 48, 1)), Error);
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"a.mp4"});
}

TEST(Film, RefusesImpossibleOptions) {
  const Scratch scratch;
  const auto refused = [&](int width, int height, const VideoOptions& options) {
    try {
      VideoWriter(scratch / "a.mp4", width, height, options);
      ADD_FAILURE() << width << " x " << height;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << error.what();
    }
  };
  refused(0, 48, {});
  refused(64, -1, {});
  refused(64, 48, {.frames_per_second = 0});
  refused(64, 48, {.frames_per_second = std::nan("")});
  refused(64, 48, {.quality_crf = 52});
  EXPECT_TRUE(scratch.names().empty());
}

TEST(Film, TooLargeForH264IsRefused) {
  const Scratch scratch;
  const std::string message =
      refusal(ErrorCode::unsupported, scratch / "a.mp4", [&] { VideoWriter(scratch / "a.mp4", 2, 16385, {}); });
  EXPECT_NE(message.find("16384"), std::string::npos) << message;
  EXPECT_TRUE(scratch.names().empty());
}

TEST(FrameRate, IsTheSimplestFraction) {
  const auto is = [](double rate, int numerator, int denominator) {
    const FrameRate found = frame_rate(rate);
    EXPECT_EQ(found.numerator, numerator) << rate;
    EXPECT_EQ(found.denominator, denominator) << rate;
  };
  is(25, 25, 1);
  is(12.5, 25, 2);
  is(1.0 / 3, 1, 3);
  is(0.1, 1, 10);
  is(33.3, 333, 10);
  is(1000, 1000, 1);
  is(23.976, 24000, 1001);
  is(29.97, 30000, 1001);
  is(30000.0 / 1001, 30000, 1001);
  is(47.952, 48000, 1001);
  is(59.94, 60000, 1001);
  is(119.88, 120000, 1001);
  is(23.98, 1199, 50);
}

TEST(FrameRate, IsCloseForAnyNumber) {
  for (double rate = 0.011; rate < 1000; rate *= 1.0371) {
    const FrameRate found = frame_rate(rate);
    EXPECT_NEAR(static_cast<double>(found.numerator) / found.denominator, rate, 2e-4 * rate);
  }
}

}  // namespace
}  // namespace meniscus
