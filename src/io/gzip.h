/// Gzip, decompressed as far as it is needed.
#pragma once

#include <memory>

#include "io/bytes.h"

namespace meniscus::io {

/// A gzip stream of one or more members that grows as it is asked for. What it makes is bounded by
/// believable_size() of the compressed bytes.
class Gunzip {
 public:
  /// @param source  the compressed bytes; must outlive this
  explicit Gunzip(const Source& source);
  ~Gunzip();

  /// Decompresses until there are `size` bytes or the stream ends; bytes().size() tells.
  /// @throws Error malformed_file: damaged or truncated; limit_exceeded: grows beyond all measure
  void grow_to(std::uint64_t size);
  /// Decompresses to the end, so that the checksum is checked, and throws away what is beyond bytes().
  void check_rest();
  std::span<const char> bytes() const { return {buffer_.data(), filled_}; }
  bool ended() const { return ended_; }

 private:
  struct Stream;
  std::size_t inflate_into(char* target, std::size_t room);
  Source source_;
  std::unique_ptr<Stream> stream_;
  Bytes buffer_;
  std::size_t filled_ = 0;
  std::uint64_t made_ = 0;
  bool ended_ = false;
};

}  // namespace meniscus::io
