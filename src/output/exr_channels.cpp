#include "output/exr_channels.h"

#include <ImfThreading.h>
#include <fmt/format.h>
#include <algorithm>
#include <mutex>

namespace meniscus {
namespace {

Error refused(const std::string& path, std::string problem) {
  ErrorDetail detail;
  detail.problem = std::move(problem);
  detail.path = path;
  return Error(ErrorCode::invalid_argument, detail);
}

int width_of(const ExrLayer& layer) { return layer.scalar ? layer.scalar->width() : layer.vector->width(); }
int height_of(const ExrLayer& layer) { return layer.scalar ? layer.scalar->height() : layer.vector->height(); }

}  // namespace

std::vector<ExrChannel> exr_channels(const std::string& path, std::span<const ExrLayer> layers) {
  if (layers.empty()) throw refused(path, "an EXR file needs at least one layer");
  std::vector<ExrChannel> channels;
  for (const ExrLayer& layer : layers) {
    if (!layer.scalar == !layer.vector)
      throw refused(path, fmt::format("layer \"{}\" must have either scalars or vectors", layer.name));
    const int width = width_of(layer), height = height_of(layer);
    if (width < 1 || height < 1) throw refused(path, fmt::format("layer \"{}\" has no pixels", layer.name));
    if (width != width_of(layers[0]) || height != height_of(layers[0]))
      throw refused(path, fmt::format("layer \"{}\" of {} x {} pixels differs from \"{}\" of {} x {}", layer.name,
                                      width, height, layers[0].name, width_of(layers[0]), height_of(layers[0])));
    if (layer.scalar) {
      // Y is the format's name of a picture's only channel.
      channels.push_back({layer.name.empty() ? "Y" : layer.name, layer.scalar->data(), 1, layer.half});
      continue;
    }
    const char* letters = layer.is_direction ? "XYZ" : "RGB";
    for (std::size_t i = 0; i < 3; ++i)
      channels.push_back(
          {(layer.name.empty() ? "" : layer.name + ".") + letters[i], &layer.vector->data()->x + i, 3, layer.half});
  }
  std::vector<std::string> names;
  for (const ExrChannel& channel : channels) names.push_back(channel.name);
  std::sort(names.begin(), names.end());
  const auto twice = std::adjacent_find(names.begin(), names.end());
  if (twice != names.end()) throw refused(path, fmt::format("two layers have the channel \"{}\"", *twice));
  return channels;
}

void use_exr_threads() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (Imf::globalThreadCount() == 0) Imf::setGlobalThreadCount(thread_count());
  });
}

}  // namespace meniscus
