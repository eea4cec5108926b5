#pragma once

#include <string>
#include <vector>

#include "meniscus/output.h"

namespace meniscus {

/// One channel of an EXR file and where its values lie.
struct ExrChannel {
  std::string name;    ///< full: "normal.X"
  const float* first;  ///< value of the top left pixel
  std::size_t stride;  ///< floats from one pixel to the next
  bool half;
};

/// What the layers are in the file.
/// @throws Error invalid_argument naming the path: no layers, a layer without or with two images, sizes that
///   differ or are zero, a channel name twice
std::vector<ExrChannel> exr_channels(const std::string& path, std::span<const ExrLayer> layers);

/// Lets OpenEXR pack and unpack on as many threads as the machine has, unless the program has set that up.
void use_exr_threads();

}  // namespace meniscus
