#include "io/gzip.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <limits>

namespace meniscus::io {

struct Gunzip::Stream {
  z_stream z{};
  std::size_t read = 0;  ///< compressed bytes handed to zlib so far
  Stream() {
    constexpr int kGzipOnly = 16 + MAX_WBITS;
    if (inflateInit2(&z, kGzipOnly) != Z_OK) throw Error(ErrorCode::io_failed, "zlib does not start");
  }
  ~Stream() { inflateEnd(&z); }
};

Gunzip::Gunzip(const Source& source) : source_(source), stream_(std::make_unique<Stream>()) {}
Gunzip::~Gunzip() = default;

/// Fills `target` as far as the stream goes. Returns the bytes written.
std::size_t Gunzip::inflate_into(char* target, std::size_t room) {
  constexpr std::size_t kMost = std::numeric_limits<uInt>::max() / 2;
  z_stream& z = stream_->z;
  std::size_t written = 0;
  while (written < room && !ended_) {
    // zlib counts in 32 bits: hand out both sides in pieces.
    const std::size_t in = std::min(kMost, source_.bytes.size() - stream_->read);
    const std::size_t out = std::min(kMost, room - written);
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(source_.bytes.data() + stream_->read));
    z.avail_in = static_cast<uInt>(in);
    z.next_out = reinterpret_cast<Bytef*>(target + written);
    z.avail_out = static_cast<uInt>(out);
    const int status = inflate(&z, Z_NO_FLUSH);
    const std::size_t consumed = in - z.avail_in;
    const std::size_t produced = out - z.avail_out;
    stream_->read += consumed;
    written += produced;
    made_ += produced;

    if (status == Z_STREAM_END) {
      // Another member may follow; anything else after the end is padding.
      const auto rest = source_.bytes.subspan(stream_->read);
      if (rest.size() >= 2 && rest[0] == '\x1f' && rest[1] == '\x8b') {
        inflateReset(&z);
      } else {
        ended_ = true;
      }
    } else if (status == Z_BUF_ERROR || (status == Z_OK && consumed == 0 && produced == 0)) {
      source_.malformed("the compressed data end early", source_.bytes.size());
    } else if (status == Z_MEM_ERROR) {
      throw std::bad_alloc();
    } else if (status != Z_OK) {
      source_.malformed("the compressed data are damaged", stream_->read, "a gzip stream",
                        z.msg != nullptr ? z.msg : "something else");
    }
    if (made_ > believable_size(source_.bytes.size())) {
      throw Error(ErrorCode::limit_exceeded, {"the compressed data grow beyond what particles would",
                                              fmt::format("at most {} bytes", believable_size(source_.bytes.size())),
                                              "more",
                                              source_.path,
                                              {},
                                              {},
                                              "decompress the file first if it is sound"});
    }
  }
  return written;
}

void Gunzip::grow_to(std::uint64_t size) {
  // Doubling from four times the compressed size: memory follows what really comes out.
  while (filled_ < size && !ended_) {
    const std::uint64_t first = std::max<std::uint64_t>(4 * source_.bytes.size(), 1 << 16);
    const std::uint64_t wanted = std::min(size, std::max<std::uint64_t>(first, 2 * filled_));
    if (buffer_.size() < wanted) buffer_.resize(static_cast<std::size_t>(wanted));
    filled_ += inflate_into(buffer_.data() + filled_, buffer_.size() - filled_);
  }
}

void Gunzip::check_rest() {
  Bytes scratch(1 << 16);
  while (!ended_) inflate_into(scratch.data(), scratch.size());
}

}  // namespace meniscus::io
