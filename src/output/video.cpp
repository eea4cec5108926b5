#include <fmt/format.h>
#include <utility>

#include "output/ffmpeg.h"
#include "output/h264.h"
#include "base/temporary_file.h"
#include "output/yuv.h"

extern "C" {
#include <libavutil/log.h>
}

namespace meniscus {
namespace {

Error refused(const std::string& path, std::string problem) {
  ErrorDetail detail;
  detail.problem = std::move(problem);
  detail.path = path;
  return Error(ErrorCode::invalid_argument, detail);
}

Error failed(const std::string& path, int error) {
  ErrorDetail detail;
  detail.problem = "cannot write the film: " + ffmpeg_reason(error);
  detail.path = path;
  return Error(ErrorCode::io_failed, detail);
}

/// FFmpeg and its encoders talk to stderr about every file; what matters of it is in our errors. A program that
/// has chosen a level itself keeps it.
void silence_ffmpeg() {
  if (av_log_get_level() == AV_LOG_INFO) av_log_set_level(AV_LOG_FATAL);
}

constexpr int kLongestSide = 16384;  // px; what H.264 encoders take

/// The checks that come before anything is made.
const std::string& checked(const std::string& path, int width, int height, const VideoOptions& options) {
  if (width < 1 || height < 1)
    throw refused(path, fmt::format("a film of {} x {} pixels cannot be made", width, height));
  if (width > kLongestSide || height > kLongestSide) {
    ErrorDetail detail;
    detail.problem = "H.264 cannot hold pictures of this size";
    detail.expected = fmt::format("sides of at most {} pixels", kLongestSide);
    detail.found = fmt::format("{} x {}", width, height);
    detail.path = path;
    detail.advice = "make the film smaller or write PNG frames";
    throw Error(ErrorCode::unsupported, detail);
  }
  if (options.quality_crf < 0 || options.quality_crf > 51)
    throw refused(path, fmt::format("the quality of a film must be in 0 .. 51, not {}", options.quality_crf));
  frame_rate(options.frames_per_second);
  silence_ffmpeg();
  return path;
}

}  // namespace

/// What a film needs while it is written. Freed in the order from the last to the first: the file is closed
/// before it is removed.
struct VideoWriter::Parts {
  int width, height;
  TemporaryFile file;
  YuvConverter converter;
  FfmpegOwner<AVCodecContext> encoder;
  FfmpegOwner<AVPacket> packet;
  FfmpegOwner<AVFormatContext> muxer;
  AVStream* stream = nullptr;
  std::int64_t frames = 0;
  bool broken = false;  ///< something failed; what there is cannot become a film

  Parts(const std::string& path, int w, int h, const VideoOptions& options)
      : width(w),
        height(h),
        file(checked(path, w, h, options)),
        converter(w, h),
        encoder(open_h264(path, converter.frame_width(), converter.frame_height(),
                          frame_rate(options.frames_per_second), options.quality_crf)),
        packet(av_packet_alloc()) {
    if (!packet) throw std::bad_alloc();
    open_file();
  }

  const std::string& path() const { return file.target(); }

  void check(int result) {
    if (result >= 0) return;
    broken = true;
    throw failed(path(), result);
  }

  /// Writes the file's head. The format is named, as the temporary name does not tell it; "file:" keeps a
  /// colon in the name from being read as a protocol.
  void open_file() {
    const std::string url = "file:" + file.path();
    AVFormatContext* context = nullptr;
    check(avformat_alloc_output_context2(&context, nullptr, "mp4", url.c_str()));
    muxer.reset(context);
    muxer->flags |= AVFMT_FLAG_BITEXACT;  // no version numbers, no times
    stream = avformat_new_stream(context, nullptr);
    if (!stream) throw std::bad_alloc();
    stream->time_base = encoder->time_base;
    stream->avg_frame_rate = encoder->framerate;
    check(avcodec_parameters_from_context(stream->codecpar, encoder.get()));
    check(avio_open(&muxer->pb, url.c_str(), AVIO_FLAG_WRITE));
    AVDictionary* options = nullptr;
    av_dict_set(&options, "movflags", "+faststart", 0);
    const int result = avformat_write_header(context, &options);
    av_dict_free(&options);
    check(result);
  }

  /// Gives a frame to the encoder, null at the end, and what comes out of it to the file.
  void encode(const AVFrame* frame) {
    check(avcodec_send_frame(encoder.get(), frame));
    for (;;) {
      const int result = avcodec_receive_packet(encoder.get(), packet.get());
      if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) break;
      check(result);
      packet->stream_index = stream->index;
      packet->duration = 1;
      av_packet_rescale_ts(packet.get(), encoder->time_base, stream->time_base);
      check(av_interleaved_write_frame(muxer.get(), packet.get()));
    }
    if (muxer->pb->error < 0) check(muxer->pb->error);
  }
};

VideoWriter::VideoWriter(const std::string& path, int width, int height, const VideoOptions& options)
    : parts_(std::make_unique<Parts>(path, width, height, options)) {}

VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;

void VideoWriter::add(const Image<Rgb8>& picture) {
  if (!parts_) throw Error(ErrorCode::invalid_argument, "the film is already finished");
  Parts& parts = *parts_;
  if (picture.width() != parts.width || picture.height() != parts.height)
    throw refused(parts.path(), fmt::format("a picture of {} x {} pixels does not fit into a film of {} x {}",
                                            picture.width(), picture.height(), parts.width, parts.height));
  if (parts.broken) throw refused(parts.path(), "the film could not be written and cannot go on");
  const FfmpegOwner<AVFrame> frame = parts.converter.frame(picture);
  frame->pts = parts.frames;
  parts.encode(frame.get());
  ++parts.frames;
}

void VideoWriter::finish() {
  if (!parts_) throw Error(ErrorCode::invalid_argument, "the film is already finished");
  // Whatever happens, there is nothing to go on with: the parts go, and the temporary file unless it was renamed.
  const std::unique_ptr<Parts> parts = std::move(parts_);
  if (parts->broken) throw refused(parts->path(), "the film could not be written and cannot be finished");
  if (parts->frames == 0) throw refused(parts->path(), "a film needs at least one picture");
  parts->encode(nullptr);
  parts->check(av_write_trailer(parts->muxer.get()));
  if (parts->muxer->pb->error < 0) parts->check(parts->muxer->pb->error);
  parts->check(avio_closep(&parts->muxer->pb));
  parts->file.commit();
}

}  // namespace meniscus
