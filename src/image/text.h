#pragma once

#include <string_view>

#include "meniscus/image.h"

namespace meniscus {

/// Letters are drawn on a grid of square units: capitals are 7 units high, descenders reach 2 below them.
constexpr int kCapitalUnits = 7;
constexpr int kLineUnits = 9;

/// Width of one line of text, in units.
int text_width_units(std::string_view text);

/// Draws one line of text; what lies outside of the picture is cut off.
/// @param text  printable ASCII; every other character is drawn as "?"
/// @param x, y  top left corner of the first letter, px
/// @param unit  edge of a unit, px, >= 1
void draw_text(Image<Rgb8>& picture, std::string_view text, int x, int y, int unit, Rgb8 colour);

/// Mixes a rectangle of the picture with a colour: `opacity` 0 leaves it, 1 replaces it.
void fill_rectangle(Image<Rgb8>& picture, int x, int y, int width, int height, Rgb8 colour, float opacity = 1);

}  // namespace meniscus
