#include "shading/draw_rain_tile.h"

#include <algorithm>
#include <cmath>

namespace meniscus {
namespace {

/// Lines shorter and thinner than this are drawn as dots, px.
constexpr float kChainLength = 4, kChainWidth = 0.75f;

/// Integral of the quadratic B-spline from the far left to x: a filter of 3 px with the standard deviation of half a
/// pixel. Sampled once a pixel, shapes of any direction keep their area within a per cent wherever they stand.
float filtered_step(float x) {
  if (x <= -1.5f) return 0;
  if (x >= 1.5f) return 1;
  if (x < -0.5f) {
    const float a = x + 1.5f;
    return a * a * a * (1.0f / 6.0f);
  }
  if (x > 0.5f) {
    const float a = 1.5f - x;
    return 1.0f - a * a * a * (1.0f / 6.0f);
  }
  return 0.5f + x * (0.75f - x * x * (1.0f / 3.0f));
}

/// The squares of pixels and the dot cut out of each other: their sum is the dot's area wherever it stands.
void draw_dot(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  const float half = 0.5f * splat.w0;
  const float left = splat.x - half, right = splat.x + half, top = splat.y - half, bottom = splat.y + half;
  const int x0 = std::max(tile.x0, static_cast<int>(std::floor(left)));
  const int x1 = std::min(tile.x1, static_cast<int>(std::ceil(right)));
  const int y0 = std::max(tile.y0, static_cast<int>(std::floor(top)));
  const int y1 = std::min(tile.y1, static_cast<int>(std::ceil(bottom)));
  for (int y = y0; y < y1; ++y) {
    const float high = std::min(bottom, static_cast<float>(y + 1)) - std::max(top, static_cast<float>(y));
    vec3* const row = picture.radiance.row(y);
    for (int x = x0; x < x1; ++x) {
      const float wide = std::min(right, static_cast<float>(x + 1)) - std::max(left, static_cast<float>(x));
      const float seen = visible_part(picture.depth, x, y, splat.t0, splat.soft);
      blend(row[x], splat.colour, splat.alpha * seen * (wide * high));
    }
  }
}

/// A short thin line as dots a pixel or less apart, with the same area at a third of the cost.
void draw_chain(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  const float links = std::ceil(splat.length), step = splat.length / links;
  Splat dot = splat;
  dot.w0 = dot.w1 = 1;
  for (float k = 0.5f; k < links; ++k) {
    const float along = k / links;
    dot.x = splat.x + k * step * splat.ux;
    dot.y = splat.y + k * step * splat.uy;
    dot.t0 = splat.t0 + along * (splat.t1 - splat.t0);
    dot.alpha = splat.alpha * step * (splat.w0 + along * (splat.w1 - splat.w0));
    draw_dot(picture, tile, dot);
  }
}

void draw_line(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  if (splat.length < kChainLength && std::max(splat.w0, splat.w1) < kChainWidth)
    return draw_chain(picture, tile, splat);
  const float reach = 0.5f * std::max(splat.w0, splat.w1) + kRainFilter;
  const float end_x = splat.x + splat.length * splat.ux, end_y = splat.y + splat.length * splat.uy;
  const float low = std::min(splat.y, end_y) - reach, high = std::max(splat.y, end_y) + reach;
  const int y0 = std::max(tile.y0, static_cast<int>(std::max(std::floor(low), 0.0f)));
  const int y1 = std::min(tile.y1, static_cast<int>(std::ceil(std::min(high, 1e6f))));
  const float per_length = 1.0f / splat.length;
  for (int y = y0; y < y1; ++y) {
    const float dy = static_cast<float>(y) + 0.5f - splat.y;
    // Where the row is within reach of the axis: |ux dy - uy dx| < reach, and of its ends.
    float left = std::min(splat.x, end_x) - reach, right = std::max(splat.x, end_x) + reach;
    if (std::abs(splat.uy) > 1e-3f) {
      const float middle = splat.x + splat.ux * dy / splat.uy, half = reach / std::abs(splat.uy);
      left = std::max(left, middle - half);
      right = std::min(right, middle + half);
    }
    const int x0 = std::max(tile.x0, static_cast<int>(std::floor(std::max(left, -1.0f))));
    const int x1 = std::min(tile.x1, static_cast<int>(std::ceil(std::min(right, 1e6f))));
    vec3* const row = picture.radiance.row(y);
    for (int x = x0; x < x1; ++x) {
      const float dx = static_cast<float>(x) + 0.5f - splat.x;
      const float u = splat.ux * dx + splat.uy * dy, v = splat.ux * dy - splat.uy * dx;
      const float along = std::clamp(u * per_length, 0.0f, 1.0f);
      const float half = 0.5f * (splat.w0 + along * (splat.w1 - splat.w0));
      float covered = filtered_step(v + half) - filtered_step(v - half);
      if (!(covered > 0)) continue;
      covered *= filtered_step(u) - filtered_step(u - splat.length);
      // Chords of a ball: 4 / pi sqrt(1 - s^2) in the mean over its width one; seen where it is wider than the filter.
      if (splat.round && half > 1.0f) {
        const float s = v / (half + 0.5f), chord = 1.2732395f * std::sqrt(std::max(0.0f, 1.0f - s * s));
        covered *= 1.0f + std::min(1.0f, 0.5f * half - 0.5f) * (chord - 1.0f);
      }
      if (!(covered > 0)) continue;
      const float seen = visible_part(picture.depth, x, y, splat.t0 + along * (splat.t1 - splat.t0), splat.soft);
      blend(row[x], splat.colour, std::min(1.0f, splat.alpha * seen * covered));
    }
  }
}

}  // namespace

float visible_part(const Image<float>& depth, int x, int y, float t, float soft) {
  const float here = depth(x, y);
  if (here >= t + soft) return 1;
  // The lesser of the differences to both sides: that over an edge is none of the surface's own.
  const auto slope = [&](float before, float after) {
    const float step = std::min(std::abs(here - before), std::abs(after - here));
    return step < 1e30f ? step : 0.0f;
  };
  const float* const row = depth.row(y);
  float within = 0;
  if (depth.width() > 2) {
    const int left = x > 0 ? x - 1 : x + 1, right = x + 1 < depth.width() ? x + 1 : x - 1;
    within += slope(row[left], row[right]);
  }
  if (depth.height() > 2) {
    const int above = y > 0 ? y - 1 : y + 1, below = y + 1 < depth.height() ? y + 1 : y - 1;
    within += slope(depth(x, above), depth(x, below));
  }
  const float seen = 0.5f + (here + 1.5f * within - t) / (2.0f * soft);
  return seen > 0 ? std::min(seen, 1.0f) : 0.0f;
}

void draw_splat(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  switch (splat.kind) {
    case Splat::Kind::dot:
      return draw_dot(picture, tile, splat);
    case Splat::Kind::line:
      return draw_line(picture, tile, splat);
    default:
      return draw_body(picture, tile, splat);
  }
}

}  // namespace meniscus
