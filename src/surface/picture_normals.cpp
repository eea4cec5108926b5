#include "surface/picture_normals.h"

#include "surface/picture_blocks.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void normals_of_block(const RaycastField& field, const View& view, const Block& block, SurfaceBuffers& buffers) {
  thread_local PacketList list;
  PacketMask mask = 0;
  for (int l = 0; l < kPacket; ++l)
    if (((block.mask >> l) & 1u) && buffers.depth[block.targets[l]] < kInfinity) mask |= 1u << l;
  if (mask == 0) return;
  PacketPoints points, towards, normals;
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
  normals_packet(field, points, mask, towards, list, normals);
  for (int l = 0; l < kPacket; ++l)
    if ((mask >> l) & 1u) {
      // A ray that starts in the water meets the face that the view's plane cuts.
      const bool cut = buffers.depth[block.targets[l]] <= 0.0f && !buffers.eye_in_water;
      buffers.normal[block.targets[l]] =
          cut ? vec3{towards.x[l], towards.y[l], towards.z[l]} : vec3{normals.x[l], normals.y[l], normals.z[l]};
    }
  if (!field.has_colours()) return;
  PacketPoints colours;
  colours_packet(field, points, mask, list, colours);
  for (int l = 0; l < kPacket; ++l)
    if ((mask >> l) & 1u) buffers.colour[block.targets[l]] = {colours.x[l], colours.y[l], colours.z[l]};
}

}  // namespace

void find_picture_normals(const RaycastField& field, const View& view, std::span<const vec2> points,
                          SurfaceBuffers& buffers) {
  const int width = buffers.depth.width(), height = buffers.depth.height();
  buffers.normal = Image<vec3>(width, height, vec3{0});
  if (field.has_colours()) buffers.colour = Image<vec3>(width, height, vec3{0});
  for_each_block(view, points, [&](const Block& block) { normals_of_block(field, view, block, buffers); });
}

}  // namespace meniscus
