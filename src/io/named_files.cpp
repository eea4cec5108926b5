#include "io/named_files.h"

#include <fmt/format.h>

#include <filesystem>

#include "io/frame_name.h"

namespace meniscus::io {
namespace {

namespace fs = std::filesystem;

/// Whether a path, its dots resolved, lies in a directory. Links are not followed: who made them meant them.
bool is_inside(const fs::path& path, const fs::path& directory) {
  const fs::path from = fs::absolute(directory).lexically_normal(), to = fs::absolute(path).lexically_normal();
  const fs::path way = to.lexically_relative(from);
  return !way.empty() && *way.begin() != ".." && *way.begin() != ".";
}

}  // namespace

std::string path_of_named(const Source& source, const std::string& name, std::size_t at, const ReadOptions& options) {
  const std::size_t nul = name.find('\0');
  if (name.empty() || nul != std::string::npos) source.malformed("names a file without a name", at);
  const std::string directory = directory_of(source.path);
  const std::string path = name.front() == '/' ? name : directory + name;
  if (!options.allow_outside && !is_inside(path, directory.empty() ? "." : directory)) {
    throw Error(ErrorCode::invalid_argument, {"names a file outside of its own directory",
                                              {},
                                              "'" + name.substr(0, 200) + "'",
                                              source.path,
                                              at,
                                              {},
                                              "give --allow-outside if that is meant"});
  }
  return path;
}

}  // namespace meniscus::io
