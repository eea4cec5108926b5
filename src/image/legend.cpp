#include <algorithm>
#include <array>
#include <cmath>

#include "image/short_number.h"
#include "image/text.h"
#include "meniscus/image.h"

namespace meniscus {
namespace {

constexpr Rgb8 kPanelColour{12, 13, 16};
constexpr Rgb8 kTextColour{240, 240, 240};
constexpr float kPanelOpacity = 0.7f;  // white letters keep a contrast of 6 to 1 on it over a white picture

// Sizes in units of the font's grid.
constexpr int kPadding = 6;     // panel to what it holds
constexpr int kMargin = 6;      // picture to panel
constexpr int kBarWidth = 120;  // at least, where the picture is wide enough
constexpr int kBarHeight = 8;
constexpr int kGap = 4;      // between title, bar and values; also the ticks' length and half
constexpr int kBetween = 8;  // between two values

/// What there is room for.
struct Layout {
  int unit = 1;    // px
  int inside = 0;  // width of the bar, units
  int padding = kPadding;
  int margin = kMargin;
  std::string title;                  // empty: not drawn
  std::array<std::string, 3> values;  // low, middle, high; empty: not drawn
  bool any_value() const { return !values[0].empty(); }
  int width() const { return inside + 2 * padding; }
  int height() const {
    return 2 * padding + (title.empty() ? 0 : kLineUnits + kGap) + kBarHeight +
           (any_value() ? kGap + kCapitalUnits : 0);
  }
};

/// The values at the ends and in the middle, with as many digits as tell them apart.
std::array<std::string, 3> labels(float low, float high) {
  const double ends[2] = {low, high};
  const double middle = 0.5 * ends[0] + 0.5 * ends[1];
  std::array<std::string, 3> result;
  for (int digits = 3; digits <= 7; ++digits) {
    result = {short_number(ends[0], digits), short_number(middle, digits), short_number(ends[1], digits)};
    if (low == high || (result[0] != result[1] && result[1] != result[2])) break;
  }
  return result;
}

/// The title itself or its beginning and "..", at most `room` units wide.
std::string shortened(std::string_view title, int room) {
  if (text_width_units(title) <= room) return std::string(title);
  while (!title.empty()) {
    title.remove_suffix(1);
    const std::string shorter = std::string(title) + "..";
    if (text_width_units(shorter) <= room) return title.empty() ? std::string() : shorter;
  }
  return {};
}

Layout laid_out(int picture_width, int picture_height, std::string_view title, float low, float high) {
  Layout layout;
  layout.values = labels(low, high);
  // Units that the ends' values need, and all three: the middle one is centred between them.
  const int end = std::max(text_width_units(layout.values[0]), text_width_units(layout.values[2]));
  const int two = 2 * end + kBetween;
  const int three = 2 * end + text_width_units(layout.values[1]) + 2 * kBetween;
  const int wanted = std::max(kBarWidth, three);

  // Letters are 1/45 of the picture's height, but the panel takes no more than two thirds of its width.
  layout.unit = std::max(1, static_cast<int>(std::lround(static_cast<float>(picture_height) / 320.0f)));
  while (layout.unit > 1 && 3 * layout.unit * (wanted + 2 * kPadding) > 2 * picture_width) --layout.unit;
  const int across = picture_width / layout.unit, down = picture_height / layout.unit;

  // Where that is not enough: no margin, no padding to speak of, then fewer parts.
  if (wanted + 2 * (kPadding + kMargin) > across || layout.height() + 2 * kMargin > down) {
    layout.margin = 1;
    layout.padding = 2;
  }
  const int room = std::max(1, across - 2 * (layout.padding + layout.margin));
  const int comfortable = std::max(wanted, std::min(text_width_units(title), 2 * across / 3));
  layout.inside = std::min(comfortable, room);
  layout.title = shortened(title, layout.inside);
  if (three > layout.inside) layout.values[1].clear();
  if (two > layout.inside) layout.values = {};
  if (layout.height() + 2 * layout.margin > down) layout.values = {};
  if (layout.height() + 2 * layout.margin > down) layout.title.clear();
  return layout;
}

std::uint8_t eight_bits(float linear) { return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(linear))); }

}  // namespace

void draw_legend(Image<Rgb8>& picture, std::string_view title, float low, float high,
                 FunctionRef<vec3(float)> colour_at) {
  if (picture.empty()) return;
  const Layout layout = laid_out(picture.width(), picture.height(), title, low, high);
  const int unit = layout.unit;

  // The panel in the lower right corner.
  const int panel_x = picture.width() - unit * (layout.width() + layout.margin);
  const int panel_y = picture.height() - unit * (layout.height() + layout.margin);
  fill_rectangle(picture, panel_x, panel_y, unit * layout.width(), unit * layout.height(), kPanelColour, kPanelOpacity);
  const int left = panel_x + unit * layout.padding;
  const int width = unit * layout.inside;
  int y = panel_y + unit * layout.padding;

  if (!layout.title.empty()) {
    draw_text(picture, layout.title, left, y, unit, kTextColour);
    y += unit * (kLineUnits + kGap);
  }

  // The bar: one colour a column; its first and last columns are the ends' colours.
  for (int column = 0; column < width; ++column) {
    const vec3 c = colour_at(width > 1 ? static_cast<float>(column) / static_cast<float>(width - 1) : 0.5f);
    fill_rectangle(picture, left + column, y, 1, unit * kBarHeight,
                   {eight_bits(c.x), eight_bits(c.y), eight_bits(c.z)});
  }
  y += unit * kBarHeight;

  // Ticks and values: the first flush left, the last flush right, the middle one centred.
  if (!layout.any_value()) return;
  for (std::size_t i = 0; i < 3; ++i) {
    if (layout.values[i].empty()) continue;
    const int tick = left + static_cast<int>(i) * (width - unit) / 2;
    fill_rectangle(picture, tick, y, unit, unit * kGap / 2, kTextColour);
    const int slack = width - unit * (text_width_units(layout.values[i]) - 1);  // the last unit is a letter's gap
    draw_text(picture, layout.values[i], left + static_cast<int>(i) * slack / 2, y + unit * kGap, unit, kTextColour);
  }
}

}  // namespace meniscus
