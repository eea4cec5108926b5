#include <fmt/format.h>
#include <png.h>
#include <csetjmp>
#include <exception>

#include "meniscus/output.h"
#include "output/png_rows.h"
#include "base/temporary_file.h"

namespace meniscus {
namespace {

/// Renderings with dither hardly shrink above this level, but take twice the time.
constexpr int kCompressionLevel = 4;

using Pieces = std::vector<std::vector<unsigned char>>;

/// What libpng's callbacks share. Exceptions must not cross the C library: they are kept here.
struct Writing {
  TemporaryStream* stream;
  std::exception_ptr failure;
  std::string message;
};

void write_bytes(png_structp png, png_bytep bytes, std::size_t count) {
  auto& writing = *static_cast<Writing*>(png_get_io_ptr(png));
  try {
    writing.stream->write({reinterpret_cast<const char*>(bytes), count});
    return;
  } catch (...) {
    writing.failure = std::current_exception();
  }
  png_error(png, "writing failed");
}

void flush_bytes(png_structp) {}

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  static_cast<Writing*>(png_get_error_ptr(png))->message = message;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

/// False if libpng gave up. No object with a destructor may live in this function: longjmp would skip it.
bool encode(png_structp png, png_infop info, Writing* writing, const Image<Rgb8>* picture, const Pieces* pieces) {
  if (setjmp(png_jmpbuf(png))) return false;  // NOLINT: libpng's way
  png_set_write_fn(png, writing, write_bytes, flush_bytes);
  png_set_IHDR(png, info, static_cast<png_uint_32>(picture->width()), static_cast<png_uint_32>(picture->height()), 8,
               PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  for (std::size_t k = 0; k < pieces->size(); ++k)
    png_write_chunk(png, reinterpret_cast<png_const_bytep>("IDAT"), (*pieces)[k].data(), (*pieces)[k].size());
  png_write_chunk(png, reinterpret_cast<png_const_bytep>("IEND"), nullptr, 0);
  return true;
}

}  // namespace

void write_png(const std::string& path, const Image<Rgb8>& picture) {
  static_assert(sizeof(Rgb8) == 3);
  if (picture.empty()) throw Error(ErrorCode::invalid_argument, path + ": a picture without pixels cannot be written");
  const Pieces pieces = compressed_rows(picture, kCompressionLevel);
  TemporaryStream stream(path);
  Writing writing{&stream, {}, {}};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writing, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const bool encoded = info && encode(png, info, &writing, &picture, &pieces);
  png_destroy_write_struct(&png, &info);
  if (writing.failure) std::rethrow_exception(writing.failure);
  if (!encoded) {
    ErrorDetail detail;
    detail.problem = "the picture cannot be encoded as PNG: " + writing.message;
    detail.path = path;
    throw Error(ErrorCode::invalid_argument, detail);
  }
  stream.commit();
}

}  // namespace meniscus
