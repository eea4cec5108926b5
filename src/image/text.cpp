#include "image/text.h"

#include <stb_easy_font.h>
#include <algorithm>
#include <cmath>
#include <string>

namespace meniscus {
namespace {

/// The font knows ' ' to '~' and indexes its table unchecked. A character of several bytes is one "?".
std::string printable(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xC0u) == 0x80u) continue;  // inside a UTF-8 character
    result += c >= ' ' && c <= '~' ? c : '?';
  }
  return result;
}

std::uint8_t mixed(std::uint8_t from, std::uint8_t to, float weight) {
  return static_cast<std::uint8_t>(
      std::lround((1 - weight) * static_cast<float>(from) + weight * static_cast<float>(to)));
}

/// One corner, as the font writes it.
struct Vertex {
  float x, y, z;
  unsigned char colour[4];
};
static_assert(sizeof(Vertex) == 16);
constexpr std::size_t kQuadsPerLetter = 16;  // no letter of the font needs more

}  // namespace

int text_width_units(std::string_view text) {
  std::string line = printable(text);
  return stb_easy_font_width(line.data());
}

void draw_text(Image<Rgb8>& picture, std::string_view text, int x, int y, int unit, Rgb8 colour) {
  std::string line = printable(text);
  std::vector<Vertex> corners(4 * kQuadsPerLetter * (line.size() + 1));
  const int quads = stb_easy_font_print(0, 0, line.data(), nullptr, corners.data(),
                                        static_cast<int>(corners.size() * sizeof(Vertex)));
  // Quads are axis-aligned on whole units; corners 0 and 2 are opposite.
  for (std::size_t i = 0; i < static_cast<std::size_t>(quads); ++i) {
    const Vertex& low = corners[4 * i];
    const Vertex& high = corners[4 * i + 2];
    const int left = static_cast<int>(low.x), top = static_cast<int>(low.y);
    fill_rectangle(picture, x + unit * left, y + unit * top, unit * (static_cast<int>(high.x) - left),
                   unit * (static_cast<int>(high.y) - top), colour);
  }
}

void fill_rectangle(Image<Rgb8>& picture, int x, int y, int width, int height, Rgb8 colour, float opacity) {
  const int right = std::min(x + width, picture.width());
  const int bottom = std::min(y + height, picture.height());
  for (int row = std::max(y, 0); row < bottom; ++row)
    for (int column = std::max(x, 0); column < right; ++column) {
      Rgb8& pixel = picture(column, row);
      pixel = {mixed(pixel.r, colour.r, opacity), mixed(pixel.g, colour.g, opacity), mixed(pixel.b, colour.b, opacity)};
    }
}

}  // namespace meniscus
