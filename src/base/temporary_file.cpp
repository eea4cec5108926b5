#include "base/temporary_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace meniscus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestKeptName = 200;  // bytes; file systems allow 255, the rest is for the suffix
constexpr int kMostAttempts = 100;

/// Where the target's symbolic links lead; the target itself if it is none, or leads nowhere.
fs::path followed(const fs::path& target) {
  std::error_code ignored;
  if (!fs::is_symlink(target, ignored)) return target;
  const fs::path behind = fs::canonical(target, ignored);
  return behind.empty() ? target : behind;
}

/// The files that are there now, where a signal handler can read them: no locks, no allocation. More than fit are
/// only not removed when the program is stopped.
struct Slot {
  std::atomic<bool> taken{false};
  std::atomic<bool> named{false};
  char path[4096];
};
std::array<Slot, 16> slots;

void remember(const std::string& path) {
  if (path.size() >= sizeof Slot::path) return;
  for (Slot& slot : slots) {
    if (slot.taken.exchange(true)) continue;
    std::memcpy(slot.path, path.c_str(), path.size() + 1);
    slot.named = true;
    return;
  }
}

void forget(const std::string& path) {
  for (Slot& slot : slots)
    if (slot.named && path == slot.path) {
      slot.named = false;
      slot.taken = false;
      return;
    }
}

extern "C" void remove_and_stop(int number) {
  for (Slot& slot : slots)
    if (slot.named) unlink(slot.path);
  std::signal(number, SIG_DFL);
  std::raise(number);
}

}  // namespace

void remove_temporary_files_when_stopped() {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, remove_and_stop);
}

Error write_failed(const std::string& target, int error_number) {
  ErrorDetail detail;
  detail.problem = "cannot write the file: " + std::generic_category().message(error_number);
  detail.path = target;
  if (error_number == ENOENT) detail.advice = "make its directory first";
  if (error_number == ENOSPC) detail.advice = "make room or write elsewhere";
  return Error(ErrorCode::io_failed, detail);
}

TemporaryFile::TemporaryFile(const std::string& target) : target_(target) {
  const fs::path final_path = followed(target);
  final_path_ = final_path.string();
  // Renaming would put a plain file in the place of a device such as /dev/null.
  std::error_code ignored;
  const fs::file_status status = fs::status(final_path, ignored);
  if (fs::is_directory(status)) throw write_failed(target, EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    ErrorDetail detail;
    detail.problem = "cannot write the file: its name belongs to a device or pipe";
    detail.path = target;
    detail.advice = "give another name";
    throw Error(ErrorCode::io_failed, detail);
  }
  if (!final_path.has_filename()) throw write_failed(target, target.empty() ? ENOENT : EISDIR);

  const std::string name = final_path.filename().string().substr(0, kLongestKeptName);
  const std::string start = (final_path.parent_path() / fmt::format(".{}.tmp-{}", name, getpid())).string();
  for (int attempt = 1;; ++attempt) {
    const std::string path = attempt == 1 ? start : fmt::format("{}-{}", start, attempt);
    const int descriptor = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      close(descriptor);
      path_ = path;
      remember(path_);
      return;
    }
    if (errno != EEXIST || attempt == kMostAttempts) throw write_failed(target, errno);
  }
}

TemporaryFile::~TemporaryFile() {
  if (path_.empty()) return;
  unlink(path_.c_str());
  forget(path_);
}

void TemporaryFile::commit() {
  if (std::rename(path_.c_str(), final_path_.c_str()) != 0) throw write_failed(target_, errno);
  forget(path_);
  path_.clear();
}

TemporaryStream::TemporaryStream(const std::string& target)
    : file_(target), stream_(std::fopen(file_.path().c_str(), "wbe")) {
  if (!stream_) throw write_failed(target, errno);
}

TemporaryStream::~TemporaryStream() {
  if (stream_) std::fclose(stream_);
}

void TemporaryStream::write(std::span<const char> bytes) {
  if (bytes.empty()) return;
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) throw write_failed(file_.target(), errno);
}

void TemporaryStream::seek(std::uint64_t position) {
  if (fseeko(stream_, static_cast<off_t>(position), SEEK_SET) != 0) throw write_failed(file_.target(), errno);
}

void TemporaryStream::commit() {
  std::FILE* stream = std::exchange(stream_, nullptr);
  if (std::fclose(stream) != 0) throw write_failed(file_.target(), errno);
  file_.commit();
}

}  // namespace meniscus
