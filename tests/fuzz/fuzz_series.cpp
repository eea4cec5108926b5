// Whatever the bytes of a list of frames: frames that are there and in its directory, or an Error that names the list.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "checks.h"
#include "meniscus/io.h"

namespace {

using namespace meniscus;
namespace fs = std::filesystem;

/// A directory in memory with a few frames, removed at the end.
class Directory {
 public:
  Directory() {
    const fs::path memory = "/dev/shm";
    path_ = (fs::is_directory(memory) ? memory : fs::temp_directory_path()) / ("fuzz_" + std::to_string(::getpid()));
    fs::create_directories(path_ / "below");
    for (const char* name : {"f_1.vtk", "f_2.vtk", "foam_1.vtk", "below/f_3.vtu"}) std::ofstream(path_ / name) << "x";
  }
  ~Directory() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Directory directory;
  const std::string list = (directory.path() / "list.pvd").string();
  std::ofstream(list, std::ios::binary | std::ios::trunc)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const std::vector<std::string> arguments{list};
    for (const FramePath& frame : find_frames(arguments).frames) {
      const std::string inside = directory.path().string() + "/";
      std::vector<std::string> files = frame.further;
      files.push_back(frame.path);
      for (const std::string& file : files) {
        require(fs::is_regular_file(file), "frames that are there");
        require(fs::path(file).lexically_normal().string().starts_with(inside), "frames in its directory");
      }
      require(!frame.time || std::isfinite(*frame.time), "finite times");
    }
  } catch (const Error& error) {
    require(error.detail().path == list, "an error that names the list");
  }
  return 0;
}
