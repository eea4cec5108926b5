/// A file that is read as far as it is needed: headers into memory, rows of numbers a piece at a time.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "io/crc32.h"

#if defined(__SANITIZE_ADDRESS__)
#define MENISCUS_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define MENISCUS_ADDRESS_SANITIZER 1
#endif
#endif

namespace meniscus::io {

// Where the address sanitizer watches, they are so small that tests and fuzzers see, in small files, what is looked at
// and was not fetched, and rows on both sides of a piece's end.
#ifdef MENISCUS_ADDRESS_SANITIZER
constexpr std::size_t kBlockBytes = 64;
constexpr std::size_t kPieceBytes = 1024;
#else
constexpr std::size_t kBlockBytes = std::size_t{1} << 16;  ///< of a file, that are fetched together
constexpr std::size_t kPieceBytes = std::size_t{1} << 18;  ///< that one thread converts: they stay in its cache
#endif

/// An open regular file. It is read, not mapped: a mapped file that shrinks kills the process.
class OpenFile {
 public:
  /// @throws Error  not_found, io_failed (a directory, a device, no permission)
  explicit OpenFile(const std::string& path);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  const std::string& path() const { return path_; }
  std::size_t size() const { return size_; }  ///< bytes when it was opened
  /// Reads from a byte on; how many bytes there were: fewer only where the file has become shorter.
  /// @throws Error  io_failed
  std::size_t read(std::size_t offset, std::span<char> target) const;

 private:
  std::string path_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

/// Addresses for as many bytes as a file has. Where there is not that much memory they are addresses alone: what is
/// written to takes memory then.
class FileRoom {
 public:
  /// @throws std::bad_alloc
  explicit FileRoom(std::size_t size);
  ~FileRoom();
  FileRoom(const FileRoom&) = delete;
  FileRoom& operator=(const FileRoom&) = delete;
  char* data() const { return data_; }
  std::size_t size() const { return size_; }
  bool is_memory() const { return memory_ != nullptr; }

 private:
  std::unique_ptr<char[]> memory_;
  char* data_ = nullptr;
  std::size_t size_;
};

/// Room for all bytes of a file, of which those that are fetched are read. What is not touched takes no memory.
/// Where the address sanitizer watches, looking at what has not been fetched is an error.
class FileBytes {
 public:
  /// @throws Error  as OpenFile
  explicit FileBytes(const std::string& path);
  ~FileBytes();
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  std::span<const char> span() const { return {bytes_.data(), bytes_.size()}; }
  Source source() { return {file_.path(), span(), this}; }
  /// Reads a part of span() on all threads, with what stands around it, unless it is there. Not by several threads at
  /// once, nor while others look at what has().
  /// @throws Error  io_failed; malformed_file: the file has become shorter since it was opened
  /// @throws std::bad_alloc  far too much for a file that does not fit into memory
  void fetch(const char* first, std::size_t size);
  /// Whether all of a part of span() has been fetched.
  bool has(const char* first, std::size_t size) const;
  /// Reads the bytes of a part of span() into other memory.
  /// @throws Error  as fetch()
  void copy(const char* first, std::span<char> target) const;

  /// From now on the sums of pieces that are read are kept for crc32_of().
  void keep_sums();
  /// CRC-32 of a part of span(): of its pieces as they were read, the others are read for it.
  /// @throws Error  as fetch()
  std::uint32_t crc32_of(const char* first, std::size_t size) const;

 private:
  OpenFile file_;
  FileRoom bytes_;
  std::vector<bool> fetched_;        ///< one a block
  std::unique_ptr<PieceSums> sums_;  ///< null: not kept
};

/// Memory for one piece of a file at a time, small enough to stay in a core's cache.
class PieceBuffer {
 public:
  /// `size` bytes: where they are, or read into this buffer, in place of what it held before.
  /// @throws Error  as FileBytes::fetch()
  const char* bytes(Stored first, std::size_t size);

 private:
  Bytes memory_;
};

/// Buffers for as many threads as are at work.
class PieceBuffers {
 public:
  /// A buffer for as long as this lives.
  class Lease {
   public:
    explicit Lease(PieceBuffers& from);
    ~Lease();
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    PieceBuffer* operator->() { return buffer_.get(); }

   private:
    PieceBuffers& from_;
    std::unique_ptr<PieceBuffer> buffer_;
  };

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<PieceBuffer>> idle_;
};

/// How many rows of `stride` bytes are converted at once, so that their bytes stay in the cache.
std::size_t rows_of_piece(Stored first, std::size_t stride);

/// Rows in pieces, on all threads: visit(begin, end, bytes) is given the rows from begin to before end, of which
/// `bytes` is the first byte.
/// @param row_bytes  that are looked at of each row, from its first one on
void for_each_piece(Stored first, std::size_t stride, std::size_t row_bytes, std::size_t rows,
                    FunctionRef<void(std::size_t begin, std::size_t end, const char* bytes)> visit);

}  // namespace meniscus::io
