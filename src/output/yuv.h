#pragma once

#include "meniscus/image.h"
#include "output/ffmpeg.h"

namespace meniscus {

/// Turns pictures into frames of yuv420p, BT.709, limited range.
class YuvConverter {
 public:
  /// @param width, height  of the pictures, px; a frame's are the next even numbers
  YuvConverter(int width, int height);
  int frame_width() const { return width_ + width_ % 2; }
  int frame_height() const { return height_ + height_ % 2; }
  /// A new frame; an odd picture's last row and column are repeated.
  FfmpegOwner<AVFrame> frame(const Image<Rgb8>& picture) const;

 private:
  int width_, height_;
  FfmpegOwner<SwsContext> scaler_;
};

}  // namespace meniscus
