// Whatever the bytes: a frame whose arrays fit together, or an Error that names the file. MENISCUS_FUZZ_FORMAT in the
// environment is the format that is tried; "any" lets the bytes choose.
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>

#include "checks.h"
#include "io/file_bytes.h"
#include "io/formats.h"
#include "io/readers.h"

namespace {

using namespace meniscus;

/// The bytes as a file without a place on the disk.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(::memfd_create("frame", 0)) {
    require(descriptor_ >= 0 && ::write(descriptor_, data, size) == static_cast<ssize_t>(size), "a file in memory");
    path_ = "/proc/self/fd/" + std::to_string(descriptor_);
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  int descriptor_;
  std::string path_;
};

/// Options that the first bytes choose, for formats that depend on them.
ReadOptions options_of(std::string_view format, const std::uint8_t* data, std::size_t size) {
  ReadOptions options;
  constexpr std::array kForms{"", "f32x3", "f64x3", "f32bex4", "f64bex7", "f32x4096"};
  if (format == "raw" && size > 0) options.raw = kForms[data[0] % kForms.size()];
  return options;
}

/// Nothing is fetched before: what a reader looks at without having asked for it is an error.
Particles read_as(std::string_view name, const std::string& path, const MemoryFile& file, const ReadOptions& options) {
  io::FileBytes bytes(file.path());
  const io::Source source{path, bytes.span(), &bytes};
  for (const io::Format& format : io::formats())
    if (format.name == name) {
      if (format.fetching != io::Format::Fetching::reader) source.need_all();
      Particles particles = format.read(source, options);
      io::finish(options, particles);
      return particles;
    }
  throw std::logic_error("no such format");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const char* const chosen = std::getenv("MENISCUS_FUZZ_FORMAT");
  const std::string format = chosen != nullptr ? chosen : "any";
  try {
    const MemoryFile file(data, size);
    if (format == "any" || format == "hdf5") {
      check(read_particles(file.path()));
      io::look_at_frame(file.path(), {});
    } else {
      const std::string path = "frame." + format;
      check(read_as(format, path, file, options_of(format, data, size)));
    }
  } catch (const Error& error) {
    require(!error.detail().path.empty(), "an error that names the file");
  }
  return 0;
}
