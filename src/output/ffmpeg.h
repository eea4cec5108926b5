#pragma once

/// FFmpeg's C headers, its objects as owners, its errors as ours.

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

#include <memory>
#include <string>

namespace meniscus {

struct FreeFfmpeg {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(SwsContext* context) const { sws_freeContext(context); }
  /// Closes the file, too, if it is still open.
  void operator()(AVFormatContext* context) const {
    if (context->pb) avio_closep(&context->pb);
    avformat_free_context(context);
  }
};
template <class T>
using FfmpegOwner = std::unique_ptr<T, FreeFfmpeg>;

/// "Operation not permitted", "Invalid data found when processing input" ...
std::string ffmpeg_reason(int error);

}  // namespace meniscus
