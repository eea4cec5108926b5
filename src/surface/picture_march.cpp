#include "surface/picture_march.h"

#include "surface/packet_rays.h"
#include "surface/picture_levels.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

thread_local PacketList thread_list;

/// Up to sixteen pixels of a picture that are drawn together.
struct Pixels {
  int x[kPacket], y[kPacket];
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
      Pixels pixels;
      for (int y = y0; y < y1; y += 4)
        for (int x = x0; x < x1; x += 4) {
          for (int l = 0; l < kPacket; ++l) {
            const int i = x + l % 4, j = y + l / 4;
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
      Pixels pixels;
      for (int i = 0; i < open.count; ++i) {
        add(pixels, open.x[i], open.y[i]);
        if (pixels.count == kPacket || i + 1 == open.count) correct(pixels, stride, depth, unknown);
      }
      for (int i = 0; i < unknown.count; ++i) {
        add(pixels, unknown.x[i], unknown.y[i]);
        if (pixels.count == kPacket || i + 1 == unknown.count) march(pixels, stride, depth);
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

  /// The rays of pixels of a level, and the lanes that are theirs; the others repeat the first.
  PacketMask set_rays(const Pixels& pixels, int stride, PacketRays& rays) const {
    alignas(64) float x[kPacket], y[kPacket];
    for (int l = 0; l < kPacket; ++l) {
      const int i = l < pixels.count ? l : 0;
      x[l] = static_cast<float>(pixels.x[i] * stride) + 0.5f;
      y[l] = static_cast<float>(pixels.y[i] * stride) + 0.5f;
    }
    rays_through(view_, x, y, rays);
    return (1u << pixels.count) - 1u;
  }

  void march(Pixels& pixels, int stride, Image<float>& depth) const {
    if (pixels.count == 0) return;
    PacketRays rays;
    alignas(64) float entry[kPacket], exit[kPacket], found[kPacket];
    const PacketMask mask = set_rays(pixels, stride, rays);
    for (int l = 0; l < kPacket; ++l) {
      const int i = l < pixels.count ? l : 0;
      entry[l] = buffers_.entry(pixels.x[i] * stride, pixels.y[i] * stride);
      exit[l] = buffers_.exit(pixels.x[i] * stride, pixels.y[i] * stride);
    }
    march_packet(field_, rays, mask, entry, exit, buffers_.eye_in_water, thread_list, found);
    for (int l = 0; l < pixels.count; ++l) depth(pixels.x[l], pixels.y[l]) = found[l];
    pixels.count = 0;
  }

  /// Depths that are foretold; those that turn out not to be there are `unknown`.
  void correct(Pixels& pixels, int stride, Image<float>& depth, TilePixels& unknown) const {
    PacketRays rays;
    alignas(64) float found[kPacket];
    const PacketMask mask = set_rays(pixels, stride, rays);
    for (int l = 0; l < kPacket; ++l) {
      const int i = l < pixels.count ? l : 0;
      found[l] = depth(pixels.x[i], pixels.y[i]);
    }
    const PacketMask good = correct_packet(field_, rays, mask, thread_list, found);
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

/// Points need not lie near each other: sixteen after another are a packet.
void march_points(const RaycastField& field, const View& view, std::span<const vec2> points, SurfaceBuffers& buffers) {
  parallel_for((points.size() + kPacket - 1) / kPacket, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; ++at) {
      PacketRays rays;
      PacketMask mask = point_rays(view, points, at * kPacket, rays);
      alignas(64) float entry[kPacket], exit[kPacket], depth[kPacket];
      for (std::size_t l = 0; l < kPacket; ++l) {
        const std::size_t i = std::min(at * kPacket + l, points.size() - 1);
        entry[l] = buffers.entry[i];
        exit[l] = buffers.exit[i];
      }
      march_packet(field, rays, mask, entry, exit, buffers.eye_in_water, thread_list, depth);
      for (std::size_t l = 0; l < kPacket && at * kPacket + l < points.size(); ++l) {
        if (!(depth[l] < kInfinity)) continue;
        buffers.depth[at * kPacket + l] = depth[l];
        buffers.coverage[at * kPacket + l] = 1.0f;
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
