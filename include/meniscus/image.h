/// From radiance to pictures: exposure, tone curve, sRGB, resampling; and how far two pictures differ.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// 8-bit sRGB.
struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

enum class ToneCurve { filmic, linear };
struct ToneOptions {
  float exposure_ev = 0.0f;  ///< stops
  ToneCurve curve = ToneCurve::filmic;
};
/// Linear radiance to display-linear [0, 1] by exposure and curve; non-decreasing in each channel.
vec3 tone_mapped(vec3 radiance, const ToneOptions& options);
/// sRGB transfer function, [0, 1] to [0, 1], and its inverse.
float srgb_from_linear(float linear);
float linear_from_srgb(float srgb);
/// tone_mapped, then sRGB, then rounding to 8 bits with a fixed ordered dither against banding.
Image<Rgb8> developed(const Image<vec3>& radiance, const ToneOptions& options);

struct ImageDifference {
  double psnr_db = 0;         ///< over all channels of 8-bit sRGB values; infinity when equal
  double ssim = 0;            ///< Wang 2004, luma, 11 x 11 Gaussian window sigma 1.5, mean
  double max_difference = 0;  ///< largest channel difference, 0..255
  std::size_t pixels_differing = 0;
};
/// @throws Error invalid_argument: sizes differ
ImageDifference compare(const Image<Rgb8>& a, const Image<Rgb8>& b);

/// A colour bar with its title and the values at its ends and middle, drawn into the lower right corner.
/// @param colour_at  linear RGB at t in [0, 1]
void draw_legend(Image<Rgb8>& picture, std::string_view title, float low, float high,
                 FunctionRef<vec3(float)> colour_at);

}  // namespace meniscus
