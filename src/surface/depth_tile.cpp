#include "surface/depth_tile.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <limits>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/depth_tile.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "surface/sphere_chord-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;
using Places = hn::Vec<hn::RebindToSigned<Tag>>;
using RowTag = HWY_CAPPED(float, DepthTile::kQuads);

constexpr int kLanes = 16;
constexpr std::size_t kAhead = 4;  ///< runs that are asked of memory before they are drawn

/// Sixteen spheres in camera space and the pixels of the tile, both ends included, that each may cover.
struct Candidates {
  alignas(64) float x[kLanes], y[kLanes], z[kLanes], radius[kLanes];
  alignas(64) float near[kLanes];  ///< m: no ray enters the sphere before
  alignas(64) std::int32_t x0[kLanes], x1[kLanes], y0[kLanes], y1[kLanes];
};

/// Boxes of a cluster's runs in the tile.
struct SeenRuns {
  alignas(64) float near[SphereGroups::kRuns], far[SphereGroups::kRuns];      ///< m, as in Candidates
  alignas(64) std::int32_t x0[SphereGroups::kRuns], x1[SphereGroups::kRuns];  ///< quads, both ends included
  alignas(64) std::int32_t y0[SphereGroups::kRuns], y1[SphereGroups::kRuns];
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

/// Spheres of one set and one tile.
class SpheresInTile {
 public:
  SpheresInTile(const SplatCamera& camera, const Spheres& spheres, DepthTile& tile)
      : camera_(camera), spheres_(spheres), tile_(tile) {}

  /// Adds the runs that the tile may show to the list.
  void list(const SphereGroups::Cluster& cluster, std::vector<TileRun>& runs) {
    for (std::uint32_t mask = seen(cluster); mask != 0; mask &= mask - 1) {
      const int l = __builtin_ctz(mask);
      const auto quad = [](std::int32_t number) { return static_cast<std::uint8_t>(number); };
      TileRun run{runs_.near[l],     runs_.far[l],      &spheres_,         cluster.begin[l], cluster.count[l],
                  quad(runs_.x0[l]), quad(runs_.x1[l]), quad(runs_.y0[l]), quad(runs_.y1[l])};
      if (may_be_seen(run))
        runs.push_back(run);
      else
        take_exit(run);
    }
  }

  /// Asks for the run's spheres, which lie anywhere.
  static HWY_INLINE void fetch(const TileRun& run) {
    const Spheres& spheres = *run.spheres;
    for (const std::span<const float>& values : {spheres.x, spheres.y, spheres.z, spheres.radius})
      if (values.size() > 1) hwy::Prefetch(values.data() + run.begin);
  }

  void draw(const TileRun& run) {
    if (!may_be_seen(run)) {
      take_exit(run);
      return;
    }
    take_exit(run);
    const std::size_t lanes = hn::Lanes(Tag()), end = std::size_t{run.begin} + run.count;
    for (std::size_t at = run.begin; at < end; at += lanes) {
      std::uint32_t spheres = candidates(at, std::min(end - at, lanes));
      for (; spheres != 0; spheres &= spheres - 1) draw(__builtin_ctz(spheres));
    }
    for (; touched_ != 0; touched_ &= touched_ - 1) measure(__builtin_ctzll(touched_));
  }

  void find_farthest() {
    const Tag d;
    Vec farthest = hn::Load(d, tile_.full);
    for (std::size_t quad = 0; quad < DepthTile::kQuads * DepthTile::kQuads; quad += hn::Lanes(d))
      farthest = hn::Max(farthest, hn::Load(d, tile_.full + quad));
    tile_.farthest = hn::GetLane(hn::MaxOfLanes(d, farthest));
  }

 private:
  /// Fills runs_; the bits of those runs that the tile may show.
  HWY_INLINE std::uint32_t seen(const SphereGroups::Cluster& cluster) {
    const Tag d;
    const hn::RebindToSigned<Tag> di;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const Vec zero = hn::Zero(d);
    std::uint32_t mask = 0;
    for (int part = 0; part < cluster.runs; part += lanes) {
      const Vec ox = hn::Sub(hn::Load(d, cluster.x + part), hn::Set(d, camera_.eye.x)),
                oy = hn::Sub(hn::Load(d, cluster.y + part), hn::Set(d, camera_.eye.y)),
                oz = hn::Sub(hn::Load(d, cluster.z + part), hn::Set(d, camera_.eye.z));
      const Vec hx = hn::Load(d, cluster.half_x + part), hy = hn::Load(d, cluster.half_y + part),
                hz = hn::Load(d, cluster.half_z + part);
      // The box along the camera's axes around it.
      const auto along = [&](vec3 axis) {
        return hn::MulAdd(ox, hn::Set(d, axis.x), hn::MulAdd(oy, hn::Set(d, axis.y), hn::Mul(oz, hn::Set(d, axis.z))));
      };
      const auto extent = [&](vec3 axis) {
        return hn::MulAdd(hx, hn::Set(d, std::abs(axis.x)),
                          hn::MulAdd(hy, hn::Set(d, std::abs(axis.y)), hn::Mul(hz, hn::Set(d, std::abs(axis.z)))));
      };
      const Vec cx = along(camera_.right), cy = along(camera_.up), cz = along(camera_.forward);
      const Vec ex = extent(camera_.right), ey = extent(camera_.up), ez = extent(camera_.forward);
      const Vec first = hn::Sub(cz, ez), last = hn::Add(cz, ez);
      Mask good = hn::And(hn::Ge(hx, zero), hn::Gt(last, zero));
      Ends u{hn::Sub(cx, ex), hn::Add(cx, ex)}, v{hn::Sub(cy, ey), hn::Add(cy, ey)};
      Vec near, far;
      if (camera_.perspective) {
        const Mask around = hn::Le(first, hn::Mul(hn::Set(d, 1e-5f), last));
        const Vec one = hn::Set(d, 1.0f), all = hn::Set(d, 1e30f);
        const Vec per_first = hn::Div(one, first), per_last = hn::Div(one, last);
        const auto low = [&](Vec value) {
          return hn::IfThenElse(around, hn::Neg(all),
                                hn::Mul(value, hn::IfThenElse(hn::Lt(value, zero), per_first, per_last)));
        };
        const auto high = [&](Vec value) {
          return hn::IfThenElse(around, all, hn::Mul(value, hn::IfThenElse(hn::Lt(value, zero), per_last, per_first)));
        };
        u = {low(u.low), high(u.high)};
        v = {low(v.low), high(v.high)};
        // A little more than the box: the distances of the spheres are rounded, too.
        const auto length = [&](Vec x, Vec y, Vec z) {
          return hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z))));
        };
        const Vec ax = hn::Abs(ox), ay = hn::Abs(oy), az = hn::Abs(oz);
        near = hn::Mul(hn::Set(d, 0.99999f), length(hn::Max(hn::Sub(ax, hx), zero), hn::Max(hn::Sub(ay, hy), zero),
                                                    hn::Max(hn::Sub(az, hz), zero)));
        far = hn::Mul(hn::Set(d, 1.00001f), length(hn::Add(ax, hx), hn::Add(ay, hy), hn::Add(az, hz)));
      } else {
        const Vec doubt = hn::Mul(hn::Set(d, 1e-5f), hn::Add(hn::Abs(cz), ez));
        near = hn::Max(hn::Sub(first, doubt), zero);
        far = hn::Add(last, doubt);
      }
      const Pixels pixels = pixels_between(u, v);
      good = hn::And(good, pixels.some);
      const Vec per_quad = hn::Set(d, 1.0f / DepthTile::kQuad);
      const auto quad = [&](Vec pixel) { return hn::ConvertTo(di, hn::Mul(pixel, per_quad)); };
      hn::Store(near, d, runs_.near + part);
      hn::Store(far, d, runs_.far + part);
      hn::Store(quad(pixels.x0), di, runs_.x0 + part);
      hn::Store(quad(pixels.x1), di, runs_.x1 + part);
      hn::Store(quad(pixels.y0), di, runs_.y0 + part);
      hn::Store(quad(pixels.y1), di, runs_.y1 + part);
      mask |= bits_of(good) << part;
    }
    return mask;
  }

  static HWY_INLINE std::uint32_t bits_of(Mask mask) {
    alignas(64) std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Tag(), mask, bits);
    return static_cast<std::uint32_t>(bits[0]) | static_cast<std::uint32_t>(bits[1]) << 8;
  }

  /// Whether something at least as near as the run may change one of the quads that it touches.
  HWY_INLINE bool may_be_seen(const TileRun& run) const {
    const RowTag d;
    const auto near = hn::Set(d, run.near);
    for (int part = 0; part < DepthTile::kQuads; part += static_cast<int>(hn::Lanes(d))) {
      const auto columns = columns_of(run, part);
      for (int qy = run.y0; qy <= run.y1; ++qy)
        if (!hn::AllFalse(d, hn::And(columns, hn::Ge(hn::Load(d, tile_.full + qy * DepthTile::kQuads + part), near))))
          return true;
    }
    return false;
  }

  /// No exit of the quads that the run touches is to be nearer than its far
  /// side.
  HWY_INLINE void take_exit(const TileRun& run) {
    const RowTag d;
    const auto far = hn::Set(d, run.far);
    for (int part = 0; part < DepthTile::kQuads; part += static_cast<int>(hn::Lanes(d))) {
      const auto columns = columns_of(run, part);
      for (int qy = run.y0; qy <= run.y1; ++qy) {
        float* exit = tile_.exit + qy * DepthTile::kQuads + part;
        const auto before = hn::Load(d, exit);
        hn::Store(hn::IfThenElse(columns, hn::Max(before, far), before), d, exit);
      }
    }
  }

  HWY_INLINE hn::Mask<RowTag> columns_of(const TileRun& run, int part) const {
    const RowTag d;
    const auto place = hn::Iota(d, static_cast<float>(part));
    return hn::And(hn::Ge(place, hn::Set(d, static_cast<float>(run.x0))),
                   hn::Le(place, hn::Set(d, static_cast<float>(run.x1))));
  }

  struct Pixels {
    Vec x0, x1, y0, y1;  ///< of the tile, both ends included
    Mask some;
  };
  HWY_INLINE Pixels pixels_between(Ends u, Ends v) const {
    const Tag d;
    // A hundredth of a pixel more than needed keeps rounding from losing one.
    const Vec per_du = hn::Set(d, 1.0f / camera_.du), per_dv = hn::Set(d, 1.0f / camera_.dv);
    const Vec margin = hn::Set(d, 0.01f), zero = hn::Zero(d);
    const auto pixel = [&](Vec value, float origin, Vec per) {
      return hn::Mul(hn::Sub(value, hn::Set(d, origin)), per);
    };
    const Vec last_x = hn::Set(d, static_cast<float>(tile_.width - 1)),
              last_y = hn::Set(d, static_cast<float>(tile_.height - 1));
    const Vec x0 = hn::Ceil(hn::Max(hn::Sub(pixel(u.low, tile_.u0, per_du), margin), zero)),
              y0 = hn::Ceil(hn::Max(hn::Sub(pixel(v.high, tile_.v0, per_dv), margin), zero)),
              x1 = hn::Floor(hn::Min(hn::Add(pixel(u.high, tile_.u0, per_du), margin), last_x)),
              y1 = hn::Floor(hn::Min(hn::Add(pixel(v.low, tile_.v0, per_dv), margin), last_y));
    const Mask some = hn::And(hn::Le(x0, x1), hn::Le(y0, y1));
    return {hn::Min(x0, last_x), hn::Max(x1, zero), hn::Min(y0, last_y), hn::Max(y1, zero), some};
  }

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
    Vec near;
    if (camera_.perspective) {
      const Vec z2 = hn::Mul(cz, cz), denominator = hn::NegMulAdd(radius, radius, z2);
      const Vec distance = hn::Sqrt(hn::MulAdd(cx, cx, hn::MulAdd(cy, cy, z2)));
      near = hn::Sub(distance, radius);
      const Mask around = hn::Or(hn::Le(cz, radius), hn::Le(denominator, hn::Mul(hn::Set(d, 1e-12f), z2)));
      const Vec per_denominator = hn::Div(hn::Set(d, 1.0f), denominator);
      u = tangents(cx, cz, radius, denominator, per_denominator, around);
      v = tangents(cy, cz, radius, denominator, per_denominator, around);
    } else {
      near = hn::Sub(cz, radius);
      u = {hn::Sub(cx, radius), hn::Add(cx, radius)};
      v = {hn::Sub(cy, radius), hn::Add(cy, radius)};
    }
    const Pixels pixels = pixels_between(u, v);
    good = hn::And(good, pixels.some);
    if (hn::AllFalse(d, good)) return 0;
    const hn::Vec<decltype(di)> x0 = hn::ConvertTo(di, pixels.x0), x1 = hn::ConvertTo(di, pixels.x1),
                                y0 = hn::ConvertTo(di, pixels.y0), y1 = hn::ConvertTo(di, pixels.y1);
    good = may_change(good, near, x0, x1, y0, y1);
    hn::Store(cx, d, found_.x);
    hn::Store(cy, d, found_.y);
    hn::Store(cz, d, found_.z);
    hn::Store(radius, d, found_.radius);
    hn::Store(near, d, found_.near);
    hn::Store(x0, di, found_.x0);
    hn::Store(x1, di, found_.x1);
    hn::Store(y0, di, found_.y0);
    hn::Store(y1, di, found_.y1);
    return bits_of(good);
  }

  /// Of `good` those that begin before the largest entry of one of the blocks
  /// that they touch; all that touch more than two blocks in a row or a column.
  HWY_INLINE Mask may_change(Mask good, Vec near, Places x0, Places x1, Places y0, Places y1) const {
    const Tag d;
    const hn::RebindToSigned<Tag> di;
    const Places first_x = hn::ShiftRight<2>(x0), last_x = hn::ShiftRight<2>(x1);
    const Places first_row = hn::ShiftLeft<4>(hn::ShiftRight<2>(y0)),
                 last_row = hn::ShiftLeft<4>(hn::ShiftRight<2>(y1));
    const auto full = [&](Places row, Places column) {
      return hn::GatherIndex(d, tile_.full_block, hn::Add(row, column));
    };
    const Vec farthest = hn::Max(hn::Max(full(first_row, first_x), full(first_row, last_x)),
                                 hn::Max(full(last_row, first_x), full(last_row, last_x)));
    const auto wide = hn::Or(hn::Gt(hn::Sub(last_x, first_x), hn::Set(di, 1)),
                             hn::Gt(hn::Sub(last_row, first_row), hn::Set(di, DepthTile::kBlocks)));
    return hn::And(good, hn::Or(hn::RebindMask(d, wide), hn::Le(near, farthest)));
  }

  /// Draws one candidate into the blocks where it may change something.
  HWY_INLINE void draw(int l) {
    const Tag d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const int bx0 = found_.x0[l] / DepthTile::kBlock, bx1 = found_.x1[l] / DepthTile::kBlock;
    const int by0 = found_.y0[l] / DepthTile::kBlock, by1 = found_.y1[l] / DepthTile::kBlock;
    const Vec near = hn::Set(d, found_.near[l]);
    for (int part = bx0 / lanes * lanes; part <= bx1; part += lanes) {
      const Vec place = hn::Iota(d, static_cast<float>(part));
      const Mask columns = hn::And(hn::Ge(place, hn::Set(d, static_cast<float>(bx0))),
                                   hn::Le(place, hn::Set(d, static_cast<float>(bx1))));
      for (int by = by0; by <= by1; ++by) {
        const int row = by * DepthTile::kBlocks + part;
        std::uint32_t blocks = bits_of(hn::And(columns, hn::Ge(hn::Load(d, tile_.full_block + row), near)));
        for (; blocks != 0; blocks &= blocks - 1) {
          const int bx = part + __builtin_ctz(blocks);
          draw_block(l, bx, by);
          touched_ |= std::uint64_t{1} << (by / 2 * DepthTile::kQuads + bx / 2);
        }
      }
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
      const Vec inverse_length = camera_.perspective ? hn::Load(d, tile_.inverse_length + at) : zero;
      const auto [middle, half2] = sphere_chord(camera_.perspective, u, v, inverse_length, cx, cy, cz, radius);
      const Vec half = hn::Sqrt(hn::Max(half2, zero)), far_end = hn::Add(middle, half);
      const Mask hits = hn::And(hn::Gt(half2, zero), hn::Gt(far_end, zero));
      const Vec near_end = hn::Max(hn::Sub(middle, half), zero);
      const Vec before = hn::Load(d, tile_.entry + at);
      hn::Store(hn::IfThenElse(hits, hn::Min(before, near_end), before), d, tile_.entry + at);
    }
  }

  /// The quad's largest entry.
  HWY_INLINE void measure(int quad) {
    const Tag d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const int first = (quad / DepthTile::kQuads * 2 * DepthTile::kBlocks + quad % DepthTile::kQuads * 2) * kLanes;
    float farthest = -std::numeric_limits<float>::infinity();
    for (int of_quad = 0; of_quad < 4; ++of_quad) {
      const int at = first + (of_quad / 2 * DepthTile::kBlocks + of_quad % 2) * kLanes;
      Vec full = hn::Load(d, tile_.entry + at);
      for (int part = lanes; part < kLanes; part += lanes) full = hn::Max(full, hn::Load(d, tile_.entry + at + part));
      const float block = hn::GetLane(hn::MaxOfLanes(d, full));
      tile_.full_block[at / kLanes] = block;
      farthest = std::max(farthest, block);
    }
    tile_.full[quad] = farthest;
  }

  const SplatCamera& camera_;
  const Spheres& spheres_;
  DepthTile& tile_;
  std::uint64_t touched_ = 0;  ///< quads
  Candidates found_;
  SeenRuns runs_;
};

void start(const SplatCamera& camera, DepthTile& tile) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec one = hn::Set(d, 1.0f), width = hn::Set(d, static_cast<float>(tile.width)),
            height = hn::Set(d, static_cast<float>(tile.height));
  alignas(64) float lane_x[kLanes], lane_y[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    lane_x[l] = static_cast<float>(l % DepthTile::kBlock);
    lane_y[l] = static_cast<float>(l / DepthTile::kBlock);
    tile.lane_u[l] = lane_x[l] * camera.du;
    tile.lane_v[l] = lane_y[l] * camera.dv;
  }
  for (int block = 0; block < DepthTile::kBlocks * DepthTile::kBlocks; ++block)
    for (int part = 0; part < kLanes; part += lanes) {
      const auto x = static_cast<float>(block % DepthTile::kBlocks * DepthTile::kBlock),
                 y = static_cast<float>(block / DepthTile::kBlocks * DepthTile::kBlock);
      const Vec i = hn::Add(hn::Load(d, lane_x + part), hn::Set(d, x)),
                j = hn::Add(hn::Load(d, lane_y + part), hn::Set(d, y));
      const Vec u = hn::MulAdd(i, hn::Set(d, camera.du), hn::Set(d, tile.u0)),
                v = hn::MulAdd(j, hn::Set(d, camera.dv), hn::Set(d, tile.v0));
      const int at = block * kLanes + part;
      if (camera.perspective)
        hn::Store(hn::Div(one, hn::Sqrt(hn::MulAdd(u, u, hn::MulAdd(v, v, one)))), d, tile.inverse_length + at);
      const Mask within = hn::And(hn::Lt(i, width), hn::Lt(j, height));
      hn::Store(hn::IfThenElse(within, hn::Set(d, kInfinity), hn::Set(d, -kInfinity)), d, tile.entry + at);
    }
}

}  // namespace

void StartDepthTile(const SplatCamera& camera, DepthTile& tile) { start(camera, tile); }

void ListRuns(const SplatCamera& camera, const Spheres& spheres, const SphereGroups::Cluster& cluster, DepthTile& tile,
              std::vector<TileRun>& runs) {
  SpheresInTile(camera, spheres, tile).list(cluster, runs);
}

void DrawRuns(const SplatCamera& camera, std::span<const TileRun> runs, DepthTile& tile) {
  for (std::size_t begin = 0; begin < runs.size();) {
    SpheresInTile drawing(camera, *runs[begin].spheres, tile);
    const Spheres* spheres = runs[begin].spheres;
    for (; begin < runs.size() && runs[begin].spheres == spheres; ++begin) {
      if (begin + kAhead < runs.size()) SpheresInTile::fetch(runs[begin + kAhead]);
      drawing.draw(runs[begin]);
    }
    drawing.find_farthest();
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(StartDepthTile);
HWY_EXPORT(ListRuns);
HWY_EXPORT(DrawRuns);

void start_depth_tile(const SplatCamera& camera, int x, int y, DepthTile& tile) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  tile.u0 = camera.u0 + static_cast<float>(x) * camera.du;
  tile.v0 = camera.v0 + static_cast<float>(y) * camera.dv;
  tile.width = std::min(DepthTile::kSide, camera.width - x);
  tile.height = std::min(DepthTile::kSide, camera.height - y);
  tile.farthest = kInfinity;
  std::fill_n(tile.full, DepthTile::kQuads * DepthTile::kQuads, -kInfinity);
  for (int y_quad = 0; y_quad * DepthTile::kQuad < tile.height; ++y_quad)  // none beyond the picture
    for (int x_quad = 0; x_quad * DepthTile::kQuad < tile.width; ++x_quad)
      tile.full[y_quad * DepthTile::kQuads + x_quad] = kInfinity;
  std::fill_n(tile.full_block, DepthTile::kBlocks * DepthTile::kBlocks, kInfinity);
  std::fill_n(tile.exit, DepthTile::kQuads * DepthTile::kQuads, -kInfinity);
  HWY_DYNAMIC_DISPATCH(StartDepthTile)(camera, tile);
}

void list_runs(const SplatCamera& camera, const Spheres& spheres, const SphereGroups::Cluster& cluster, DepthTile& tile,
               std::vector<TileRun>& runs) {
  HWY_DYNAMIC_DISPATCH(ListRuns)(camera, spheres, cluster, tile, runs);
}

void draw_runs(const SplatCamera& camera, std::span<const TileRun> runs, DepthTile& tile) {
  HWY_DYNAMIC_DISPATCH(DrawRuns)(camera, runs, tile);
}

void copy_depth_tile(const DepthTile& tile, int x, int y, Image<float>& entry, Image<float>& exit) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr int kBlock = DepthTile::kBlock;
  for (int j = 0; j < tile.height; ++j)
    for (int i = 0; i < tile.width; i += kBlock) {
      const int block = j / kBlock * DepthTile::kBlocks + i / kBlock;
      const float* from = tile.entry + block * kBlock * kBlock + j % kBlock * kBlock;
      const float last = tile.exit[j / DepthTile::kQuad * DepthTile::kQuads + i / DepthTile::kQuad];
      float* to_entry = entry.row(y + j) + x + i;
      float* to_exit = exit.row(y + j) + x + i;
      const int count = std::min(kBlock, tile.width - i);
      for (int k = 0; k < count; ++k) {
        to_entry[k] = from[k];
        to_exit[k] = from[k] < kInfinity ? last : -kInfinity;
      }
    }
}

}  // namespace meniscus
#endif
