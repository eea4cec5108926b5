#include <png.h>
#include <algorithm>
#include <csetjmp>
#include <cstring>

#include "meniscus/output.h"
#include "output/file_bytes.h"

namespace meniscus {
namespace {

/// What libpng's callbacks share.
struct Reading {
  std::span<const unsigned char> bytes;
  std::size_t at;
  char message[128];
};

void read_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto& reading = *static_cast<Reading*>(png_get_io_ptr(png));
  if (count > reading.bytes.size() - reading.at) {
    reading.at = reading.bytes.size();
    png_error(png, "it ends too early");
  }
  std::copy_n(reading.bytes.data() + reading.at, count, to);
  reading.at += count;
}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto& reading = *static_cast<Reading*>(png_get_error_ptr(png));
  std::strncpy(reading.message, message, sizeof(reading.message) - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

// No object with a destructor may live in the functions that setjmp: longjmp would skip it.

/// Reads all up to the pixels and asks for 8-bit RGB.
bool read_header(png_structp png, png_infop info, Reading* reading) {
  if (setjmp(png_jmpbuf(png))) return false;  // NOLINT: libpng's way
  png_set_read_fn(png, reading, read_bytes);
  png_read_info(png, info);
  png_set_expand(png);    // palettes, fewer than 8 bits
  png_set_scale_16(png);  // 16 bits, rounded
  png_set_strip_alpha(png);
  png_set_gray_to_rgb(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool read_pixels(png_structp png, png_infop info, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) return false;  // NOLINT: libpng's way
  png_read_image(png, rows);
  png_read_end(png, info);
  return true;
}

/// libpng's objects, freed at the end.
struct Decoder {
  Reading reading{};
  png_structp png = nullptr;
  png_infop info = nullptr;
  explicit Decoder(std::span<const unsigned char> bytes) {
    reading.bytes = bytes;
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reading, on_error, on_warning);
    if (png) info = png_create_info_struct(png);
    if (!info) throw std::bad_alloc();
  }
  ~Decoder() { png_destroy_read_struct(&png, &info, nullptr); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
};

}  // namespace

Image<Rgb8> read_png(const std::string& path) {
  const std::vector<unsigned char> bytes = file_bytes(path);
  if (bytes.size() < 8 || png_sig_cmp(bytes.data(), 0, 8) != 0) throw malformed(path, "the file is no PNG", 0);
  Decoder decoder(bytes);
  const auto broken = [&] {
    return malformed(path, std::string("the PNG file is broken: ") + decoder.reading.message, decoder.reading.at);
  };
  if (!read_header(decoder.png, decoder.info, &decoder.reading)) throw broken();

  // Believe the header only as far as the file's size justifies it.
  const png_uint_32 width = png_get_image_width(decoder.png, decoder.info);
  const png_uint_32 height = png_get_image_height(decoder.png, decoder.info);
  check_size_is_justified(path, 3.0 * width * height, bytes.size());
  if (png_get_rowbytes(decoder.png, decoder.info) != std::size_t{3} * width)
    throw malformed(path, "the PNG file's pixels cannot be read as RGB");

  Image<Rgb8> picture(static_cast<int>(width), static_cast<int>(height));
  std::vector<png_bytep> rows(height);
  for (int y = 0; y < picture.height(); ++y) rows[static_cast<std::size_t>(y)] = &picture.row(y)->r;
  if (!read_pixels(decoder.png, decoder.info, rows.data())) throw broken();
  return picture;
}

}  // namespace meniscus
