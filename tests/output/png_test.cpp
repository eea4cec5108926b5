#include <png.h>

#include "meniscus/output.h"
#include "output/scratch.h"

namespace meniscus {
namespace {

Image<Rgb8> sample(int width, int height) {
  Image<Rgb8> picture(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      picture(x, y) = {static_cast<std::uint8_t>(x * 7), static_cast<std::uint8_t>(y * 11),
                       static_cast<std::uint8_t>(x * y)};
  return picture;
}

bool same(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  return a.width() == b.width() && a.height() == b.height() && std::equal(a.begin(), a.end(), b.begin());
}

/// Writes rows of another kind of PNG.
void write_other_png(const std::string& path, int width, int height, int bits, int type, bool interlaced,
                     const std::vector<std::vector<png_byte>>& rows) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits, type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const png_color palette[2] = {{1, 2, 3}, {200, 100, 50}};
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 2);
  png_write_info(png, info);
  std::vector<png_bytep> pointers;
  for (const auto& row : rows) pointers.push_back(const_cast<png_bytep>(row.data()));
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

TEST(Png, ComesBackAsItWasWritten) {
  const Scratch scratch;
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{37, 23}, std::pair{640, 3}}) {
    write_png(scratch / "a.png", sample(width, height));
    EXPECT_TRUE(same(read_png(scratch / "a.png"), sample(width, height))) << width;
  }
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"a.png"});
}

/// Parts of large pictures are compressed side by side, each with what came before it in sight.
TEST(Png, OfManyPiecesIsTheSameForAnyNumberOfThreads) {
  const Scratch scratch;
  Image<Rgb8> picture = sample(701, 450);
  std::uint32_t state = 1;
  for (Rgb8& pixel : picture) {
    state = state * 1664525u + 1013904223u;
    if (state >> 31 != 0) pixel.g = static_cast<std::uint8_t>(state >> 20);
  }
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    write_png(scratch / std::to_string(threads), picture);
    EXPECT_TRUE(same(read_png(scratch / std::to_string(threads)), picture)) << threads;
  }
  EXPECT_EQ(bytes_of(scratch / "1"), bytes_of(scratch / "2"));
  EXPECT_EQ(bytes_of(scratch / "1"), bytes_of(scratch / "5"));
  const std::string bytes = bytes_of(scratch / "1");
  EXPECT_NE(bytes.find("IDAT"), bytes.rfind("IDAT"));
}

TEST(Png, IsTaggedAsSrgb) {
  const Scratch scratch;
  write_png(scratch / "a.png", sample(4, 4));
  EXPECT_NE(bytes_of(scratch / "a.png").find("sRGB"), std::string::npos);
}

TEST(Png, OfOtherKindsIsReadAsRgb) {
  const Scratch scratch;
  write_other_png(scratch / "grey.png", 2, 1, 8, PNG_COLOR_TYPE_GRAY, false, {{7, 250}});
  EXPECT_EQ(read_png(scratch / "grey.png")(1, 0), (Rgb8{250, 250, 250}));
  write_other_png(scratch / "alpha.png", 1, 1, 8, PNG_COLOR_TYPE_RGB_ALPHA, false, {{10, 20, 30, 0}});
  EXPECT_EQ(read_png(scratch / "alpha.png")(0, 0), (Rgb8{10, 20, 30}));
  write_other_png(scratch / "bits.png", 3, 1, 1, PNG_COLOR_TYPE_GRAY, false, {{0b01000000}});
  EXPECT_EQ(read_png(scratch / "bits.png")(1, 0), (Rgb8{255, 255, 255}));
  EXPECT_EQ(read_png(scratch / "bits.png")(2, 0), (Rgb8{0, 0, 0}));
  write_other_png(scratch / "palette.png", 2, 1, 8, PNG_COLOR_TYPE_PALETTE, false, {{1, 0}});
  EXPECT_EQ(read_png(scratch / "palette.png")(0, 0), (Rgb8{200, 100, 50}));
  // 16 bits: 0x80FF is 128.5 steps of 257; 0x0101 is exactly one.
  write_other_png(scratch / "deep.png", 1, 1, 16, PNG_COLOR_TYPE_RGB, false, {{0x01, 0x01, 0xFF, 0xFF, 0x12, 0x00}});
  EXPECT_EQ(read_png(scratch / "deep.png")(0, 0), (Rgb8{1, 255, 18}));
  std::vector<std::vector<png_byte>> rows(9, std::vector<png_byte>(9 * 3));
  for (int i = 0; i < 9 * 27; ++i)
    rows[static_cast<std::size_t>(i / 27)][static_cast<std::size_t>(i % 27)] = static_cast<png_byte>(i);
  write_other_png(scratch / "interlaced.png", 9, 9, 8, PNG_COLOR_TYPE_RGB, true, rows);
  const Image<Rgb8> interlaced = read_png(scratch / "interlaced.png");
  for (int i = 0; i < 81; ++i) EXPECT_EQ(interlaced[static_cast<std::size_t>(i)].r, 3 * i);
}

TEST(Png, IsRefusedWhereverItIsCutOff) {
  const Scratch scratch;
  write_png(scratch / "whole.png", sample(23, 9));
  const std::string whole = bytes_of(scratch / "whole.png");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write_bytes(scratch / "cut.png", whole.substr(0, length));
    refusal(ErrorCode::malformed_file, scratch / "cut.png", [&] { read_png(scratch / "cut.png"); });
  }
}

TEST(Png, WithAFlippedBitIsRefusedOrTheSamePicture) {
  const Scratch scratch;
  const Image<Rgb8> picture = sample(13, 7);
  write_png(scratch / "whole.png", picture);
  const std::string whole = bytes_of(scratch / "whole.png");
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string broken = whole;
    broken[bit / 8] = static_cast<char>(broken[bit / 8] ^ 1 << bit % 8);
    write_bytes(scratch / "broken.png", broken);
    try {
      EXPECT_TRUE(same(read_png(scratch / "broken.png"), picture)) << "bit " << bit;
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, static_cast<int>(7 * whole.size()));  // all but those of the colour-space note
}

TEST(Png, OfAnImpossibleSizeIsRefusedBeforeMemoryIsTaken) {
  // 30,000 x 30,000 pixels, 2.7 GB, claimed by a file of a few dozen bytes whose checksums are right.
  const Scratch scratch;
  std::string bytes("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x75\x30\0\0\x75\x30\x08\x02\0\0\0", 29);
  const auto crc = [](const std::string& chunk) {
    std::uint32_t sum = 0xFFFFFFFFu;
    for (const char c : chunk) {
      sum ^= static_cast<unsigned char>(c);
      for (int i = 0; i < 8; ++i) sum = sum >> 1 ^ (sum & 1 ? 0xEDB88320u : 0);
    }
    sum = ~sum;
    return std::string{static_cast<char>(sum >> 24), static_cast<char>(sum >> 16), static_cast<char>(sum >> 8),
                       static_cast<char>(sum)};
  };
  bytes += crc(bytes.substr(12));
  bytes += std::string("\0\0\0\0IDAT", 8) + crc("IDAT");
  write_bytes(scratch / "huge.png", bytes);
  refusal(ErrorCode::limit_exceeded, scratch / "huge.png", [&] { read_png(scratch / "huge.png"); });
}

TEST(Png, ReadingNamesWhatIsMissing) {
  const Scratch scratch;
  refusal(ErrorCode::not_found, scratch / "none.png", [&] { read_png(scratch / "none.png"); });
  refusal(ErrorCode::io_failed, scratch.path().string(), [&] { read_png(scratch.path().string()); });
  write_bytes(scratch / "text.png", "this is a text, not a picture");
  refusal(ErrorCode::malformed_file, scratch / "text.png", [&] { read_png(scratch / "text.png"); });
}

TEST(Png, WithoutPixelsIsRefused) {
  const Scratch scratch;
  refusal(ErrorCode::invalid_argument, scratch / "a.png", [&] { write_png(scratch / "a.png", {}); });
  EXPECT_TRUE(scratch.names().empty());
}

}  // namespace
}  // namespace meniscus
