#include "surface/depth_tile.h"

#include <algorithm>
#include <limits>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/depth_tile.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

constexpr int kLanes = 16;

/// Sixteen spheres in camera space and the pixels of the tile, both ends included, that each may cover.
struct Candidates {
  alignas(64) float x[kLanes], y[kLanes], z[kLanes], radius[kLanes];
  alignas(64) float near[kLanes];  ///< m: no ray enters the sphere before
  alignas(64) float far[kLanes];   ///< m: no ray leaves it behind
  alignas(64) std::int32_t x0[kLanes], x1[kLanes], y0[kLanes], y1[kLanes];
};

struct Ends {
  Vec low, high;
};

/// Ends of the spheres' silhouettes along one axis of the plane at distance 1: the two planes through the eye and the
/// other axis that touch them.
HWY_INLINE Ends tangents(Vec c, Vec z, Vec radius, Vec denominator, Vec per_denominator, Mask around) {
  const Tag d;
  const Vec root = hn::Mul(radius, hn::Sqrt(hn::Max(hn::MulAdd(c, c, denominator), hn::Zero(d))));
  const Vec cz = hn::Mul(c, z), all = hn::Set(d, 1e30f);
  return {hn::IfThenElse(around, hn::Neg(all), hn::Mul(hn::Sub(cz, root), per_denominator)),
          hn::IfThenElse(around, all, hn::Mul(hn::Add(cz, root), per_denominator))};
}

/// One group of spheres drawn into one tile.
class GroupInTile {
 public:
  GroupInTile(const SplatCamera& camera, const Spheres& spheres, DepthTile& tile)
      : camera_(camera), spheres_(spheres), tile_(tile) {}

  void run(std::size_t begin, std::size_t end) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t at = begin; at < end; at += lanes) {
      const std::size_t count = std::min(end - at, lanes);
      std::uint32_t mask = candidates(at, count);
      for (; mask != 0; mask &= mask - 1) draw(__builtin_ctz(mask));
    }
    if (touched_ == 0) return;
    for (; touched_ != 0; touched_ &= touched_ - 1) measure(__builtin_ctz(touched_));
    tile_.farthest = *std::max_element(std::begin(tile_.full), std::end(tile_.full));
  }

 private:
  HWY_INLINE Vec load(std::span<const float> values, std::size_t at, std::size_t count) const {
    const Tag d;
    if (count == hn::Lanes(d)) return hn::LoadU(d, values.data() + at);
    alignas(64) float rest[kLanes] = {};  // a masked load may read past the end
    std::copy_n(values.data() + at, count, rest);
    return hn::Load(d, rest);
  }

  /// Fills candidates_; the bits of those that may change the tile.
  HWY_INLINE std::uint32_t candidates(std::size_t at, std::size_t count) {
    const Tag d;
    const hn::RebindToSigned<Tag> di;
    const Vec zero = hn::Zero(d);
    const Vec radius = spheres_.radius.size() == 1 ? hn::Set(d, spheres_.radius[0]) : load(spheres_.radius, at, count);
    const Vec ox = hn::Sub(load(spheres_.x, at, count), hn::Set(d, camera_.eye.x)),
              oy = hn::Sub(load(spheres_.y, at, count), hn::Set(d, camera_.eye.y)),
              oz = hn::Sub(load(spheres_.z, at, count), hn::Set(d, camera_.eye.z));
    const auto along = [&](vec3 axis) {
      return hn::MulAdd(ox, hn::Set(d, axis.x), hn::MulAdd(oy, hn::Set(d, axis.y), hn::Mul(oz, hn::Set(d, axis.z))));
    };
    const Vec cx = along(camera_.right), cy = along(camera_.up), cz = along(camera_.forward);
    Mask good = hn::And(hn::And(hn::Gt(hn::Add(cz, radius), zero), hn::Gt(radius, zero)), hn::FirstN(d, count));
    Ends u, v;
    Vec near, far;
    if (camera_.perspective) {
      const Vec z2 = hn::Mul(cz, cz), denominator = hn::NegMulAdd(radius, radius, z2);
      const Vec distance = hn::Sqrt(hn::MulAdd(cx, cx, hn::MulAdd(cy, cy, z2)));
      near = hn::Sub(distance, radius);
      far = hn::Add(distance, radius);
      const Mask around = hn::Or(hn::Le(cz, radius), hn::Le(denominator, hn::Mul(hn::Set(d, 1e-12f), z2)));
      const Vec per_denominator = hn::Div(hn::Set(d, 1.0f), denominator);
      u = tangents(cx, cz, radius, denominator, per_denominator, around);
      v = tangents(cy, cz, radius, denominator, per_denominator, around);
    } else {
      near = hn::Sub(cz, radius);
      far = hn::Add(cz, radius);
      u = {hn::Sub(cx, radius), hn::Add(cx, radius)};
      v = {hn::Sub(cy, radius), hn::Add(cy, radius)};
    }
    if (!tile_.exact_exit) {
      const Mask behind = hn::And(good, hn::Gt(near, hn::Set(d, tile_.farthest)));
      if (!hn::AllFalse(d, behind)) {
        const Vec leave = hn::IfThenElse(behind, far, hn::Set(d, -std::numeric_limits<float>::infinity()));
        const float exit = hn::GetLane(hn::MaxOfLanes(d, leave));
        for (float& least : tile_.least) least = std::max(least, exit);
        good = hn::AndNot(behind, good);
      }
    }
    // Pixels of the tile; a hundredth of a pixel more than needed keeps rounding from losing one.
    const Vec per_du = hn::Set(d, 1.0f / camera_.du), per_dv = hn::Set(d, 1.0f / camera_.dv);
    const Vec margin = hn::Set(d, 0.01f);
    const auto pixel = [&](Vec value, float origin, Vec per) {
      return hn::Mul(hn::Sub(value, hn::Set(d, origin)), per);
    };
    const Vec x0 = hn::Ceil(hn::Max(hn::Sub(pixel(u.low, tile_.u0, per_du), margin), zero)),
              y0 = hn::Ceil(hn::Max(hn::Sub(pixel(v.high, tile_.v0, per_dv), margin), zero)),
              x1 = hn::Floor(hn::Min(hn::Add(pixel(u.high, tile_.u0, per_du), margin),
                                     hn::Set(d, static_cast<float>(tile_.width - 1)))),
              y1 = hn::Floor(hn::Min(hn::Add(pixel(v.low, tile_.v0, per_dv), margin),
                                     hn::Set(d, static_cast<float>(tile_.height - 1))));
    good = hn::And(good, hn::And(hn::Le(x0, x1), hn::Le(y0, y1)));
    if (hn::AllFalse(d, good)) return 0;
    hn::Store(cx, d, found_.x);
    hn::Store(cy, d, found_.y);
    hn::Store(cz, d, found_.z);
    hn::Store(radius, d, found_.radius);
    hn::Store(near, d, found_.near);
    hn::Store(far, d, found_.far);
    const Vec last = hn::Set(d, static_cast<float>(DepthTile::kSide));
    hn::Store(hn::ConvertTo(di, hn::Min(x0, last)), di, found_.x0);
    hn::Store(hn::ConvertTo(di, hn::Max(x1, hn::Set(d, -1.0f))), di, found_.x1);
    hn::Store(hn::ConvertTo(di, hn::Min(y0, last)), di, found_.y0);
    hn::Store(hn::ConvertTo(di, hn::Max(y1, hn::Set(d, -1.0f))), di, found_.y1);
    alignas(64) std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, good, bits);
    return static_cast<std::uint32_t>(bits[0]) | static_cast<std::uint32_t>(bits[1]) << 8;
  }

  /// Draws one candidate into the blocks of the quads where it may change something.
  HWY_INLINE void draw(int l) {
    const int bx0 = found_.x0[l] / DepthTile::kBlock, bx1 = found_.x1[l] / DepthTile::kBlock;
    const int by0 = found_.y0[l] / DepthTile::kBlock, by1 = found_.y1[l] / DepthTile::kBlock;
    const float near = found_.near[l], far = found_.far[l];
    for (int by = by0; by <= by1; ++by)
      for (int bx = bx0; bx <= bx1; ++bx) {
        const int quad = by / 2 * DepthTile::kQuads + bx / 2;
        if (near > tile_.full[quad] && (!tile_.exact_exit || far <= tile_.least[quad])) {
          if (!tile_.exact_exit) tile_.least[quad] = std::max(tile_.least[quad], far);
          continue;
        }
        draw_block(l, bx, by);
        touched_ |= 1u << quad;
      }
  }

  HWY_INLINE void draw_block(int l, int bx, int by) {
    const Tag d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const Vec zero = hn::Zero(d);
    const Vec cx = hn::Set(d, found_.x[l]), cy = hn::Set(d, found_.y[l]), cz = hn::Set(d, found_.z[l]);
    const Vec radius = hn::Set(d, found_.radius[l]);
    const float block_u = tile_.u0 + static_cast<float>(bx * DepthTile::kBlock) * camera_.du;
    const float block_v = tile_.v0 + static_cast<float>(by * DepthTile::kBlock) * camera_.dv;
    const int block = (by * DepthTile::kBlocks + bx) * kLanes;
    for (int part = 0; part < kLanes; part += lanes) {
      const int at = block + part;
      const Vec u = hn::Add(hn::Load(d, tile_.lane_u + part), hn::Set(d, block_u)),
                v = hn::Add(hn::Load(d, tile_.lane_v + part), hn::Set(d, block_v));
      Vec middle, off_axis2;
      if (camera_.perspective) {
        // The part of the centre across the ray is subtracted before it is squared: far away, the difference of two
        // large squares would have no digits left.
        const Vec dz = hn::Load(d, tile_.inverse_length + at);
        const Vec dx = hn::Mul(u, dz), dy = hn::Mul(v, dz);
        middle = hn::MulAdd(cx, dx, hn::MulAdd(cy, dy, hn::Mul(cz, dz)));
        const Vec ox = hn::NegMulAdd(middle, dx, cx), oy = hn::NegMulAdd(middle, dy, cy),
                  oz = hn::NegMulAdd(middle, dz, cz);
        off_axis2 = hn::MulAdd(ox, ox, hn::MulAdd(oy, oy, hn::Mul(oz, oz)));
      } else {
        const Vec ox = hn::Sub(cx, u), oy = hn::Sub(cy, v);
        middle = cz;
        off_axis2 = hn::MulAdd(ox, ox, hn::Mul(oy, oy));
      }
      const Vec half2 = hn::MulSub(radius, radius, off_axis2);
      const Vec half = hn::Sqrt(hn::Max(half2, zero)), far_end = hn::Add(middle, half);
      const Mask hits = hn::And(hn::Gt(half2, zero), hn::Gt(far_end, zero));
      const Vec near_end = hn::Max(hn::Sub(middle, half), zero);
      const Vec before = hn::Load(d, tile_.entry + at), after = hn::Load(d, tile_.exit + at);
      hn::Store(hn::IfThenElse(hits, hn::Min(before, near_end), before), d, tile_.entry + at);
      hn::Store(hn::IfThenElse(hits, hn::Max(after, far_end), after), d, tile_.exit + at);
    }
  }

  /// The quad's largest entry and, for exact exits, its smallest exit.
  HWY_INLINE void measure(int quad) {
    const Tag d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const int first = (quad / DepthTile::kQuads * 2 * DepthTile::kBlocks + quad % DepthTile::kQuads * 2) * kLanes;
    Vec full = hn::Load(d, tile_.entry + first), least = hn::Load(d, tile_.exit + first);
    for (const int row : {0, DepthTile::kBlocks * kLanes})
      for (int part = 0; part < 2 * kLanes; part += lanes) {
        full = hn::Max(full, hn::Load(d, tile_.entry + first + row + part));
        least = hn::Min(least, hn::Load(d, tile_.exit + first + row + part));
      }
    tile_.full[quad] = hn::GetLane(hn::MaxOfLanes(d, full));
    if (tile_.exact_exit) tile_.least[quad] = hn::GetLane(hn::MinOfLanes(d, least));
  }

  const SplatCamera& camera_;
  const Spheres& spheres_;
  DepthTile& tile_;
  std::uint32_t touched_ = 0;  ///< quads
  Candidates found_;
};

}  // namespace

void SplatIntoDepthTile(const SplatCamera& camera, const Spheres& spheres, std::size_t begin, std::size_t end,
                        DepthTile& tile) {
  GroupInTile(camera, spheres, tile).run(begin, end);
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(SplatIntoDepthTile);

void start_depth_tile(const SplatCamera& camera, int x, int y, bool exact_exit, DepthTile& tile) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr int kPixels = DepthTile::kSide * DepthTile::kSide;
  tile.exact_exit = exact_exit;
  tile.u0 = camera.u0 + static_cast<float>(x) * camera.du;
  tile.v0 = camera.v0 + static_cast<float>(y) * camera.dv;
  tile.width = std::min(DepthTile::kSide, camera.width - x);
  tile.height = std::min(DepthTile::kSide, camera.height - y);
  tile.farthest = kInfinity;
  for (int l = 0; l < DepthTile::kBlock * DepthTile::kBlock; ++l) {
    tile.lane_u[l] = static_cast<float>(l % DepthTile::kBlock) * camera.du;
    tile.lane_v[l] = static_cast<float>(l / DepthTile::kBlock) * camera.dv;
  }
  std::fill_n(tile.entry, kPixels, kInfinity);
  std::fill_n(tile.exit, kPixels, -kInfinity);
  std::fill_n(tile.full, DepthTile::kQuads * DepthTile::kQuads, kInfinity);
  std::fill_n(tile.least, DepthTile::kQuads * DepthTile::kQuads, -kInfinity);
  for (int at = 0; at < kPixels; ++at) {
    constexpr int kInBlock = DepthTile::kBlock * DepthTile::kBlock;
    const int block = at / kInBlock, lane = at % kInBlock;
    const int i = block % DepthTile::kBlocks * DepthTile::kBlock + lane % DepthTile::kBlock,
              j = block / DepthTile::kBlocks * DepthTile::kBlock + lane / DepthTile::kBlock;
    const float u = tile.u0 + static_cast<float>(i) * camera.du, v = tile.v0 + static_cast<float>(j) * camera.dv;
    if (camera.perspective) tile.inverse_length[at] = 1.0f / std::sqrt(u * u + v * v + 1.0f);
    if (i >= tile.width || j >= tile.height) {
      tile.entry[at] = -kInfinity;
      tile.exit[at] = kInfinity;
    }
  }
}

void splat_into_depth_tile(const SplatCamera& camera, const Spheres& spheres, std::size_t begin, std::size_t end,
                           DepthTile& tile) {
  HWY_DYNAMIC_DISPATCH(SplatIntoDepthTile)(camera, spheres, begin, end, tile);
}

}  // namespace meniscus
#endif
