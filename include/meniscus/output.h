/// Files out: PNG, EXR with layers, MP4. Written to a temporary name beside the target and renamed, so that a
/// file of the final name is always whole.
#pragma once

#include <memory>
#include <string_view>

#include "meniscus/base.h"
#include "meniscus/image.h"

namespace meniscus {

/// @throws Error io_failed naming the path
void write_png(const std::string& path, const Image<Rgb8>& picture);
/// 8- and 16-bit PNG of any colour type as 8-bit RGB (alpha is dropped).
Image<Rgb8> read_png(const std::string& path);

/// One layer of an EXR file: exactly one of `scalar` and `vector` is set; 32-bit float unless half.
struct ExrLayer {
  std::string name = {};  ///< "" for the main R, G, B; else channels name.R/G/B, name.X/Y/Z or name
  const Image<float>* scalar = nullptr;
  const Image<vec3>* vector = nullptr;
  bool is_direction = false;  ///< channels X, Y, Z instead of R, G, B
  bool half = false;
};
void write_exr(const std::string& path, std::span<const ExrLayer> layers);
/// The same channels back by their full names, for tests and compare.
std::vector<std::pair<std::string, Image<float>>> read_exr(const std::string& path);

/// Points with normals and radii, such as surfels, as a binary little-endian PLY file: x, y, z, nx, ny, nz, radius of
/// each vertex as 32-bit floats.
/// @throws Error invalid_argument: arrays of different lengths; io_failed naming the path
void write_point_ply(const std::string& path, std::span<const vec3> positions, std::span<const vec3> normals,
                     std::span<const float> radii);

struct VideoOptions {
  double frames_per_second = 25;
  int quality_crf = 18;  ///< constant quality, 0 best .. 51 worst
};
/// An MP4 of H.264, yuv420p; odd sizes are padded by repeating the last row or column.
class VideoWriter {
 public:
  /// @throws Error io_failed, unsupported: no H.264 encoder
  VideoWriter(const std::string& path, int width, int height, const VideoOptions& options);
  ~VideoWriter();  ///< removes the temporary file unless finish() was called
  VideoWriter(VideoWriter&&) noexcept;
  void add(const Image<Rgb8>& picture);
  /// Writes what is left and gives the file its name.
  void finish();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Writes a text file, whole or not at all. @throws Error io_failed naming the path
void write_text(const std::string& path, std::string_view text);

}  // namespace meniscus
