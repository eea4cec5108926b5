#include "surface/picture_normals_simd.h"

#include <algorithm>
#include <cmath>

#include "surface/packet.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/picture_normals_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"  // of the sums in packet_sums-inl.h only the list is used here
#include "base/packing-inl.h"
#include "surface/packet_normals-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// Between two places lies one whose depth, twice taken, differs from the sum of theirs by less than this share of
/// their difference (on a ball it is 0.42 at the rim, where normals are 6 degrees apart) and this share of the reach.
constexpr float kDepthsBent = 0.5f, kDepthsUneven = 0.05f;

/// Fills a list with the particles within the normals' reach of a box, in their sorted order. Of the list's arrays only
/// positions are filled, where particles are alike.
HWY_NOINLINE void gather_near(const RaycastField& field, const Bounds& box, PacketList& list) {
  const float radius = field.options.normal_radius;
  if (HWY_UNLIKELY(field.has_sizes())) return gather_sizes(field, box.low, box.high, radius, false, list);
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const BandGrid& grid = field.grid;
  const Vec3V low = set(box.low), high = set(box.high);
  const Vec radius2 = hn::Set(d, radius * radius), zero = hn::Zero(d);
  const auto outside = [&](Vec v, Vec from, Vec to)
                           HWY_ATTR { return hn::Max(hn::Max(hn::Sub(from, v), hn::Sub(v, to)), zero); };
  std::size_t count = 0;
  grid.for_each_run(box.low - radius, box.high + radius, [&](std::size_t begin, std::size_t end) HWY_ATTR {
    list.reserve(count + (end - begin) + 2 * kPacket, false);
    for (std::size_t i = begin; i < end; i += lanes) {
      const Vec x = hn::LoadU(d, grid.x() + i), y = hn::LoadU(d, grid.y() + i), z = hn::LoadU(d, grid.z() + i);
      const Vec3V off{outside(x, low.x, high.x), outside(y, low.y, high.y), outside(z, low.z, high.z)};
      // Lanes past the run's end belong to other cells, which may be part of the box and come again.
      const auto near = hn::And(hn::Lt(dot(off, off), radius2), hn::FirstN(d, end - i));
      const Packing packed(d, near);
      hn::StoreU(packed(x), d, list.x.data() + count);
      hn::StoreU(packed(y), d, list.y.data() + count);
      hn::StoreU(packed(z), d, list.z.data() + count);
      count += hn::CountTrue(d, near);
    }
    list.count = count;  // that reserve() keeps
  });
  list.count = count;
}

/// The points seen at up to kMost pixels, in packets; each packet's free lanes repeat its first.
class PixelNormals {
 public:
  static constexpr std::size_t kMost = 256;

  PixelNormals(const RaycastField& field, const View& view, SurfaceBuffers& buffers)
      : field_(field), view_(view), buffers_(buffers) {}

  void run(std::span<const Pixel> pixels) {
    take(pixels);
    if (count_ == 0) return;
    set_points();
    run_points(0, count_);
  }

 private:
  static constexpr std::size_t kTogether = kPacket;  ///< points that share what is picked from a list
  static constexpr float kSharedSpace = 4500.0f;     ///< cubic spacings
  static constexpr float kCluster = 2.0f;            ///< spacings

  /// A list around all serves all of these points, unless that would hold far more than each of them needs.
  void run_points(std::size_t first, std::size_t last) {
    const Bounds all = box(first, last);
    const vec3 space = (all.extent() + 2.0f * field_.options.normal_radius) / field_.options.spacing;
    if (space.x * space.y * space.z < kSharedSpace) {
      gather_near(field_, all, list());
      for (; first < last; first += kTogether) run_near(first, std::min(first + kTogether, last));
    } else if (last - first > kTogether) {
      const std::size_t groups = (last - first + kTogether - 1) / kTogether;
      const std::size_t middle = first + (groups + 1) / 2 * kTogether;
      run_points(first, middle);
      run_points(middle, last);
    } else {
      run_by_clusters(first, last);
    }
  }

  void run_near(std::size_t first, std::size_t last) {
    PacketPoints found;
    normals_of_group(first, bits(first, last), box(first, last), found);
    for (std::size_t i = first; i < last; ++i) set_normal(i, found);
  }

  /// Lanes of consecutive points of one packet.
  static PacketMask bits(std::size_t first, std::size_t last) {
    return static_cast<PacketMask>((1ull << (last - first)) - 1) << (first % kPacket);
  }

  void take(std::span<const Pixel> pixels) {
    count_ = 0;
    for (const Pixel pixel : pixels) {
      const float depth = buffers_.depth(pixel.x, pixel.y);
      if (!(depth < std::numeric_limits<float>::infinity())) continue;
      pixels_[count_] = pixel;
      depth_[count_] = depth;
      column_[count_] = static_cast<float>(pixel.x) + 0.5f;
      row_[count_] = static_cast<float>(pixel.y) + 0.5f;
      ++count_;
    }
    for (std::size_t i = count_; i % kPacket != 0; ++i) {
      const std::size_t lane = i / kPacket * kPacket;
      depth_[i] = depth_[lane], column_[i] = column_[lane], row_[i] = row_[lane];
    }
  }

  void set_points() {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    if (view_.projection == Projection::cube) return set_points_of_cube();
    const PictureRays rays(view_);
    const Vec3V eye = set(view_.eye);
    for (std::size_t i = 0; i < count_; i += lanes) {
      PacketPoints &at = points_[i / kPacket], &towards = towards_[i / kPacket];
      const std::size_t l = i % kPacket;
      Vec3V direction;
      const Vec3V point =
          rays.point(hn::Load(d, column_ + i), hn::Load(d, row_ + i), hn::Load(d, depth_ + i), direction);
      hn::Store(hn::Add(eye.x, point.x), d, at.x + l);
      hn::Store(hn::Add(eye.y, point.y), d, at.y + l);
      hn::Store(hn::Add(eye.z, point.z), d, at.z + l);
      hn::Store(hn::Neg(direction.x), d, towards.x + l);
      hn::Store(hn::Neg(direction.y), d, towards.y + l);
      hn::Store(hn::Neg(direction.z), d, towards.z + l);
    }
  }

  void set_points_of_cube() {
    const std::size_t padded = (count_ + kPacket - 1) / kPacket * kPacket;
    for (std::size_t i = 0; i < padded; ++i) {
      PacketPoints &at = points_[i / kPacket], &towards = towards_[i / kPacket];
      const std::size_t l = i % kPacket;
      const Ray ray = view_.ray({column_[i], row_[i]});
      const vec3 point = ray.origin + depth_[i] * ray.direction;
      at.x[l] = point.x, at.y[l] = point.y, at.z[l] = point.z;
      towards.x[l] = -ray.direction.x, towards.y[l] = -ray.direction.y, towards.z[l] = -ray.direction.z;
    }
  }

  vec3 point(std::size_t i) const {
    const PacketPoints& at = points_[i / kPacket];
    const std::size_t l = i % kPacket;
    return {at.x[l], at.y[l], at.z[l]};
  }

  Bounds box(std::size_t first, std::size_t last) const {
    Bounds result;
    for (std::size_t i = first; i < last; ++i) {
      const vec3 p = point(i);
      result.low = {std::min(result.low.x, p.x), std::min(result.low.y, p.y), std::min(result.low.z, p.z)};
      result.high = {std::max(result.high.x, p.x), std::max(result.high.y, p.y), std::max(result.high.z, p.z)};
    }
    return result;
  }

  static PacketList& list() {
    thread_local PacketList kept;
    return kept;
  }

  /// @param group  lanes of the packet that point `first` belongs to
  void normals_of_group(std::size_t first, PacketMask group, const Bounds& around, PacketPoints& found) {
    const float per_radius = 1.0f / field_.options.normal_radius;
    const vec3 origin = 0.5f * (around.low + around.high);
    normals_near(field_, list(),
                 {origin, per_radius, per_radius * (around.low - origin), per_radius * (around.high - origin)},
                 points_[first / kPacket], group, towards_[first / kPacket], found);
  }

  /// Points that lie apart have lists of their own.
  void run_by_clusters(std::size_t first, std::size_t last) {
    const float reach = kCluster * field_.options.spacing;
    const std::size_t base = first / kPacket * kPacket;
    PacketMask left = bits(first, last);
    while (left != 0) {
      const vec3 seed = point(base + static_cast<std::size_t>(__builtin_ctz(left)));
      Bounds around;
      PacketMask group = 0;
      for (PacketMask m = left; m != 0; m &= m - 1) {
        const std::size_t i = base + static_cast<std::size_t>(__builtin_ctz(m));
        const vec3 off = point(i) - seed;
        if (std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) > reach) continue;
        around.add(point(i));
        group |= m & (~m + 1);
      }
      group |= left & (~left + 1);  // the seed itself, whatever its coordinates are
      PacketPoints found;
      gather_near(field_, around, list());
      normals_of_group(base, group, around, found);
      for (PacketMask m = group; m != 0; m &= m - 1)
        set_normal(base + static_cast<std::size_t>(__builtin_ctz(m)), found);
      left &= ~group;
    }
  }

  void set_normal(std::size_t i, const PacketPoints& found) {
    // A ray that starts in the water meets the face that the view's plane cuts.
    const bool cut = depth_[i] <= 0.0f && !buffers_.eye_in_water;
    const PacketPoints& from = cut ? towards_[i / kPacket] : found;
    const std::size_t l = i % kPacket;
    buffers_.normal(pixels_[i].x, pixels_[i].y) = {from.x[l], from.y[l], from.z[l]};
  }

  const RaycastField& field_;
  const View& view_;
  SurfaceBuffers& buffers_;
  std::size_t count_ = 0;
  Pixel pixels_[kMost];
  alignas(64) float depth_[kMost], column_[kMost], row_[kMost];
  PacketPoints points_[kMost / kPacket], towards_[kMost / kPacket];
};

}  // namespace

void NormalsOfPixels(const RaycastField& field, const View& view, std::span<const Pixel> pixels,
                     SurfaceBuffers& buffers) {
  PixelNormals normals(field, view, buffers);
  for (std::size_t first = 0; first < pixels.size(); first += PixelNormals::kMost)
    normals.run(pixels.subspan(first, std::min(PixelNormals::kMost, pixels.size() - first)));
}

void InterpolateNormals(const Image<vec3>& known, int x0, int y0, float reach, SurfaceBuffers& buffers,
                        std::vector<Pixel>& left) {
  // The tile's depths with one more row and column, infinite beyond the picture.
  constexpr int kPitch = kNormalTileWidth + 2 * kPacket;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  alignas(64) float depths[kNormalTileHeight + 1][kPitch];
  std::fill_n(&depths[0][0], (kNormalTileHeight + 1) * kPitch, kInfinity);
  const int width = buffers.depth.width(), height = buffers.depth.height();
  for (int y = y0; y <= std::min(y0 + kNormalTileHeight, height - 1); ++y)
    std::copy_n(buffers.depth.row(y) + x0, std::min(kNormalTileWidth + 1, width - x0), depths[y - y0]);

  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec far = hn::Set(d, reach), alike = hn::Set(d, 1.0f - kNormalsAlike), infinity = hn::Set(d, kInfinity);
  const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
  for (int y = 0; y < kNormalTileHeight && y0 + y < height; y += 2)
    for (int x = 0; x < kNormalTileWidth && x0 + x < width; x += 2 * lanes) {
      // Corners of the squares of four known pixels: a at the pixel, b right of it, c below, e opposite.
      const auto corner = [&](int i, int j) {
        Vec3V n;
        hn::LoadInterleaved3(d, &known((x0 + x) / 2 + i, (y0 + y) / 2 + j).x, n.x, n.y, n.z);
        return n;
      };
      const Vec3V a = corner(0, 0), b = corner(1, 0), c = corner(0, 1), e = corner(1, 1);
      Vec at_a, at_b, at_c, at_e, right, below, middle, unused;
      hn::LoadInterleaved2(d, &depths[y][x], at_a, right);
      hn::LoadInterleaved2(d, &depths[y][x + 2], at_b, unused);
      hn::LoadInterleaved2(d, &depths[y + 1][x], below, middle);
      hn::LoadInterleaved2(d, &depths[std::min(y + 2, kNormalTileHeight)][x], at_c, unused);
      hn::LoadInterleaved2(d, &depths[std::min(y + 2, kNormalTileHeight)][x + 2], at_e, unused);
      const auto set_mean = [&](Vec3V sum, Vec depth, auto good, int dx, int dy) {
        const Vec3V n = normalized(sum);
        alignas(64) float out[3 * kPacket], kind[kPacket];
        // A depth of zero is where the view's plane cuts the water.
        good = hn::And(good, hn::Gt(depth, zero));
        hn::StoreInterleaved3(n.x, n.y, n.z, d, out);
        hn::Store(hn::IfThenElseZero(hn::Lt(depth, infinity), hn::IfThenElse(good, one, two)), d, kind);
        for (int l = 0; l < lanes; ++l) {
          const Pixel pixel{x0 + x + 2 * l + dx, y0 + y + dy};
          if (kind[l] == 1.0f)
            buffers.normal(pixel.x, pixel.y) = {out[3 * l], out[3 * l + 1], out[3 * l + 2]};
          else if (kind[l] == 2.0f && pixel.x < x0 + kNormalTileWidth)
            left.push_back(pixel);
        }
      };
      const auto near = [&](Vec depth, Vec other) { return hn::Lt(hn::Abs(hn::Sub(depth, other)), far); };
      // A place off the middle of the two has a normal of its own: at rims, where rays graze the water.
      const auto amidst = [&](Vec depth, Vec at_n, Vec at_m) {
        const Vec off = hn::Abs(hn::Sub(hn::Add(depth, depth), hn::Add(at_n, at_m)));
        const Vec slope = hn::Abs(hn::Sub(at_n, at_m));
        return hn::Lt(off, hn::MulAdd(hn::Set(d, kDepthsBent), slope, hn::Mul(hn::Set(d, kDepthsUneven), far)));
      };
      const auto between = [&](Vec3V n, Vec at_n, Vec3V m, Vec at_m, Vec depth) {
        return hn::And(hn::And(hn::And(near(depth, at_n), near(depth, at_m)), amidst(depth, at_n, at_m)),
                       hn::Gt(dot(n, m), alike));
      };
      const Vec3V ab = combined(a, one, b), ce = combined(c, one, e);
      set_mean(ab, right, between(a, at_a, b, at_b, right), 1, 0);
      set_mean(combined(a, one, c), below, between(a, at_a, c, at_c, below), 0, 1);
      set_mean(combined(ab, one, ce), middle,
               hn::And(between(a, at_a, e, at_e, middle), between(b, at_b, c, at_c, middle)), 1, 1);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();
#pragma GCC diagnostic pop

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(NormalsOfPixels);
HWY_EXPORT(InterpolateNormals);

void normals_of_pixels(const RaycastField& field, const View& view, std::span<const Pixel> pixels,
                       SurfaceBuffers& buffers) {
  HWY_DYNAMIC_DISPATCH(NormalsOfPixels)(field, view, pixels, buffers);
}

Image<vec3> known_normals(const View& view) {
  return {(view.width + 1) / 2 + kNormalTileWidth / 2 + kPacket + 1, (view.height + 1) / 2 + 1, vec3{0}};
}

void interpolate_normals(const Image<vec3>& known, int x0, int y0, float reach, SurfaceBuffers& buffers,
                         std::vector<Pixel>& left) {
  HWY_DYNAMIC_DISPATCH(InterpolateNormals)(known, x0, y0, reach, buffers, left);
}

}  // namespace meniscus
#endif
