#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <algorithm>
#include <cmath>
#include <exception>

#include "meniscus/output.h"
#include "output/exr_channels.h"
#include "base/temporary_file.h"

namespace meniscus {
namespace {

/// OpenEXR's own file stream does not tell when the last bytes could not be written; this one keeps the first
/// failure. (The end of the file is written by a destructor, from which nothing can be thrown.)
class ExrStream : public Imf::OStream {
 public:
  ExrStream(const std::string& path, TemporaryStream& stream) : Imf::OStream(path.c_str()), stream_(stream) {}

  void write(const char bytes[], int count) override {
    attempt([&] { stream_.write({bytes, static_cast<std::size_t>(count)}); });
    position_ += static_cast<std::uint64_t>(count);
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override {
    attempt([&] { stream_.seek(position); });
    position_ = position;
  }
  std::exception_ptr failure() const { return failure_; }

 private:
  template <class Action>
  void attempt(Action action) {
    if (!failure_) {
      try {
        action();
        return;
      } catch (...) {
        failure_ = std::current_exception();
      }
    }
    throw Iex::IoExc("writing failed");
  }

  TemporaryStream& stream_;
  std::uint64_t position_ = 0;
  std::exception_ptr failure_;
};

/// Infinity and NaN stay, finite values stay finite.
half half_of(float value) {
  constexpr float kLargest = 65504.0f;
  return std::isfinite(value) ? half(std::clamp(value, -kLargest, kLargest)) : half(value);
}

std::vector<half> halves_of(const ExrChannel& channel, std::size_t count) {
  std::vector<half> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = half_of(channel.first[i * channel.stride]);
  return values;
}

void encode(ExrStream& stream, std::span<const ExrChannel> channels, int width, int height) {
  Imf::Header header(width, height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer buffer;
  std::vector<std::vector<half>> converted;
  for (const ExrChannel& channel : channels) {
    const Imf::PixelType type = channel.half ? Imf::HALF : Imf::FLOAT;
    const void* first = channel.first;
    std::size_t stride = channel.stride * sizeof(float);
    if (channel.half) {
      converted.push_back(halves_of(channel, static_cast<std::size_t>(width) * static_cast<std::size_t>(height)));
      first = converted.back().data();
      stride = sizeof(half);
    }
    header.channels().insert(channel.name, Imf::Channel(type));
    buffer.insert(channel.name, Imf::Slice::Make(type, first, Imath::V2i(0), width, height, stride,
                                                 stride * static_cast<std::size_t>(width)));
  }
  Imf::OutputFile file(stream, header, thread_count());
  file.setFrameBuffer(buffer);
  file.writePixels(height);
}

}  // namespace

void write_exr(const std::string& path, std::span<const ExrLayer> layers) {
  const std::vector<ExrChannel> channels = exr_channels(path, layers);
  const int width = layers[0].scalar ? layers[0].scalar->width() : layers[0].vector->width();
  const int height = layers[0].scalar ? layers[0].scalar->height() : layers[0].vector->height();
  use_exr_threads();
  TemporaryStream file(path);
  ExrStream stream(path, file);
  try {
    encode(stream, channels, width, height);
  } catch (const Iex::BaseExc& error) {
    if (!stream.failure()) {
      ErrorDetail detail;
      detail.problem = std::string("the layers cannot be encoded as EXR: ") + error.what();
      detail.path = path;
      throw Error(ErrorCode::invalid_argument, detail);
    }
  }
  if (stream.failure()) std::rethrow_exception(stream.failure());
  file.commit();
}

}  // namespace meniscus
