/// From radiance to pictures: exposure, tone curve, sRGB, resampling; and how far two pictures differ.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// 8-bit sRGB.
struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

// --- From radiance to pictures -----------------------------------------------------------------------------

enum class ToneCurve { filmic, linear };
struct ToneOptions {
  float exposure_ev = 0.0f;  ///< stops
  ToneCurve curve = ToneCurve::filmic;
};
/// Linear radiance to display-linear [0, 1] by exposure and curve.
///
/// filmic is the fit of [Narkowicz2016], scaled so that mid grey, 0.18, stays 0.18 and 10 is white; a colour
/// that is brighter than the display loses saturation on its way to white (docs/output.md). linear cuts off
/// at 1. Both are non-decreasing: more of any channel never makes any channel darker. Grey stays grey.
/// Negative values and NaN are black, infinity is white.
vec3 tone_mapped(vec3 radiance, const ToneOptions& options);
/// The sRGB transfer function, [0, 1] to [0, 1], and its inverse; arguments are clamped. (IEC 61966-2-1)
float srgb_from_linear(float linear);
float linear_from_srgb(float srgb);
/// tone_mapped, then sRGB, then rounding to 8 bits with a fixed ordered dither against banding: less than half
/// of a step, so that 0 stays 0, 1 stays 255, and every value becomes one of its two neighbours.
Image<Rgb8> developed(const Image<vec3>& radiance, const ToneOptions& options);

// --- Averages of radiance ----------------------------------------------------------------------------------

/// Average of the samples of one pixel, each weighted by 1 / (1 + luma) [Karis2013].
///
/// In the plain mean one sample of the sun's glitter decides its whole pixel, and an edge that was sampled
/// sixteen times is jagged again. The weights keep the average of samples near what their tone-mapped average
/// would be; equal samples average to themselves. BT.709 luma; NaN counts as 0 and infinity as the largest
/// float. Zero for no samples.
vec3 averaged(std::span<const vec3> samples);
/// The picture at 1/factor of its size: averaged() over squares of factor x factor pixels.
/// @throws Error invalid_argument: factor < 1, or width or height not a multiple of it
Image<vec3> downsampled(const Image<vec3>& radiance, int factor);

// --- Comparison --------------------------------------------------------------------------------------------

struct ImageDifference {
  double psnr_db = 0;         ///< over all channels of 8-bit sRGB values; infinity when equal
  double ssim = 1;            ///< [Wang2004]: BT.709 luma, mean over all 11 x 11 Gaussian windows (sigma 1.5) inside
  double max_difference = 0;  ///< largest channel difference, 0..255
  std::size_t pixels_differing = 0;
};
/// How far two pictures differ. A picture narrower or lower than 11 pixels is one window in that direction.
/// @throws Error invalid_argument: sizes differ
ImageDifference compare(const Image<Rgb8>& a, const Image<Rgb8>& b);

// --- Drawing into pictures ---------------------------------------------------------------------------------

/// A colour bar with its title and the values at its ends and middle, drawn into the lower right corner on a
/// dark translucent panel. Letters grow with the picture's height. Where the picture is too small for all of
/// it, the title is shortened, then the middle value, all values and the title are left out in turn.
/// @param title      ASCII; other characters are drawn as "?"
/// @param low, high  written with 3 significant digits, with more where 3 cannot tell them apart
/// @param colour_at  linear RGB at t in [0, 1]
void draw_legend(Image<Rgb8>& picture, std::string_view title, float low, float high,
                 FunctionRef<vec3(float)> colour_at);

}  // namespace meniscus
