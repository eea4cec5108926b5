/// CRC-32 as zip archives have it.
#pragma once

#include <mutex>

#include "io/bytes.h"

namespace meniscus::io {

/// Of bytes in memory, on this thread.
std::uint32_t crc32_of(std::span<const char> bytes);

/// Of bytes that may have to be read, on all threads.
/// @throws Error  as FileBytes::fetch()
std::uint32_t crc32_of(Stored first, std::size_t size);

/// That of two parts one after the other, the second of `size` bytes.
std::uint32_t crc32_joined(std::uint32_t first, std::uint32_t second, std::size_t size);

/// Sums of pieces of a file that were read, so that the sum of many pieces needs no second reading.
class PieceSums {
 public:
  struct Piece {
    std::size_t begin = 0;  ///< byte offsets in the file
    std::size_t end = 0;
    std::uint32_t sum = 0;
  };
  /// By any thread.
  void add(std::size_t offset, std::span<const char> bytes);
  /// Those that lie in a part of the file, in its order, none inside of another one's bytes. There may be gaps.
  std::vector<Piece> within(std::size_t begin, std::size_t end) const;

 private:
  mutable std::mutex mutex_;
  std::vector<Piece> pieces_;
};

}  // namespace meniscus::io
