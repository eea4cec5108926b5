#include "io/file_bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

#ifdef MENISCUS_ADDRESS_SANITIZER
#include <sanitizer/asan_interface.h>
#endif

namespace meniscus::io {
namespace {

constexpr std::size_t kReadAtOnce = std::size_t{1} << 22;    ///< bytes that one thread fetches
constexpr std::size_t kRowsInMemory = std::size_t{1} << 12;  ///< the same for what is in memory already

[[noreturn]] void system_failure(const std::string& path, std::string problem) {
  const int number = errno;
  const ErrorCode code = number == ENOENT || number == ENOTDIR ? ErrorCode::not_found : ErrorCode::io_failed;
  throw Error(code, {std::move(problem), {}, std::strerror(number), path, {}, {}, {}});
}

[[noreturn]] void became_shorter(const OpenFile& file, std::size_t end) {
  throw Error(ErrorCode::malformed_file, {"the file became shorter while it was read",
                                          fmt::format("{} bytes", file.size()),
                                          fmt::format("{} bytes", end),
                                          file.path(),
                                          end,
                                          {},
                                          "read it again when it is written"});
}

#ifdef MENISCUS_ADDRESS_SANITIZER
void forbid(const char* first, std::size_t size) { ASAN_POISON_MEMORY_REGION(first, size); }
void allow(const char* first, std::size_t size) { ASAN_UNPOISON_MEMORY_REGION(first, size); }
#else
void forbid(const char* /*first*/, std::size_t /*size*/) {}
void allow(const char* /*first*/, std::size_t /*size*/) {}
#endif

}  // namespace

OpenFile::OpenFile(const std::string& path) : path_(path) {
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) system_failure(path, "cannot open the file");
  struct stat status {};
  const bool known = ::fstat(descriptor_, &status) == 0;
  if (known && S_ISREG(status.st_mode)) {
    size_ = static_cast<std::size_t>(status.st_size);
    return;
  }
  const int number = errno;
  ::close(descriptor_);
  errno = number;
  if (!known) system_failure(path, "cannot look at the file");
  throw Error(
      ErrorCode::io_failed,
      {"is not a regular file", {}, S_ISDIR(status.st_mode) ? "a directory" : "a device or pipe", path, {}, {}, {}});
}

OpenFile::~OpenFile() { ::close(descriptor_); }

std::size_t OpenFile::read(std::size_t offset, std::span<char> target) const {
  std::size_t done = 0;
  while (done < target.size()) {
    const ssize_t count =
        ::pread(descriptor_, target.data() + done, target.size() - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) system_failure(path_, "cannot read the file");
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

Bytes read_file(const std::string& path, std::size_t most) {
  const OpenFile file(path);
  Bytes bytes(std::min(most, file.size()));
  // A file may shrink while it is read: what could be read is what it is.
  const std::size_t size = file.read(0, {bytes.data(), bytes.size()});
  if (size < bytes.size()) bytes.resize(size);
  return bytes;
}

FileRoom::FileRoom(std::size_t size) : memory_(new (std::nothrow) char[size]), data_(memory_.get()), size_(size) {
  if (data_ != nullptr) return;
  void* const addresses =
      ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (addresses == MAP_FAILED) throw std::bad_alloc();
  data_ = static_cast<char*>(addresses);
}

FileRoom::~FileRoom() {
  if (!memory_) ::munmap(data_, size_);
}

FileBytes::FileBytes(const std::string& path)
    : file_(path), bytes_(file_.size()), fetched_((file_.size() + kBlockBytes - 1) / kBlockBytes) {
  forbid(bytes_.data(), bytes_.size());
}

FileBytes::~FileBytes() { allow(bytes_.data(), bytes_.size()); }

void FileBytes::fetch(const char* first, std::size_t size) {
  if (size == 0 || has(first, size)) return;
  constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;
  if (!bytes_.is_memory() && size > kMostAtOnce) throw std::bad_alloc();
  const auto offset = static_cast<std::size_t>(first - bytes_.data());
  std::size_t begin = offset / kBlockBytes * kBlockBytes;
  while (fetched_[begin / kBlockBytes]) begin += kBlockBytes;
  const std::size_t end = std::min(bytes_.size(), (offset + size + kBlockBytes - 1) / kBlockBytes * kBlockBytes);
  allow(bytes_.data() + begin, end - begin);
  parallel_for(end - begin, kReadAtOnce, [&](std::size_t from, std::size_t to) {
    copy(bytes_.data() + begin + from, {bytes_.data() + begin + from, to - from});
  });
  std::fill(fetched_.begin() + static_cast<std::ptrdiff_t>(begin / kBlockBytes),
            fetched_.begin() + static_cast<std::ptrdiff_t>((end + kBlockBytes - 1) / kBlockBytes), true);
}

bool FileBytes::has(const char* first, std::size_t size) const {
  const auto offset = static_cast<std::size_t>(first - bytes_.data());
  for (std::size_t block = offset / kBlockBytes; block * kBlockBytes < offset + size; ++block)
    if (!fetched_[block]) return false;
  return true;
}

void FileBytes::copy(const char* first, std::span<char> target) const {
  const auto offset = static_cast<std::size_t>(first - bytes_.data());
  if (const std::size_t count = file_.read(offset, target); count < target.size())
    became_shorter(file_, offset + count);
  if (sums_) sums_->add(offset, target);
}

void FileBytes::keep_sums() {
  if (!sums_) sums_ = std::make_unique<PieceSums>();
}

std::uint32_t FileBytes::crc32_of(const char* first, std::size_t size) const {
  const auto begin = static_cast<std::size_t>(first - bytes_.data());
  std::uint32_t sum = 0;
  std::size_t at = begin;
  const auto add_gap = [&](std::size_t end) {
    if (end > at) sum = crc32_joined(sum, io::crc32_of({bytes_.data() + at, this}, end - at), end - at);
  };
  for (const PieceSums::Piece& piece : sums_ ? sums_->within(begin, begin + size) : std::vector<PieceSums::Piece>{}) {
    add_gap(piece.begin);
    sum = crc32_joined(sum, piece.sum, piece.end - piece.begin);
    at = piece.end;
  }
  add_gap(begin + size);
  return sum;
}

const char* PieceBuffer::bytes(Stored first, std::size_t size) {
  if (first.file == nullptr || size == 0 || first.file->has(first.at, size)) return first.at;
  if (memory_.size() < size) memory_ = Bytes(std::max(size, kPieceBytes));
  first.file->copy(first.at, {memory_.data(), size});
  return memory_.data();
}

PieceBuffers::Lease::Lease(PieceBuffers& from) : from_(from) {
  const std::lock_guard lock(from.mutex_);
  if (from.idle_.empty()) {
    buffer_ = std::make_unique<PieceBuffer>();
  } else {
    buffer_ = std::move(from.idle_.back());
    from.idle_.pop_back();
  }
}

PieceBuffers::Lease::~Lease() {
  const std::lock_guard lock(from_.mutex_);
  from_.idle_.push_back(std::move(buffer_));
}

std::size_t rows_of_piece(Stored first, std::size_t stride) {
  if (first.file == nullptr) return kRowsInMemory;
  return std::max<std::size_t>(1, kPieceBytes / std::max<std::size_t>(1, stride));
}

void for_each_piece(Stored first, std::size_t stride, std::size_t row_bytes, std::size_t rows,
                    FunctionRef<void(std::size_t begin, std::size_t end, const char* bytes)> visit) {
  PieceBuffers buffers;
  parallel_for(rows, rows_of_piece(first, stride), [&](std::size_t begin, std::size_t end) {
    PieceBuffers::Lease buffer(buffers);
    visit(begin, end, buffer->bytes(first + begin * stride, (end - begin - 1) * stride + row_bytes));
  });
}

}  // namespace meniscus::io
