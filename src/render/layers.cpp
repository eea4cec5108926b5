#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/render.h"

namespace meniscus {
namespace {

/// Compositors expect the depth along the viewing direction; ours is along the ray.
Image<float> planar_depth(const View& view, const Image<float>& along_ray) {
  Image<float> planar = along_ray;
  for (int y = 0; y < planar.height(); ++y)
    for (int x = 0; x < planar.width(); ++x) {
      const vec2 point{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
      if (std::isfinite(planar(x, y))) planar(x, y) *= glm::dot(view.ray(point).direction, view.forward);
    }
  return planar;
}

}  // namespace

std::vector<std::string> layer_names() { return {"radiance", "depth", "normal", "thickness", "coverage", "colour"}; }

void write_layers(const std::string& path, const FramePicture& frame, const View& view,
                  std::span<const std::string> layers) {
  const std::vector<std::string> known = layer_names();
  for (const std::string& name : layers)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(
          ErrorCode::invalid_argument,
          {"there is no such layer", "radiance, depth, normal, thickness, coverage, colour", name, {}, {}, {}, {}});
  const auto wanted = [&](const char* name) {
    return layers.empty() || std::find(layers.begin(), layers.end(), name) != layers.end();
  };
  const SurfaceBuffers& buffers = frame.buffers;
  Image<float> depth;
  std::vector<ExrLayer> written;
  if (wanted("radiance")) written.push_back({"", nullptr, &frame.radiance, false, false});
  if (wanted("depth") && !buffers.depth.empty()) {
    depth = planar_depth(view, buffers.depth);
    written.push_back({"Z", &depth, nullptr, false, false});
  }
  if (wanted("normal") && !buffers.normal.empty()) written.push_back({"normal", nullptr, &buffers.normal, true, false});
  if (wanted("thickness") && !buffers.thickness.empty())
    written.push_back({"thickness", &buffers.thickness, nullptr, false, false});
  if (wanted("coverage")) written.push_back({"coverage", &buffers.coverage, nullptr, false, false});
  if (wanted("colour") && !buffers.colour.empty())
    written.push_back({"colour", nullptr, &buffers.colour, false, false});
  if (written.empty())
    throw Error(ErrorCode::invalid_argument, {"none of the layers that were asked for exists in this picture",
                                              {},
                                              {},
                                              path,
                                              {},
                                              {},
                                              "colour the particles, or ask for other layers"});
  write_exr(path, written);
}

}  // namespace meniscus
