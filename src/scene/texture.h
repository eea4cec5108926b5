/// Pictures on solids, averaged over what a ray's beam covers of them.
#pragma once

#include <memory>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

/// 8-bit sRGB.
struct Texel {
  std::uint8_t r = 0, g = 0, b = 0;
};

/// A picture with its halvings: level k + 1 holds means of 2 x 2 texels of level k, in linear light. It repeats in
/// both directions.
class Texture {
 public:
  /// @param picture  8-bit sRGB, row 0 at the top, not empty
  explicit Texture(Image<Texel> picture);
  /// Linear colour around a point, interpolated between texels and levels.
  /// @param point  (0, 0) is the lower left corner, (1, 1) the upper right one
  /// @param along  long half axis of the region to average, in the same units
  /// @param width  its short width
  vec3 at(vec2 point, vec2 along, float width) const;
  int width() const { return levels_.front().width(); }
  int height() const { return levels_.front().height(); }

 private:
  vec3 bilinear(std::size_t level, vec2 point) const;
  vec3 trilinear(float level, vec2 point) const;

  std::vector<Image<Texel>> levels_;
};

/// Reads PNG, JPEG, TGA or BMP. Transparency is left out. The same file is kept once while anything uses it.
/// @throws Error not_found, io_failed, malformed_file, limit_exceeded
std::shared_ptr<const Texture> read_texture(const std::string& path);
/// The same from the bytes of such a file.
/// @param path  of the file that holds them, for errors
std::shared_ptr<const Texture> decode_texture(std::span<const unsigned char> bytes, const std::string& path);

}  // namespace meniscus
