/// Environment maps made by tests.
#pragma once

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "meniscus/base.h"

namespace meniscus::tests {

/// A file in the temporary directory that goes with this object.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& bytes) {
    std::string name = (std::filesystem::temp_directory_path() / "meniscus_map_XXXXXX").string();
    const int descriptor = mkstemp(name.data());
    if (descriptor >= 0) ::close(descriptor);
    path_ = name;
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// "R G B E" of a colour whose channels are multiples of 2^-7 of a common power of two; here by the format's rule.
inline std::string rgbe(vec3 colour) {
  const float largest = std::max(colour.x, std::max(colour.y, colour.z));
  if (largest <= 0) return std::string(4, '\0');
  int exponent = 0;
  const float scale = std::frexp(largest, &exponent) * 256.0f / largest;
  const auto channel = [&](float value) { return static_cast<char>(static_cast<unsigned char>(value * scale)); };
  return {channel(colour.x), channel(colour.y), channel(colour.z), static_cast<char>(exponent + 128)};
}

inline std::string hdr_header(int width, int height) {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
}

/// A flat map of colour(x, y).
template <class Colour>
std::string flat_hdr(int width, int height, Colour colour) {
  std::string bytes = hdr_header(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) bytes += rgbe(colour(x, y));
  return bytes;
}

}  // namespace meniscus::tests
