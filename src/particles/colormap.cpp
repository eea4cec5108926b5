#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "meniscus/particles.h"

namespace meniscus {
namespace {

// Control points, sRGB, evenly spaced, linearly interpolated in sRGB as the maps' own programs do.

/// Every fifteenth of the 256 colours of viridis and magma (S. van der Walt and N. Smith, 2015, CC0).
constexpr std::array<std::array<float, 3>, 18> kViridis{{{0.26700f, 0.00487f, 0.32942f},
                                                         {0.28192f, 0.08967f, 0.41242f},
                                                         {0.28025f, 0.16569f, 0.47650f},
                                                         {0.26366f, 0.23763f, 0.51876f},
                                                         {0.23744f, 0.30520f, 0.54192f},
                                                         {0.20862f, 0.36775f, 0.55267f},
                                                         {0.18226f, 0.42618f, 0.55712f},
                                                         {0.15941f, 0.48224f, 0.55807f},
                                                         {0.13777f, 0.53749f, 0.55491f},
                                                         {0.12115f, 0.59274f, 0.54464f},
                                                         {0.12808f, 0.64775f, 0.52349f},
                                                         {0.18065f, 0.70140f, 0.48819f},
                                                         {0.27415f, 0.75199f, 0.43660f},
                                                         {0.39517f, 0.79748f, 0.36776f},
                                                         {0.53562f, 0.83579f, 0.28191f},
                                                         {0.68894f, 0.86545f, 0.18272f},
                                                         {0.84556f, 0.88733f, 0.09970f},
                                                         {0.99325f, 0.90616f, 0.14394f}}};
constexpr std::array<std::array<float, 3>, 18> kMagma{{{0.00146f, 0.00047f, 0.01387f},
                                                       {0.03552f, 0.02840f, 0.12521f},
                                                       {0.10281f, 0.06301f, 0.25785f},
                                                       {0.19146f, 0.06482f, 0.39615f},
                                                       {0.29137f, 0.06455f, 0.47546f},
                                                       {0.38430f, 0.09785f, 0.50100f},
                                                       {0.47578f, 0.13458f, 0.50792f},
                                                       {0.56917f, 0.16745f, 0.50410f},
                                                       {0.66491f, 0.19808f, 0.48884f},
                                                       {0.76108f, 0.23121f, 0.46016f},
                                                       {0.85213f, 0.27611f, 0.41857f},
                                                       {0.92594f, 0.34684f, 0.37496f},
                                                       {0.96968f, 0.44694f, 0.36031f},
                                                       {0.98936f, 0.55787f, 0.39167f},
                                                       {0.99658f, 0.66826f, 0.45619f},
                                                       {0.99673f, 0.77679f, 0.54104f},
                                                       {0.99244f, 0.88433f, 0.64010f},
                                                       {0.98705f, 0.99144f, 0.74950f}}};
/// The same of turbo (A. Mikhailov, 2019, Apache 2.0).
constexpr std::array<std::array<float, 3>, 18> kTurbo{{{0.18995f, 0.07176f, 0.23217f},
                                                       {0.24830f, 0.24143f, 0.61286f},
                                                       {0.27509f, 0.40072f, 0.86692f},
                                                       {0.26878f, 0.54995f, 0.99303f},
                                                       {0.18625f, 0.69775f, 0.95498f},
                                                       {0.10026f, 0.82955f, 0.81389f},
                                                       {0.13526f, 0.92197f, 0.66556f},
                                                       {0.32006f, 0.97974f, 0.47654f},
                                                       {0.54658f, 0.99907f, 0.29581f},
                                                       {0.71577f, 0.96875f, 0.20815f},
                                                       {0.85868f, 0.88655f, 0.21230f},
                                                       {0.96049f, 0.77181f, 0.22811f},
                                                       {0.99654f, 0.63193f, 0.18738f},
                                                       {0.97545f, 0.45740f, 0.11305f},
                                                       {0.91024f, 0.29599f, 0.04814f},
                                                       {0.80799f, 0.17753f, 0.01660f},
                                                       {0.66449f, 0.08436f, 0.00424f},
                                                       {0.47960f, 0.01583f, 0.01055f}}};
/// Every other of the 33 points of the smooth cool-warm map (K. Moreland, "Diverging Color Maps for Scientific
/// Visualization", 2009).
constexpr std::array<std::array<float, 3>, 17> kCoolwarm{{{0.22981f, 0.29872f, 0.75368f},
                                                          {0.30387f, 0.40654f, 0.84496f},
                                                          {0.38301f, 0.50942f, 0.91739f},
                                                          {0.46667f, 0.60456f, 0.96816f},
                                                          {0.55295f, 0.68893f, 0.99538f},
                                                          {0.63918f, 0.75960f, 0.99815f},
                                                          {0.72219f, 0.81395f, 0.97658f},
                                                          {0.79869f, 0.84979f, 0.93169f},
                                                          {0.86540f, 0.86541f, 0.86540f},
                                                          {0.92413f, 0.82739f, 0.77451f},
                                                          {0.95885f, 0.76977f, 0.67801f},
                                                          {0.96995f, 0.69427f, 0.57938f},
                                                          {0.95800f, 0.60284f, 0.48178f},
                                                          {0.92395f, 0.49731f, 0.38797f},
                                                          {0.86919f, 0.37831f, 0.30027f},
                                                          {0.79563f, 0.24128f, 0.22053f},
                                                          {0.70567f, 0.01556f, 0.15023f}}};
constexpr std::array<std::array<float, 3>, 2> kGrey{{{0, 0, 0}, {1, 1, 1}}};

std::span<const std::array<float, 3>> points_of(Colormap map) {
  switch (map) {
    case Colormap::viridis:
      return kViridis;
    case Colormap::magma:
      return kMagma;
    case Colormap::turbo:
      return kTurbo;
    case Colormap::coolwarm:
      return kCoolwarm;
    case Colormap::grey:
      return kGrey;
  }
  return kGrey;
}

/// The sRGB transfer function (IEC 61966-2-1), inverted.
float linear_of(float srgb) { return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f); }

}  // namespace

Colormap colormap_of(std::string_view name) {
  if (name == "viridis") return Colormap::viridis;
  if (name == "magma") return Colormap::magma;
  if (name == "turbo") return Colormap::turbo;
  if (name == "coolwarm") return Colormap::coolwarm;
  if (name == "grey" || name == "gray") return Colormap::grey;
  ErrorDetail detail;
  detail.problem = "there is no such colour map";
  detail.expected = "viridis, magma, turbo, coolwarm or grey";
  detail.found = name;
  throw Error(ErrorCode::invalid_argument, detail);
}

vec3 colormap_at(Colormap map, float t) {
  const auto points = points_of(map);
  const float place = (t > 0 ? std::min(t, 1.0f) : 0.0f) * static_cast<float>(points.size() - 1);  // NaN is 0
  const std::size_t i = std::min(static_cast<std::size_t>(place), points.size() - 2);
  const float f = place - static_cast<float>(i);
  const auto channel = [&](std::size_t c) { return linear_of((1 - f) * points[i][c] + f * points[i + 1][c]); };
  return {channel(0), channel(1), channel(2)};
}

}  // namespace meniscus
