#include "output/yuv.h"

#include <algorithm>

extern "C" {
#include <libavutil/frame.h>
}

namespace meniscus {
namespace {

Image<Rgb8> padded(const Image<Rgb8>& picture, int width, int height) {
  Image<Rgb8> even(width, height);
  for (int y = 0; y < height; ++y) {
    const Rgb8* from = picture.row(std::min(y, picture.height() - 1));
    Rgb8* to = std::copy_n(from, picture.width(), even.row(y));
    if (width > picture.width()) *to = from[picture.width() - 1];
  }
  return even;
}

}  // namespace

YuvConverter::YuvConverter(int width, int height) : width_(width), height_(height) {
  // Exact rounding, the same on every processor, and chroma from all of the pixels that it stands for.
  const int flags = SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT | SWS_FULL_CHR_H_INP | SWS_FULL_CHR_H_INT;
  scaler_.reset(sws_getContext(frame_width(), frame_height(), AV_PIX_FMT_RGB24, frame_width(), frame_height(),
                               AV_PIX_FMT_YUV420P, flags, nullptr, nullptr, nullptr));
  if (!scaler_) throw Error(ErrorCode::unsupported, "FFmpeg's libswscale cannot convert RGB to yuv420p");
  const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
  constexpr int kFull = 1, kLimited = 0, kOne = 1 << 16;
  sws_setColorspaceDetails(scaler_.get(), bt709, kFull, bt709, kLimited, 0, kOne, kOne);
}

FfmpegOwner<AVFrame> YuvConverter::frame(const Image<Rgb8>& picture) const {
  FfmpegOwner<AVFrame> frame(av_frame_alloc());
  if (!frame) throw std::bad_alloc();
  frame->format = AV_PIX_FMT_YUV420P;
  frame->width = frame_width();
  frame->height = frame_height();
  frame->color_range = AVCOL_RANGE_MPEG;
  frame->colorspace = AVCOL_SPC_BT709;
  frame->color_primaries = AVCOL_PRI_BT709;
  frame->color_trc = AVCOL_TRC_BT709;
  frame->chroma_location = AVCHROMA_LOC_LEFT;
  if (av_frame_get_buffer(frame.get(), 0) < 0) throw std::bad_alloc();

  const bool even = width_ == frame_width() && height_ == frame_height();
  const Image<Rgb8> copy = even ? Image<Rgb8>() : padded(picture, frame_width(), frame_height());
  const std::uint8_t* planes[4] = {&(even ? picture : copy).data()->r, nullptr, nullptr, nullptr};
  const int strides[4] = {3 * frame_width(), 0, 0, 0};
  sws_scale(scaler_.get(), planes, strides, 0, frame_height(), frame->data, frame->linesize);
  return frame;
}

}  // namespace meniscus
