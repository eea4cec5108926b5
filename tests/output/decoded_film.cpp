#include "output/decoded_film.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "output/ffmpeg.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace meniscus {
namespace {

void must(int result) {
  if (result < 0) throw std::runtime_error(ffmpeg_reason(result));
}

std::string text(const char* name) { return name ? name : ""; }

/// By the definition of BT.709 in limited range, with the chroma of the sample's own 2 x 2 block.
Image<Rgb8> rgb_of(const AVFrame& frame) {
  Image<Rgb8> picture(frame.width, frame.height);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const double luma = (frame.data[0][y * frame.linesize[0] + x] - 16) / 219.0;
      const double cb = (frame.data[1][y / 2 * frame.linesize[1] + x / 2] - 128) / 224.0;
      const double cr = (frame.data[2][y / 2 * frame.linesize[2] + x / 2] - 128) / 224.0;
      const double r = luma + 1.5748 * cr, b = luma + 1.8556 * cb;
      const double g = (luma - 0.2126 * r - 0.0722 * b) / 0.7152;
      const auto eight = [](double v) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0, 1.0))); };
      picture(x, y) = {eight(r), eight(g), eight(b)};
    }
  return picture;
}

struct CloseInput {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};

}  // namespace

DecodedFilm decoded_film(const std::string& path) {
  AVFormatContext* opened = nullptr;
  must(avformat_open_input(&opened, ("file:" + path).c_str(), nullptr, nullptr));
  const std::unique_ptr<AVFormatContext, CloseInput> input(opened);
  must(avformat_find_stream_info(input.get(), nullptr));
  const AVCodec* codec = nullptr;
  const int index = av_find_best_stream(input.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
  must(index);
  const AVStream& stream = *input->streams[index];
  const FfmpegOwner<AVCodecContext> decoder(avcodec_alloc_context3(codec));
  must(avcodec_parameters_to_context(decoder.get(), stream.codecpar));
  must(avcodec_open2(decoder.get(), codec, nullptr));

  DecodedFilm film;
  film.codec = codec->name;
  film.container = input->iformat->name;
  film.rate_numerator = stream.avg_frame_rate.num;
  film.rate_denominator = stream.avg_frame_rate.den;
  film.seconds = static_cast<double>(stream.duration) * av_q2d(stream.time_base);
  const FfmpegOwner<AVPacket> packet(av_packet_alloc());
  const FfmpegOwner<AVFrame> frame(av_frame_alloc());
  const auto receive = [&] {
    while (avcodec_receive_frame(decoder.get(), frame.get()) == 0) {
      film.times.push_back(static_cast<double>(frame->pts) * av_q2d(stream.time_base));
      film.frames.push_back(rgb_of(*frame));
      film.pixel_format = text(av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame->format)));
      film.matrix = text(av_color_space_name(frame->colorspace));
      film.primaries = text(av_color_primaries_name(frame->color_primaries));
      film.transfer = text(av_color_transfer_name(frame->color_trc));
      film.range = text(av_color_range_name(frame->color_range));
    }
  };
  while (av_read_frame(input.get(), packet.get()) >= 0) {
    if (packet->stream_index == index) must(avcodec_send_packet(decoder.get(), packet.get()));
    av_packet_unref(packet.get());
    receive();
  }
  must(avcodec_send_packet(decoder.get(), nullptr));
  receive();
  film.width = decoder->width;
  film.height = decoder->height;
  return film;
}

}  // namespace meniscus
