#include "surface/picture_normals.h"

#include <algorithm>

#include "surface/picture_blocks.h"
#include "surface/picture_normals_simd.h"
#include "surface/z_curve.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Lanes of a block with surface; `at` and `towards` are filled, free lanes with copies of one that is not.
PacketMask points_of_block(const View& view, const Block& block, const SurfaceBuffers& buffers, PacketPoints& points,
                           PacketPoints& towards) {
  PacketMask mask = 0;
  for (int l = 0; l < kPacket; ++l)
    if (((block.mask >> l) & 1u) && buffers.depth[block.targets[l]] < kInfinity) mask |= 1u << l;
  if (mask == 0) return 0;
  for (int l = 0; l < kPacket; ++l) {
    const int lane = (mask >> l) & 1u ? l : __builtin_ctz(mask);
    const Ray ray = view.ray(block.points[lane]);
    const vec3 point = ray.origin + buffers.depth[block.targets[lane]] * ray.direction;
    points.x[l] = point.x;
    points.y[l] = point.y;
    points.z[l] = point.z;
    towards.x[l] = -ray.direction.x;
    towards.y[l] = -ray.direction.y;
    towards.z[l] = -ray.direction.z;
  }
  return mask;
}

void normals_of_block(const RaycastField& field, const View& view, const Block& block, SurfaceBuffers& buffers) {
  thread_local PacketList list;
  PacketPoints points, towards, normals;
  const PacketMask mask = points_of_block(view, block, buffers, points, towards);
  if (mask == 0) return;
  normals_packet(field, points, mask, towards, list, normals);
  for (int l = 0; l < kPacket; ++l)
    if ((mask >> l) & 1u) {
      // A ray that starts in the water meets the face that the view's plane cuts.
      const bool cut = buffers.depth[block.targets[l]] <= 0.0f && !buffers.eye_in_water;
      buffers.normal[block.targets[l]] =
          cut ? vec3{towards.x[l], towards.y[l], towards.z[l]} : vec3{normals.x[l], normals.y[l], normals.z[l]};
    }
}

void colours_of_block(const RaycastField& field, const View& view, const Block& block, SurfaceBuffers& buffers) {
  thread_local PacketList list;
  PacketPoints points, towards, colours;
  const PacketMask mask = points_of_block(view, block, buffers, points, towards);
  if (mask == 0) return;
  colours_packet(field, points, mask, list, colours);
  for (int l = 0; l < kPacket; ++l)
    if ((mask >> l) & 1u) buffers.colour[block.targets[l]] = {colours.x[l], colours.y[l], colours.z[l]};
}

/// Whole pictures: where a spacing is many pixels wide, normals of every second pixel of every second row first, then
/// means of those between them, and once more the sums wherever these are not alike.
class PictureNormals {
 public:
  PictureNormals(const RaycastField& field, const View& view, SurfaceBuffers& buffers)
      : field_(field),
        view_(view),
        buffers_(buffers),
        known_(known_normals(view)),
        tiles_x_((view.width + kNormalTileWidth - 1) / kNormalTileWidth),
        tiles_y_((view.height + kNormalTileHeight - 1) / kNormalTileHeight),
        sparse_(static_cast<std::size_t>(tiles_x_ * tiles_y_), 0) {}

  void run() {
    for_each_tile([&](std::size_t tile, int x0, int y0) { find(tile, x0, y0); });
    for_each_tile([&](std::size_t tile, int x0, int y0) {
      if (sparse_[tile]) complete(x0, y0);
    });
  }

 private:
  template <class Visit>
  void for_each_tile(Visit visit) {
    parallel_for(sparse_.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t tile = begin; tile < end; ++tile)
        visit(tile, static_cast<int>(tile) % tiles_x_ * kNormalTileWidth,
              static_cast<int>(tile) / tiles_x_ * kNormalTileHeight);
    });
  }

  /// Whether a spacing is wide enough in this tile for normals to be interpolated.
  bool is_sparse(int x0, int y0) const {
    if (view_.projection == Projection::cube) return false;  // a tile may reach over the edge of a face
    float sum = 0, count = 0;
    for (int y = y0; y < std::min(y0 + kNormalTileHeight, view_.height); y += 4)
      for (int x = x0; x < std::min(x0 + kNormalTileWidth, view_.width); x += 4)
        if (buffers_.depth(x, y) < kInfinity) sum += buffers_.depth(x, y), count += 1;
    return count > 0 && field_.options.spacing > kLeastInterpolated * view_.pixel_size(sum / count);
  }

  void find(std::size_t tile, int x0, int y0) {
    sparse_[tile] = is_sparse(x0, y0);
    const int step = sparse_[tile] ? 2 : 1, side = 4 * step, list = 2 * side;
    // Squares of 8 x 8 normals share a list of particles; their quarters are packets.
    thread_local std::vector<Pixel> pixels;
    const int x1 = std::min(x0 + kNormalTileWidth, view_.width), y1 = std::min(y0 + kNormalTileHeight, view_.height);
    for (int ly = y0; ly < y1; ly += list)
      for (int lx = x0; lx < x1; lx += list) {
        pixels.clear();
        for (int by = ly; by < ly + list; by += side)
          for (int bx = lx; bx < lx + list; bx += side)
            for (int k = 0; k < 16; ++k) {
              const int x = bx + step * z_curve(k).x, y = by + step * z_curve(k).y;
              if (x < x1 && y < y1) pixels.push_back({x, y});
            }
        normals_of_pixels(field_, view_, pixels, buffers_);
      }
    for (int y = y0; y < y1; y += 2)
      for (int x = x0; x < x1; x += 2) known_(x / 2, y / 2) = buffers_.normal(x, y);
  }

  void complete(int x0, int y0) {
    thread_local std::vector<Pixel> left;
    left.clear();
    interpolate_normals(known_, x0, y0, kDepthsAlike * field_.options.spacing, buffers_, left);
    // By squares of 16 x 16, which share a list, and in these by squares of 4 x 4: packets are small.
    constexpr int kSquare = 16, kPart = 4, kParts = kSquare / kPart;
    constexpr std::size_t kPlaces = std::size_t{kNormalTileWidth / kPart} * (kNormalTileHeight / kPart);
    const auto place = [&](Pixel p) {
      const int x = p.x - x0, y = p.y - y0;
      const int square = y / kSquare * (kNormalTileWidth / kSquare) + x / kSquare;
      return static_cast<std::size_t>((square * kParts + y / kPart % kParts) * kParts + x / kPart % kParts);
    };
    std::size_t end[kPlaces + 1] = {};
    for (const Pixel p : left) ++end[place(p) + 1];
    for (std::size_t k = 0; k < kPlaces; ++k) end[k + 1] += end[k];
    thread_local std::vector<Pixel> sorted;
    sorted.resize(left.size());
    for (const Pixel p : left) sorted[end[place(p)]++] = p;  // from here on ends, not beginnings
    constexpr std::size_t kOfSquare = std::size_t{kParts} * kParts;
    for (std::size_t square = 0, first = 0; square < kPlaces / kOfSquare; ++square) {
      const std::size_t last = end[(square + 1) * kOfSquare - 1];
      if (last > first) normals_of_pixels(field_, view_, std::span(sorted).subspan(first, last - first), buffers_);
      first = last;
    }
  }

  const RaycastField& field_;
  const View& view_;
  SurfaceBuffers& buffers_;
  Image<vec3> known_;
  int tiles_x_, tiles_y_;
  std::vector<std::uint8_t> sparse_;
};

}  // namespace

void find_picture_normals(const RaycastField& field, const View& view, std::span<const vec2> points,
                          SurfaceBuffers& buffers) {
  const int width = buffers.depth.width(), height = buffers.depth.height();
  buffers.normal = Image<vec3>(width, height, vec3{0});
  if (points.empty())
    PictureNormals(field, view, buffers).run();
  else
    for_each_block(view, points, [&](const Block& block) { normals_of_block(field, view, block, buffers); });
  if (!field.has_colours()) return;
  buffers.colour = Image<vec3>(width, height, vec3{0});
  for_each_block(view, points, [&](const Block& block) { colours_of_block(field, view, block, buffers); });
}

}  // namespace meniscus
