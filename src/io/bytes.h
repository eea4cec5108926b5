/// A file's bytes in memory, and errors that name the file.
#pragma once

#include <memory>
#include <span>

#include "meniscus/base.h"

namespace meniscus::io {

/// An owned buffer that is not zeroed when it grows.
class Bytes {
 public:
  Bytes() = default;
  explicit Bytes(std::size_t size) : data_(std::make_unique_for_overwrite<char[]>(size)), size_(size) {}
  char* data() { return data_.get(); }
  const char* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  std::span<const char> span() const { return {data_.get(), size_}; }
  /// A new size; the bytes that both sizes have are kept.
  void resize(std::size_t size);

 private:
  std::unique_ptr<char[]> data_;
  std::size_t size_ = 0;
};

class FileBytes;

/// Where bytes stand: in memory, or in a file of which they are read when they are used (PieceBuffer).
struct Stored {
  const char* at = nullptr;         ///< in memory, or the place in FileBytes::span() that they would have
  const FileBytes* file = nullptr;  ///< null: in memory

  Stored() = default;
  Stored(const char* memory, const FileBytes* of = nullptr) : at(memory), file(of) {}  // NOLINT: implicit by intention
  Stored operator+(std::size_t offset) const { return {at + offset, file}; }
};

/// What a reader reads: the bytes (decompressed) and the path for error messages.
struct Source {
  const std::string& path;
  std::span<const char> bytes;  ///< all of them; where there is a file, those that need() was called for
  FileBytes* file = nullptr;    ///< that the bytes are fetched from; null: all are in memory

  /// Fetches `size` bytes from `offset` on, or up to the end. Not by several threads at once.
  /// @throws Error  as FileBytes::fetch()
  void need(std::uint64_t offset, std::uint64_t size) const;
  void need_all() const { need(0, bytes.size()); }
  /// The place of a byte, fetched or not.
  Stored stored(std::size_t offset) const { return {bytes.data() + offset, file}; }
  /// The source from a byte on.
  Source part(std::size_t offset, std::size_t size) const { return {path, bytes.subspan(offset, size), file}; }

  /// Throws malformed_file about this file.
  [[noreturn]] void malformed(std::string problem, std::uint64_t byte_offset, std::string expected = {},
                              std::string found = {}) const;
  /// Throws unsupported about this file.
  [[noreturn]] void unsupported(std::string problem, std::string advice = {}) const;
  /// Throws malformed_file unless `count` items of at least `item_size` bytes can stand from `offset` to the end.
  /// @param what  "positions": what the items are, for the message
  void require(std::uint64_t offset, std::uint64_t count, std::uint64_t item_size, std::string_view what) const;
  /// Throws malformed_file unless what is read ends at `offset`, which is not behind the end, with the file.
  /// @param what  "values": what ends there, for the message
  void require_end(std::uint64_t offset, std::string_view what) const;
  bool starts_with(std::string_view magic) const;
};

/// A regular file, all of it or its first `most` bytes.
/// @throws Error not_found, io_failed (a directory, a device, no permission)
Bytes read_file(const std::string& path, std::size_t most = ~std::size_t{0});

/// Most bytes that are believed to hide in `compressed_size` bytes: 64 MiB, or 200 times the compressed size
/// where that is more. Particles compress two to ten times; only lattices at rest reach a hundred.
std::uint64_t believable_size(std::uint64_t compressed_size);

}  // namespace meniscus::io
