#include "shading/draw_rain_tile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace meniscus {
namespace {

/// Lines thinner than this are drawn column by column, px.
constexpr float kThin = 0.75f;
/// Streaks from this radius on are drawn with the chords of their ball, px.
constexpr float kChords = 1.25f;

/// The greatest whole number that is not above x, for |x| <= 1e6: cheaper than std::floor.
int floored(float x) {
  const int towards_zero = static_cast<int>(x);
  return towards_zero - (x < static_cast<float>(towards_zero) ? 1 : 0);
}
/// The same for coordinates of any size, held around a tile.
int low_pixel(float x, int least) { return x > static_cast<float>(least) ? floored(std::min(x, 1e6f)) : least; }
int high_pixel(float x, int most) { return x < static_cast<float>(most) ? floored(std::max(x, -1e6f)) + 1 : most; }

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
  const int x0 = low_pixel(left, tile.x0), x1 = high_pixel(right, tile.x1);
  const int y0 = low_pixel(top, tile.y0), y1 = high_pixel(bottom, tile.y1);
  for (int y = y0; y < y1; ++y) {
    const float high = std::min(bottom, static_cast<float>(y + 1)) - std::max(top, static_cast<float>(y));
    if (!(high > 0)) continue;
    vec3* const row = tile.row(y);
    const float alpha = splat.alpha * high;
    for (int x = x0; x < x1; ++x) {
      const float wide = std::min(right, static_cast<float>(x + 1)) - std::max(left, static_cast<float>(x));
      if (!(wide > 0)) continue;
      const float seen = visible_part(picture.depth, x, y, splat.t0, splat.soft);
      blend(row[x], splat.colour, alpha * seen * wide);
    }
  }
}

/// A thin line by steps of a pixel along the axis of the picture that it is nearer to. Each step's share of the line
/// goes to the two pixels across that are next to it: the sum is the line's area wherever it stands.   [Wu1991]
template <bool upright>
void draw_thin(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  const float u = upright ? splat.uy : splat.ux, slope = (upright ? splat.ux : splat.uy) / u;
  const float start = upright ? splat.y : splat.x, beside = upright ? splat.x : splat.y;
  const float end = start + splat.length * u;
  const int along0 = upright ? tile.y0 : tile.x0, along1 = upright ? tile.y1 : tile.x1;
  const int across0 = upright ? tile.x0 : tile.y0, across1 = upright ? tile.x1 : tile.y1;
  const float low = std::min(start, end), high = std::max(start, end);
  const float per_length = 1.0f / (splat.length * u), per_way = 1.0f / std::abs(u);
  for (int i = low_pixel(low, along0); i < high_pixel(high, along1); ++i) {
    const float from = std::max(low, static_cast<float>(i)), to = std::min(high, static_cast<float>(i + 1));
    if (!(to > from)) continue;
    const float middle = 0.5f * (from + to) - start, along = middle * per_length;
    const float area = (to - from) * per_way * (splat.w0 + along * (splat.w1 - splat.w0)) * splat.alpha;
    const float t = splat.t0 + along * (splat.t1 - splat.t0);
    const float place = beside + middle * slope - 0.5f;
    if (!(place >= static_cast<float>(across0 - 1) && place < static_cast<float>(across1))) continue;
    const int j = floored(place);
    const float second = place - static_cast<float>(j);
    const auto put = [&](int k, float part) {
      if (k < across0 || k >= across1) return;
      const int x = upright ? k : i, y = upright ? i : k;
      blend(tile.row(y)[x], splat.colour,
            std::min(1.0f, part * area * visible_part(picture.depth, x, y, t, splat.soft)));
    };
    put(j, 1.0f - second);
    put(j + 1, second);
  }
}

/// Share of the time in which a ball that goes from 0 to `length` covers a pixel at (u, v): its chord's way past it, in
/// the mean of two points across. Ends are as round and soft as they are. @param radius  px, > 0
float chord_part(float u, float v, float length, float radius) {
  constexpr float kPoint = 0.2886751f;  // Gauss
  const float low = v - kPoint, high = v + kPoint, radius2 = radius * radius;
  const float chord =
      0.5f * (std::sqrt(std::max(0.0f, radius2 - low * low)) + std::sqrt(std::max(0.0f, radius2 - high * high)));
  const float whole = std::max(length, 1e-3f);
  return std::max(0.0f, std::min(u + chord, whole) - std::max(u - chord, 0.0f)) / whole;
}

void draw_line(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  if (std::max(splat.w0, splat.w1) < kThin)
    return std::abs(splat.uy) > std::abs(splat.ux) ? draw_thin<true>(picture, tile, splat)
                                                   : draw_thin<false>(picture, tile, splat);
  const float radius = 0.25f * (splat.w0 + splat.w1);
  const bool chords = splat.round && radius > kChords;
  // The splat is as long as the way of the ball's centre and a mean chord; its opacity is the mean of what it covers.
  constexpr float kPi = std::numbers::pi_v<float>;
  const float inset = 0.25f * kPi * radius, way = splat.length - 2.0f * inset;
  const float per_mean = 2.0f * splat.length / (kPi * radius);
  const float reach = 0.5f * std::max(splat.w0, splat.w1) + kRainFilter;
  const float end_x = splat.x + splat.length * splat.ux, end_y = splat.y + splat.length * splat.uy;
  const int y0 = low_pixel(std::min(splat.y, end_y) - reach, tile.y0);
  const int y1 = high_pixel(std::max(splat.y, end_y) + reach, tile.y1);
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
    const int x0 = low_pixel(left, tile.x0), x1 = high_pixel(right, tile.x1);
    vec3* const row = tile.row(y);
    for (int x = x0; x < x1; ++x) {
      const float dx = static_cast<float>(x) + 0.5f - splat.x;
      const float u = splat.ux * dx + splat.uy * dy, v = splat.ux * dy - splat.uy * dx;
      const float along = std::clamp(u * per_length, 0.0f, 1.0f);
      const float half = 0.5f * (splat.w0 + along * (splat.w1 - splat.w0));
      float covered = 0;
      if (chords) {
        covered = chord_part(u - inset, v, way, half) * per_mean;
      } else {
        covered = filtered_step(v + half) - filtered_step(v - half);
        if (!(covered > 0)) continue;
        covered *= filtered_step(u) - filtered_step(u - splat.length);
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
