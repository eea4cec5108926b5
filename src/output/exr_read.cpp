#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <algorithm>
#include <exception>

#include "meniscus/output.h"
#include "output/exr_attributes.h"
#include "output/exr_channels.h"
#include "output/file_bytes.h"

namespace meniscus {
namespace {

/// A file that has been read into memory.
class ExrBytes : public Imf::IStream {
 public:
  ExrBytes(const std::string& path, std::span<const unsigned char> bytes) : Imf::IStream(path.c_str()), bytes_(bytes) {}

  bool read(char to[], int count) override {
    const auto wanted = static_cast<std::uint64_t>(count);
    if (count < 0 || position_ > bytes_.size() || wanted > bytes_.size() - position_)
      throw Iex::InputExc("it ends too early");
    std::copy_n(bytes_.data() + position_, wanted, to);
    position_ += wanted;
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  std::span<const unsigned char> bytes_;
  std::uint64_t position_ = 0;
};

/// The size of the picture, after checks that must come before OpenEXR makes room for its rows.
Imath::V2i checked_size(const std::string& path, std::span<const unsigned char> bytes) {
  check_exr_attributes(path, bytes);
  ExrBytes stream(path, bytes);
  stream.seekg(8);  // behind the magic number and the version
  int version = 2;
  Imf::Header header;
  header.readFrom(stream, version);
  header.sanityCheck(false, false);
  const Imath::Box2i window = header.dataWindow();
  const double width = static_cast<double>(window.max.x) - window.min.x + 1;
  const double height = static_cast<double>(window.max.y) - window.min.y + 1;
  double channels = 0;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel, ++channels)
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1) {
      ErrorDetail detail;
      detail.problem = std::string("the EXR file's channel ") + channel.name() + " does not have a value a pixel";
      detail.path = path;
      throw Error(ErrorCode::unsupported, detail);
    }
  check_size_is_justified(path, width * height * std::max(channels, 1.0) * sizeof(float), bytes.size());
  return {static_cast<int>(width), static_cast<int>(height)};
}

std::vector<std::pair<std::string, Image<float>>> decoded(const std::string& path,
                                                          std::span<const unsigned char> bytes) {
  const Imath::V2i size = checked_size(path, bytes);
  ExrBytes stream(path, bytes);
  Imf::InputFile file(stream, thread_count());
  const Imf::Header& header = file.header();
  std::vector<std::pair<std::string, Image<float>>> channels;
  for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
    channels.emplace_back(channel.name(), Image<float>(size.x, size.y));
  Imf::FrameBuffer buffer;
  for (auto& [name, image] : channels)
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, image.data(), header.dataWindow()));
  file.setFrameBuffer(buffer);
  file.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
  return channels;
}

}  // namespace

std::vector<std::pair<std::string, Image<float>>> read_exr(const std::string& path) {
  const std::vector<unsigned char> bytes = file_bytes(path);
  use_exr_threads();
  try {
    return decoded(path, bytes);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {  // OpenEXR's own and those of the library below it
    throw malformed(path, std::string("the EXR file is broken: ") + error.what());
  }
}

}  // namespace meniscus
