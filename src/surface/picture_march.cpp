#include "surface/picture_march.h"

#include "surface/beam.h"
#include "surface/packet_rays.h"
#include "surface/picture_levels.h"
#include "surface/z_curve.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

constexpr float kWidestBeam = 8.0f;    ///< spacings across, as far as pixels are not wider
constexpr float kLeastAlong = 2.5f;    ///< spacings along rays that is shared
constexpr float kAcrossPoints = 3.0f;  ///< spacings across rays of points that is shared

thread_local BeamLists thread_lists;

/// Pixels of a picture that are drawn together.
struct Pixels {
  int x[kBeam], y[kBeam];
  int count = 0;
};

class PictureMarch {
 public:
  PictureMarch(const RaycastField& field, const View& view, SurfaceBuffers& buffers)
      : field_(field), view_(view), buffers_(buffers) {}

  void run() {
    int stride = buffers_.eye_in_water ? 1 : first_stride(field_, view_, buffers_);
    Image<float> known = marched(stride);
    for (; stride > 1; stride /= 2) known = refined(known, stride / 2);
    buffers_.depth = std::move(known);
    for (std::size_t i = 0; i < buffers_.depth.size(); ++i)
      buffers_.coverage[i] = buffers_.depth[i] < kInfinity ? 1.0f : 0.0f;
  }

 private:
  static constexpr int kTile = 16;  ///< pixels of a level along a tile

  bool may_hit(int x, int y) const { return buffers_.entry(x, y) <= buffers_.exit(x, y); }

  /// Depths at every `stride`-th pixel across and down.
  Image<float> marched(int stride) const {
    Image<float> depth = level_image(stride);
    for_each_tile(depth, [&](int x0, int y0, int x1, int y1) {
      const int side = beam_side(x0, y0, x1, y1, stride);
      Pixels pixels;
      for (int y = y0; y < y1; y += side)
        for (int x = x0; x < x1; x += side) {
          for (int at = 0; at < side * side; ++at) {
            const int i = x + z_curve(at).x, j = y + z_curve(at).y;
            if (i < x1 && j < y1 && may_hit(i * stride, j * stride)) add(pixels, i, j);
          }
          march(pixels, stride, depth);
        }
    });
    return depth;
  }

  /// Depths at every `stride`-th pixel from those at every second of them.
  Image<float> refined(const Image<float>& known, int stride) const {
    Image<float> depth = level_image(stride);
    const Foretelling foretelling(field_, view_, buffers_, known, stride);
    for_each_tile(depth, [&](int x0, int y0, int x1, int y1) {
      TilePixels open, unknown;
      foretelling.tile(x0, y0, x1, y1, depth, open, unknown);
      const int side = beam_side(x0, y0, x1, y1, stride), most = side * side;
      Pixels pixels;
      for (int i = 0; i < open.count; ++i) {
        add(pixels, open.x[i], open.y[i]);
        if (pixels.count == kPacket || i + 1 == open.count) correct(pixels, stride, depth, unknown);
      }
      for (int i = 0; i < unknown.count; ++i) {
        add(pixels, unknown.x[i], unknown.y[i]);
        if (pixels.count == most || i + 1 == unknown.count) march(pixels, stride, depth);
      }
    });
    return depth;
  }

  Image<float> level_image(int stride) const {
    return {(view_.width + stride - 1) / stride, (view_.height + stride - 1) / stride, kInfinity};
  }

  template <class Visit>
  static void for_each_tile(const Image<float>& image, Visit visit) {
    const int tiles_x = (image.width() + kTile - 1) / kTile, tiles_y = (image.height() + kTile - 1) / kTile;
    parallel_for(static_cast<std::size_t>(tiles_x) * static_cast<std::size_t>(tiles_y), 8,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t tile = begin; tile < end; ++tile) {
                     const int x0 = static_cast<int>(tile) % tiles_x * kTile;
                     const int y0 = static_cast<int>(tile) / tiles_x * kTile;
                     visit(x0, y0, std::min(x0 + kTile, image.width()), std::min(y0 + kTile, image.height()));
                   }
                 });
  }

  static void add(Pixels& pixels, int x, int y) {
    pixels.x[pixels.count] = x;
    pixels.y[pixels.count++] = y;
  }

  /// Pixels along a beam in this part of a level: 8, 4 or 2.
  int beam_side(int x0, int y0, int x1, int y1, int stride) const {
    float first = kInfinity;
    for (int y = y0; y < y1; y += 3)
      for (int x = x0; x < x1; x += 3)
        if (may_hit(x * stride, y * stride)) first = std::min(first, buffers_.entry(x * stride, y * stride));
    if (!(first < kInfinity)) return 4;
    const float pixel = static_cast<float>(stride) * view_.pixel_size(first);
    const float most = kWidestBeam * field_.options.spacing;
    return 8.0f * pixel <= most ? 8 : 2.0f * pixel <= most ? 4 : 2;
  }

  /// The rays of pixels of a level; those beyond the last repeat the first.
  void set_rays(const Pixels& pixels, int stride, Beam& beam) const {
    beam.count = pixels.count;
    alignas(64) float x[kPacket], y[kPacket];
    for (int first = 0; first < pixels.count; first += kPacket) {
      for (int l = 0; l < kPacket; ++l) {
        const int i = first + l < pixels.count ? first + l : 0;
        x[l] = static_cast<float>(pixels.x[i] * stride) + 0.5f;
        y[l] = static_cast<float>(pixels.y[i] * stride) + 0.5f;
      }
      rays_through(view_, x, y, beam.rays[first / kPacket]);
    }
  }

  void march(Pixels& pixels, int stride, Image<float>& depth) const {
    if (pixels.count == 0) return;
    Beam beam;
    set_rays(pixels, stride, beam);
    for (int i = 0; i < pixels.count; ++i) {
      beam.entry[i] = buffers_.entry(pixels.x[i] * stride, pixels.y[i] * stride);
      beam.exit[i] = buffers_.exit(pixels.x[i] * stride, pixels.y[i] * stride);
    }
    const float spacing = field_.options.spacing;
    beam.along = kLeastAlong * spacing + 8.0f * static_cast<float>(stride) * view_.pixel_size(beam.entry[0]);
    beam.across = kWidestBeam * spacing;
    march_beam(field_, buffers_.eye_in_water, thread_lists, beam);
    for (int i = 0; i < pixels.count; ++i) depth(pixels.x[i], pixels.y[i]) = beam.depth[i];
    pixels.count = 0;
  }

  /// Depths that are foretold; those that turn out not to be there are `unknown`.
  void correct(Pixels& pixels, int stride, Image<float>& depth, TilePixels& unknown) const {
    Beam beam;
    set_rays(pixels, stride, beam);
    alignas(64) float found[kPacket];
    for (int l = 0; l < kPacket; ++l) {
      const int i = l < pixels.count ? l : 0;
      found[l] = depth(pixels.x[i], pixels.y[i]);
    }
    const PacketMask mask = (1u << pixels.count) - 1u;
    const PacketMask good = correct_packet(field_, beam.rays[0], mask, thread_lists.whole, found);
    for (int l = 0; l < pixels.count; ++l)
      if ((good >> l) & 1u)
        depth(pixels.x[l], pixels.y[l]) = found[l];
      else
        unknown.add(pixels.x[l], pixels.y[l]);
    pixels.count = 0;
  }

  const RaycastField& field_;
  const View& view_;
  SurfaceBuffers& buffers_;
};

/// Points that come one after another are marched together as far as they lie near each other.
void march_points(const RaycastField& field, const View& view, std::span<const vec2> points, SurfaceBuffers& buffers) {
  constexpr std::size_t kAtOnce = kPacket;
  parallel_for((points.size() + kAtOnce - 1) / kAtOnce, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; ++at) {
      Beam beam;
      const std::size_t first = at * kAtOnce;
      point_rays(view, points, first, beam.rays[0]);
      beam.count = static_cast<int>(std::min(kAtOnce, points.size() - first));
      std::copy_n(&buffers.entry[first], beam.count, beam.entry);
      std::copy_n(&buffers.exit[first], beam.count, beam.exit);
      beam.along = kLeastAlong * field.options.spacing;
      beam.across = kAcrossPoints * field.options.spacing;
      march_beam(field, buffers.eye_in_water, thread_lists, beam);
      for (int i = 0; i < beam.count; ++i) {
        if (!(beam.depth[i] < kInfinity)) continue;
        buffers.depth[first + static_cast<std::size_t>(i)] = beam.depth[i];
        buffers.coverage[first + static_cast<std::size_t>(i)] = 1.0f;
      }
    }
  });
}

}  // namespace

void march_picture(const RaycastField& field, const View& view, std::span<const vec2> points, SurfaceBuffers& buffers) {
  const int width = buffers.entry.width(), height = buffers.entry.height();
  buffers.depth = Image<float>(width, height, kInfinity);
  buffers.coverage = Image<float>(width, height, 0.0f);
  if (points.empty())
    PictureMarch(field, view, buffers).run();
  else
    march_points(field, view, points, buffers);
}

}  // namespace meniscus
