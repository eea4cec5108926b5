// Whatever the bytes: a frame whose arrays fit together, or an Error that names the file. The format that is tried is
// in the name of the program, fuzz_FORMAT; fuzz_any lets the bytes choose.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "io/formats.h"
#include "io/readers.h"

namespace {

using namespace meniscus;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

void check(const Particles& particles) {
  require(particles.y.size() == particles.size() && particles.z.size() == particles.size(), "as many y and z as x");
  for (std::size_t i = 0; i < particles.size(); ++i)
    require(std::isfinite(particles.x[i]) && std::isfinite(particles.y[i]) && std::isfinite(particles.z[i]),
            "finite positions");
  for (const Attribute& attribute : particles.attributes)
    require(attribute.components > 0 &&
                attribute.values.size() == particles.size() * static_cast<std::size_t>(attribute.components),
            "as many values as particles");
}

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

Particles read_as(std::string_view name, const std::string& path, std::span<const char> bytes) {
  const ReadOptions options;
  for (const io::Format& format : io::formats())
    if (format.name == name) {
      Particles particles = format.read(io::Source{path, bytes}, options);
      io::finish(options, particles);
      return particles;
    }
  throw std::logic_error("no such format");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string format = MENISCUS_FUZZ_FORMAT;
  try {
    if (format == "any" || format == "hdf5") {
      const MemoryFile file(data, size);
      check(read_particles(file.path()));
    } else {
      const std::string path = "frame." + format;
      check(read_as(format, path, {reinterpret_cast<const char*>(data), size}));
    }
  } catch (const Error& error) {
    require(!error.detail().path.empty(), "an error that names the file");
  }
  return 0;
}
