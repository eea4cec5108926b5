#pragma once

#include <cstdio>
#include <span>
#include <string>

#include "meniscus/base.h"

namespace meniscus {

/// A file that gets its name when it is whole.
///
/// It is made beside its target as ".NAME.tmp-PID" (with "-2", "-3" ... where that is taken), so that the
/// renaming stays within one file system, and is removed unless commit() was called. A target that is a
/// symbolic link is written through; one that is a directory or a device is refused.
class TemporaryFile {
 public:
  /// Makes the empty file.
  /// @throws Error io_failed naming the target and the system's reason
  explicit TemporaryFile(const std::string& target);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// Where to write.
  const std::string& path() const { return path_; }
  /// The name that the file will have, as the caller gave it.
  const std::string& target() const { return target_; }
  /// Gives the file its name. Whatever was written must have been closed before.
  /// @throws Error io_failed
  void commit();

 private:
  std::string target_;
  std::string final_path_;  ///< the target behind its symbolic links
  std::string path_;        ///< empty once there is nothing to remove
};

/// "cannot write the file" with the system's reason for the error number.
Error write_failed(const std::string& target, int error_number);

/// A TemporaryFile open for writing by C's stream functions.
class TemporaryStream {
 public:
  /// @throws Error io_failed, as all of its functions
  explicit TemporaryStream(const std::string& target);
  ~TemporaryStream();
  TemporaryStream(const TemporaryStream&) = delete;
  TemporaryStream& operator=(const TemporaryStream&) = delete;

  void write(std::span<const char> bytes);
  void seek(std::uint64_t position);
  /// Flushes, closes and gives the file its name.
  void commit();

 private:
  TemporaryFile file_;
  std::FILE* stream_;
};

}  // namespace meniscus
