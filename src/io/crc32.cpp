#include "io/crc32.h"

#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>

#include "io/file_bytes.h"

namespace meniscus::io {

std::uint32_t crc32_of(std::span<const char> bytes) { return libdeflate_crc32(0, bytes.data(), bytes.size()); }

std::uint32_t crc32_of(Stored first, std::size_t size) {
  // Pieces in parallel, joined in their order.
  constexpr std::size_t kPiece = std::size_t{1} << 18;
  std::vector<std::uint32_t> sums((size + kPiece - 1) / kPiece);
  PieceBuffers buffers;
  parallel_for(size, kPiece, [&](std::size_t begin, std::size_t end) {
    PieceBuffers::Lease buffer(buffers);
    sums[begin / kPiece] = crc32_of({buffer->bytes(first + begin, end - begin), end - begin});
  });
  std::uint32_t all = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) all = crc32_joined(all, sums[i], std::min(kPiece, size - i * kPiece));
  return all;
}

std::uint32_t crc32_joined(std::uint32_t first, std::uint32_t second, std::size_t size) {
  return static_cast<std::uint32_t>(crc32_combine(first, second, static_cast<z_off_t>(size)));
}

void PieceSums::add(std::size_t offset, std::span<const char> bytes) {
  const Piece piece{offset, offset + bytes.size(), crc32_of(bytes)};
  const std::lock_guard lock(mutex_);
  pieces_.push_back(piece);
}

std::vector<PieceSums::Piece> PieceSums::within(std::size_t begin, std::size_t end) const {
  std::vector<Piece> chosen;
  {
    const std::lock_guard lock(mutex_);
    std::copy_if(pieces_.begin(), pieces_.end(), std::back_inserter(chosen),
                 [&](const Piece& piece) { return piece.begin >= begin && piece.end <= end; });
  }
  std::sort(chosen.begin(), chosen.end(),
            [](const Piece& a, const Piece& b) { return a.begin != b.begin ? a.begin < b.begin : a.end > b.end; });
  std::vector<Piece> apart;
  for (const Piece& piece : chosen)
    if (apart.empty() || piece.begin >= apart.back().end) apart.push_back(piece);
  return apart;
}

}  // namespace meniscus::io
