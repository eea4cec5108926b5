#include "surface/picture_levels.h"

#include "surface/z_curve.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/picture_levels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef MENISCUS_SURFACE_PICTURE_LEVELS_TILE
#define MENISCUS_SURFACE_PICTURE_LEVELS_TILE
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
constexpr int kPitch = 24;                              ///< of their rows: vectors from any of them on stay within

/// What a tile is foretold from and what comes of it.
struct ForetoldTile {
  // Known depths and their distance from the entry, of the tile and around it.
  float around[kRow][kPitch], gap[kRow][kPitch];
  // Of all pixels of the tile; the entry is infinite where there is nothing to foretell.
  alignas(64) float entry[kTile][kTile];
  alignas(64) float depth[kTile][kTile];  ///< infinite where it is not foretold
  /// By known pixel: bits 0 to 2: the right, lower and lower right neighbour has to be corrected; 3 to 5: to be
  /// marched.
  alignas(64) std::int32_t left[kHalf][kHalf];
  float spacing, size_at_zero, size_per_metre;
  float widest;  ///< m, of a pixel
};

}  // namespace
}  // namespace meniscus
#endif

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, kHalf);
using Vec = hn::Vec<Tag>;

HWY_INLINE Vec cubic(Vec a, Vec b, Vec c, Vec e) {
  const Tag d;
  return hn::NegMulAdd(hn::Set(d, 0.0625f), hn::Add(a, e), hn::Mul(hn::Set(d, 0.5625f), hn::Add(b, c)));
}

class TileForeteller {
 public:
  explicit TileForeteller(ForetoldTile& tile) : tile_(tile) {}

  void run() {
    const int lanes = static_cast<int>(hn::Lanes(Tag()));
    for (int j = 1; j + 1 < kRow; ++j)
      for (int i = 0; i < kHalf + 1; i += lanes) find_bends(j, i);
    for (int j = 0; j < kHalf; ++j)
      for (int i = 0; i < kHalf; i += lanes) foretell(j, i);
  }

 private:
  /// The largest second difference, across or down, of known pixels from (i + 1, j) on.
  HWY_INLINE void find_bends(int j, int i) {
    const Tag d;
    const float(*rows)[kPitch] = &tile_.around[j - 1];
    const Vec here = hn::LoadU(d, rows[1] + i + 1), twice = hn::Add(here, here);
    const Vec across = hn::Sub(twice, hn::Add(hn::LoadU(d, rows[1] + i), hn::LoadU(d, rows[1] + i + 2)));
    const Vec down = hn::Sub(twice, hn::Add(hn::LoadU(d, rows[0] + i + 1), hn::LoadU(d, rows[2] + i + 1)));
    hn::StoreU(hn::Max(hn::Abs(across), hn::Abs(down)), d, bend_[j] + i + 1);
  }

  /// The neighbours of the known pixels from (i, j) of the tile on.
  HWY_INLINE void foretell(int j, int i) {
    const Tag d;
    const auto known = [&](int down, int right) { return hn::LoadU(d, tile_.around[j + down] + i + right); };
    const Vec here = known(1, 1), right = known(1, 2), below = known(2, 1), across = known(2, 2);
    Vec along[4];
    for (int k = 0; k < 4; ++k) along[k] = cubic(known(k, 0), known(k, 1), known(k, 2), known(k, 3));
    const Vec half = hn::Set(d, 0.5f);
    const Vec pair = hn::Add(here, right);
    Vec left = hn::Zero(d);
    const Vec right_of = decide(j, i, 0, hn::Mul(half, pair), along[1], left);
    const Vec below_of =
        decide(j, i, 1, hn::Mul(half, hn::Add(here, below)), cubic(known(0, 1), here, below, known(3, 1)), left);
    const Vec across_of = decide(j, i, 2, hn::Mul(hn::Set(d, 0.25f), hn::Add(pair, hn::Add(below, across))),
                                 cubic(along[0], along[1], along[2], along[3]), left);
    hn::Store(hn::ConvertTo(hn::RebindToSigned<Tag>(), left), hn::RebindToSigned<Tag>(), tile_.left[j] + i);
    hn::StoreInterleaved2(here, right_of, d, tile_.depth[2 * j] + 2 * i);
    hn::StoreInterleaved2(below_of, across_of, d, tile_.depth[2 * j + 1] + 2 * i);
  }

  /// @param which  neighbour: 0 right, 1 below, 2 across
  /// @param left   gets its bits of ForetoldTile::left
  /// @return  its depth, infinite where it is not foretold
  HWY_INLINE Vec decide(int j, int i, int which, Vec linear, Vec smooth, Vec& left) {
    const Tag d;
    const int to_right = which != 1, down = which != 0;
    const auto most = [&](const float(*values)[kPitch]) {
      const auto at = [&](int y, int x) { return hn::LoadU(d, values[j + 1 + y] + i + 1 + x); };
      return hn::Max(hn::Max(at(0, 0), at(0, to_right)), hn::Max(at(down, 0), at(down, to_right)));
    };
    Vec even, odd;
    hn::LoadInterleaved2(d, tile_.entry[2 * j + down] + 2 * i, even, odd);
    const Vec entry = to_right ? odd : even, infinity = hn::Set(d, kInfinity);
    const auto hit = hn::Lt(entry, infinity);
    const float spacing = tile_.spacing;
    const Vec before = hn::Sub(linear, entry), off = hn::Abs(hn::Sub(smooth, linear)), rough = most(bend_);
    const Vec size = hn::MulAdd(hn::Set(d, tile_.size_per_metre), linear, hn::Set(d, tile_.size_at_zero));
    const auto up_to = [&](Vec value, float limit) { return hn::Le(value, hn::Set(d, limit)); };
    // Comparisons with what is not known, infinite or not a number, are false.
    auto foretold = hn::And(up_to(before, kFarthestEntry * spacing), hn::Ge(before, hn::Zero(d)));
    foretold = hn::And(foretold, hn::Le(before, hn::Add(most(tile_.gap), hn::Set(d, kEntryJump * spacing))));
    foretold = hn::And(foretold, hn::And(up_to(size, tile_.widest), up_to(rough, kGuess * spacing)));
    foretold = hn::And(hit, hn::And(foretold, up_to(off, 0.25f * kGuess * spacing)));
    const auto close = up_to(size, (kClose / kWidestLevel) * tile_.widest);
    const auto good = hn::And(close, hn::And(up_to(rough, kSmooth * spacing), up_to(off, 0.25f * kSmooth * spacing)));
    const auto add = [&](hn::Mask<Tag> mask, int bit) {
      left = hn::Add(left, hn::IfThenElseZero(mask, hn::Set(d, static_cast<float>(1 << bit))));
    };
    add(hn::AndNot(good, foretold), which);
    add(hn::AndNot(foretold, hit), 3 + which);
    return hn::IfThenElse(foretold, smooth, infinity);
  }

  ForetoldTile& tile_;
  float bend_[kRow][kPitch];
};

}  // namespace

void Foretell(ForetoldTile& tile) { TileForeteller(tile).run(); }

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(Foretell);

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
  ForetoldTile tile;
  tile.spacing = spacing_;
  tile.size_at_zero = size_at_zero_;
  tile.size_per_metre = size_per_metre_;
  tile.widest = kWidestLevel * spacing_ / (2.0f * static_cast<float>(stride_));
  const int first = std::max(x0 / 2 - kHalo, 0), last = std::min(x0 / 2 - kHalo + kRow, known_.width());
  for (int j = 0; j < kRow; ++j) {
    std::fill_n(tile.around[j], kPitch, kInfinity);
    std::fill_n(tile.gap[j], kPitch, kInfinity);
    const int y = y0 / 2 + j - kHalo, left = x0 / 2 - kHalo;
    if (y < 0 || y >= known_.height()) continue;
    const float *depths = known_.row(y), *entry = buffers_.entry.row(2 * stride_ * y);
    for (int x = first; x < last; ++x) {
      tile.around[j][x - left] = depths[x];
      tile.gap[j][x - left] = depths[x] - entry[2 * stride_ * x];
    }
  }
  for (int j = 0; j < kTile; ++j) {
    std::fill_n(tile.entry[j], kTile, kInfinity);
    if (y0 + j >= y1) continue;
    const float *entry = buffers_.entry.row((y0 + j) * stride_), *exit = buffers_.exit.row((y0 + j) * stride_);
    const auto take = [&](int stride) {
      for (int i = 0; i < x1 - x0; ++i) {
        const float from = entry[(x0 + i) * stride], to = exit[(x0 + i) * stride];
        tile.entry[j][i] = from <= to ? from : kInfinity;
      }
    };
    if (stride_ == 1)
      take(1);  // in vectors
    else
      take(stride_);
  }
  HWY_DYNAMIC_DISPATCH(Foretell)(tile);
  for (int y = y0; y < y1; ++y) std::copy_n(tile.depth[y - y0], x1 - x0, depth.row(y) + x0);
  for (int at = 0; at < kHalf * kHalf; ++at) {  // pixels drawn together have to lie near each other
    const auto [i, j] = z_curve(at);
    for (int bits = tile.left[j][i]; bits != 0; bits &= bits - 1) {
      const int bit = __builtin_ctz(static_cast<unsigned>(bits)), which = bit % 3;
      (bit < 3 ? open : unknown).add(x0 + 2 * i + (which != 1), y0 + 2 * j + (which != 0));
    }
  }
}

}  // namespace meniscus
#endif
