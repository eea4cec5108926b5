#include "output/h264.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

extern "C" {
#include <libavutil/opt.h>
}

namespace meniscus {
namespace {

constexpr int kThreads = 4;

bool takes_yuv420p(const AVCodec* codec) {
  for (const AVPixelFormat* format = codec->pix_fmts; format && *format != AV_PIX_FMT_NONE; ++format)
    if (*format == AV_PIX_FMT_YUV420P) return true;
  return !codec->pix_fmts;
}

/// All H.264 encoders of this FFmpeg that can take pictures from memory, the best first.
std::vector<const AVCodec*> encoders() {
  std::vector<const AVCodec*> found;
  for (const char* name : {"libx264", "libopenh264"})
    if (const AVCodec* codec = avcodec_find_encoder_by_name(name)) found.push_back(codec);
  void* position = nullptr;
  while (const AVCodec* codec = av_codec_iterate(&position))
    if (codec->id == AV_CODEC_ID_H264 && av_codec_is_encoder(codec) && takes_yuv420p(codec) &&
        std::find(found.begin(), found.end(), codec) == found.end())
      found.push_back(codec);
  return found;
}

FfmpegOwner<AVCodecContext> prepared(const AVCodec* codec, int width, int height, FrameRate rate, int quality_crf) {
  FfmpegOwner<AVCodecContext> context(avcodec_alloc_context3(codec));
  if (!context) throw std::bad_alloc();
  context->width = width;
  context->height = height;
  context->pix_fmt = AV_PIX_FMT_YUV420P;
  context->sample_aspect_ratio = {1, 1};
  context->time_base = {rate.denominator, rate.numerator};
  context->framerate = {rate.numerator, rate.denominator};
  context->color_range = AVCOL_RANGE_MPEG;
  context->colorspace = AVCOL_SPC_BT709;
  context->color_primaries = AVCOL_PRI_BT709;
  context->color_trc = AVCOL_TRC_BT709;
  context->chroma_sample_location = AVCHROMA_LOC_LEFT;
  context->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;  // MP4 keeps the parameter sets outside of the stream
  context->thread_count = kThreads;
  if (std::string_view(codec->name) == "libx264") {
    av_opt_set_double(context->priv_data, "crf", quality_crf, 0);
    av_opt_set(context->priv_data, "preset", "medium", 0);
  } else {
    // Roughly what x264 needs for rendered water: 0.15 bits a pixel at 23, half of it for every 6 more.
    const double pixels_per_second = static_cast<double>(width) * height * rate.numerator / rate.denominator;
    context->bit_rate = std::llround(0.15 * pixels_per_second * std::exp2((23 - quality_crf) / 6.0)) + 100'000;
  }
  return context;
}

}  // namespace

FfmpegOwner<AVCodecContext> open_h264(const std::string& path, int width, int height, FrameRate rate, int quality_crf) {
  std::string reasons;
  for (const AVCodec* codec : encoders()) {
    FfmpegOwner<AVCodecContext> context = prepared(codec, width, height, rate, quality_crf);
    const int result = avcodec_open2(context.get(), codec, nullptr);
    if (result >= 0) return context;
    reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : ", ", codec->name, ffmpeg_reason(result));
  }
  ErrorDetail detail;
  detail.problem = reasons.empty() ? std::string("FFmpeg's libraries have no encoder for H.264")
                                   : fmt::format("no H.264 encoder takes pictures of {} x {} pixels", width, height);
  detail.found = reasons;
  detail.path = path;
  detail.advice = "write PNG frames";
  throw Error(ErrorCode::unsupported, detail);
}

}  // namespace meniscus
