#include "output/png_rows.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

namespace meniscus {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18;   ///< bytes compressed by themselves, about
constexpr std::size_t kWindow = std::size_t{1} << 15;  ///< bytes that deflate looks back
constexpr std::size_t kPixel = 3;                      ///< bytes
constexpr std::size_t kFilters = 5;

/// One of deflate's ways into raw data, ended with it.
class Deflation {
 public:
  explicit Deflation(int level) {
    // Without zlib's own header and sum: a piece is the middle of a stream.
    if (deflateInit2(&stream_, level, Z_DEFLATED, -15, 8, Z_FILTERED) != Z_OK)
      throw Error(ErrorCode::limit_exceeded, "zlib gets no memory");
  }
  ~Deflation() { deflateEnd(&stream_); }
  Deflation(const Deflation&) = delete;
  Deflation& operator=(const Deflation&) = delete;

  /// @param before  what came before the data, as far as it is to be looked back at
  std::vector<unsigned char> run(std::span<const unsigned char> before, std::span<const unsigned char> data,
                                 bool last) {
    if (!before.empty()) deflateSetDictionary(&stream_, before.data(), static_cast<uInt>(before.size()));
    std::vector<unsigned char> out(deflateBound(&stream_, static_cast<uLong>(data.size())) + 64);
    stream_.next_in = const_cast<unsigned char*>(data.data());  // zlib does not write there
    stream_.avail_in = static_cast<uInt>(data.size());
    std::size_t written = 0;
    do {
      if (written == out.size()) out.resize(2 * out.size());
      stream_.next_out = out.data() + written;
      stream_.avail_out = static_cast<uInt>(out.size() - written);
      deflate(&stream_, last ? Z_FINISH : Z_SYNC_FLUSH);
      written = out.size() - stream_.avail_out;
    } while (stream_.avail_out == 0);
    out.resize(written);
    return out;
  }

 private:
  z_stream stream_{};
};

/// What a filtered byte adds to a row's cost: its size as a signed number.
int cost(unsigned char byte) { return byte < 128 ? byte : 256 - byte; }

/// Paeth's predictor: of left, above and above left the one that is nearest to left + above - above left.
unsigned char paeth(int left, int above, int corner) {
  const int to_left = std::abs(above - corner), to_above = std::abs(left - corner),
            to_corner = std::abs(left + above - 2 * corner);
  const int other = to_above <= to_corner ? above : corner;
  return static_cast<unsigned char>(((to_left <= to_above) & (to_left <= to_corner)) ? left : other);
}

/// A row by each of PNG's filters.
class Filter {
 public:
  /// @param bytes  of a row
  explicit Filter(std::size_t bytes) : bytes_(bytes) {
    for (auto& row : rows_) row.resize(bytes);
  }

  /// Writes the filter's number and the filtered row: by the filter that makes the numbers smallest.
  /// @param row, above  preceded by a pixel of zeros
  void run(const unsigned char* row, const unsigned char* above, unsigned char* out) {
    std::array<long, kFilters> costs{};
    fill(0, costs, [&](std::size_t i) { return row[i]; });
    fill(1, costs, [&](std::size_t i) { return row[i] - row[i - kPixel]; });
    fill(2, costs, [&](std::size_t i) { return row[i] - above[i]; });
    fill(3, costs, [&](std::size_t i) { return row[i] - (row[i - kPixel] + above[i]) / 2; });
    fill(4, costs, [&](std::size_t i) { return row[i] - paeth(row[i - kPixel], above[i], above[i - kPixel]); });
    const auto best = std::min_element(costs.begin(), costs.end()) - costs.begin();
    *out = static_cast<unsigned char>(best);
    std::memcpy(out + 1, rows_[static_cast<std::size_t>(best)].data(), bytes_);
  }

 private:
  template <class Value>
  void fill(std::size_t filter, std::array<long, kFilters>& costs, Value value) {
    unsigned char* out = rows_[filter].data();
    for (std::size_t i = 0; i < bytes_; ++i) out[i] = static_cast<unsigned char>(value(i));
    // In short sums, which fit into the same vectors as the bytes.
    for (std::size_t first = 0; first < bytes_; first += 4096) {
      int sum = 0;
      for (std::size_t i = first; i < std::min(first + 4096, bytes_); ++i) sum += cost(out[i]);
      costs[filter] += sum;
    }
  }

  std::size_t bytes_;
  std::array<std::vector<unsigned char>, kFilters> rows_;
};

std::vector<unsigned char> filtered(const Image<Rgb8>& picture) {
  const std::size_t bytes = kPixel * static_cast<std::size_t>(picture.width());
  const auto rows = static_cast<std::size_t>(picture.height());
  std::vector<unsigned char> result(rows * (bytes + 1));
  parallel_for(rows, 32, [&](std::size_t begin, std::size_t end) {
    Filter filter(bytes);
    std::vector<unsigned char> row(kPixel + bytes), above(kPixel + bytes);
    if (begin > 0) std::memcpy(above.data() + kPixel, picture.row(static_cast<int>(begin) - 1), bytes);
    for (std::size_t y = begin; y < end; ++y) {
      std::memcpy(row.data() + kPixel, picture.row(static_cast<int>(y)), bytes);
      filter.run(row.data() + kPixel, above.data() + kPixel, result.data() + y * (bytes + 1));
      row.swap(above);
    }
  });
  return result;
}

}  // namespace

std::vector<std::vector<unsigned char>> compressed_rows(const Image<Rgb8>& picture, int level) {
  const std::vector<unsigned char> data = filtered(picture);
  const std::size_t count = (data.size() + kPiece - 1) / kPiece;
  std::vector<std::vector<unsigned char>> pieces(count);
  std::vector<uLong> sums(count);
  const auto piece_of = [&](std::size_t k) {
    return std::span(data).subspan(k * kPiece, std::min(kPiece, data.size() - k * kPiece));
  };
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t back = std::min(k * kPiece, kWindow);
      pieces[k] = Deflation(level).run(std::span(data).subspan(k * kPiece - back, back), piece_of(k), k + 1 == count);
      sums[k] = adler32(1, piece_of(k).data(), static_cast<uInt>(piece_of(k).size()));
    }
  });
  // The stream's head (deflate, a window of 32 KiB, fast) and its sum at the end.
  pieces.front().insert(pieces.front().begin(), {0x78, 0x5E});
  uLong sum = sums[0];
  for (std::size_t k = 1; k < count; ++k) sum = adler32_combine(sum, sums[k], static_cast<z_off_t>(piece_of(k).size()));
  for (int shift = 24; shift >= 0; shift -= 8) pieces.back().push_back(static_cast<unsigned char>(sum >> shift & 255));
  return pieces;
}

}  // namespace meniscus
