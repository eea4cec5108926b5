#include "surface/picture_levels.h"

#include <cmath>

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kWidestLevel = 0.6f;    ///< spacings between known pixels
constexpr float kClose = 0.4f;          ///< spacings between known pixels, for interpolation to do
constexpr float kSmooth = 0.1f;         ///< spacings of second differences, up to which it does
constexpr float kGuess = 1.0f;          ///< the same, for a first guess
constexpr float kFarthestEntry = 3.0f;  ///< spacings before the surface
constexpr float kEntryJump = 0.3f;      ///< spacings by which the entry may come earlier than its neighbours'
constexpr int kTile = 16, kHalf = kTile / 2;
constexpr int kHalo = 1, kRow = kHalf + 1 + 2 * kHalo;  ///< known pixels of a tile and around it

float cubic(float a, float b, float c, float d) { return 0.5625f * (b + c) - 0.0625f * (a + d); }

}  // namespace

int first_stride(const RaycastField& field, const View& view, const SurfaceBuffers& buffers) {
  if (view.projection == Projection::cube) return 1;
  std::size_t hits = 0, two = 0, four = 0;
  for (int y = 4; y < view.height; y += 8)
    for (int x = 4; x < view.width; x += 8) {
      if (!(buffers.entry(x, y) <= buffers.exit(x, y))) continue;
      const float pixel = view.pixel_size(buffers.entry(x, y)) / field.options.spacing;
      ++hits;
      two += 2.0f * pixel <= kWidestLevel;
      four += 4.0f * pixel <= kWidestLevel;
    }
  return 2 * four > hits ? 4 : 2 * two > hits ? 2 : 1;
}

Foretelling::Foretelling(const RaycastField& field, const View& view, const SurfaceBuffers& buffers,
                         const Image<float>& known, int stride)
    : buffers_(buffers),
      known_(known),
      stride_(stride),
      spacing_(field.options.spacing),
      size_at_zero_(view.pixel_size(0.0f)),
      size_per_metre_(view.pixel_size(1.0f) - size_at_zero_) {}

void Foretelling::tile(int x0, int y0, int x1, int y1, Image<float>& depth, TilePixels& open,
                       TilePixels& unknown) const {
  // Known depths and their distance from the entry, of the tile and around it.
  float around[kRow][kRow], gap[kRow][kRow];
  for (int j = 0; j < kRow; ++j)
    for (int i = 0; i < kRow; ++i) {
      const int x = x0 / 2 + i - kHalo, y = y0 / 2 + j - kHalo;
      const bool within = x >= 0 && y >= 0 && x < known_.width() && y < known_.height();
      around[j][i] = within ? known_(x, y) : kInfinity;
      gap[j][i] = within ? around[j][i] - buffers_.entry(2 * stride_ * x, 2 * stride_ * y) : kInfinity;
    }
  // Their largest second difference, across or down.
  float bend[kRow][kRow];
  for (int j = 1; j + 1 < kRow; ++j)
    for (int i = 1; i + 1 < kRow; ++i)
      bend[j][i] = std::max(std::abs(2.0f * around[j][i] - around[j][i - 1] - around[j][i + 1]),
                            std::abs(2.0f * around[j][i] - around[j - 1][i] - around[j + 1][i]));
  const float farthest = kFarthestEntry * spacing_, jump = kEntryJump * spacing_;
  const float widest = kWidestLevel * spacing_ / (2.0f * static_cast<float>(stride_));
  const auto decide = [&](int x, int y, float linear, float smooth, float most, float rough) {
    if (x >= x1 || y >= y1) return;
    const float entry = buffers_.entry(x * stride_, y * stride_);
    if (!(entry <= buffers_.exit(x * stride_, y * stride_))) return;
    const float before = linear - entry, off = std::abs(smooth - linear);
    // Comparisons with what is not known, infinite or not a number, are false.
    const bool foretold = before <= farthest && before <= most + jump && before >= 0.0f &&
                          size_at_zero_ + size_per_metre_ * linear <= widest && rough <= kGuess * spacing_ &&
                          off <= 0.25f * kGuess * spacing_;
    if (!foretold) return unknown.add(x, y);
    depth(x, y) = smooth;
    const bool close = size_at_zero_ + size_per_metre_ * linear <= (kClose / kWidestLevel) * widest;
    if (!close || rough > kSmooth * spacing_ || off > 0.25f * kSmooth * spacing_) open.add(x, y);
  };
  // In the order of a Z-shaped curve, so that pixels drawn together lie near each other.
  for (int at = 0; at < kHalf * kHalf; ++at) {
    const int i = (at & 1) | (at >> 1 & 2) | (at >> 2 & 4), j = (at >> 1 & 1) | (at >> 2 & 2) | (at >> 3 & 4);
    const int x = x0 + 2 * i, y = y0 + 2 * j;
    if (x >= x1 || y >= y1) continue;
    const float(*rows)[kRow] = &around[j];
    const float here = rows[1][i + 1], right = rows[1][i + 2], below = rows[2][i + 1], across = rows[2][i + 2];
    depth(x, y) = here;
    float along[4];
    for (int k = 0; k < 4; ++k) along[k] = cubic(rows[k][i], rows[k][i + 1], rows[k][i + 2], rows[k][i + 3]);
    const auto most = [&](const float(*values)[kRow], int right_by, int down_by) {
      return std::max(std::max(values[j + 1][i + 1], values[j + 1][i + 1 + right_by]),
                      std::max(values[j + 1 + down_by][i + 1], values[j + 1 + down_by][i + 1 + right_by]));
    };
    decide(x + 1, y, 0.5f * (here + right), along[1], most(gap, 1, 0), most(bend, 1, 0));
    decide(x, y + 1, 0.5f * (here + below), cubic(rows[0][i + 1], here, below, rows[3][i + 1]), most(gap, 0, 1),
           most(bend, 0, 1));
    decide(x + 1, y + 1, 0.25f * (here + right + below + across), cubic(along[0], along[1], along[2], along[3]),
           most(gap, 1, 1), most(bend, 1, 1));
  }
}

}  // namespace meniscus
