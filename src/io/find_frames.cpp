#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>

#include "io/series.h"
#include "io/series_file.h"
#include "meniscus/io.h"

namespace meniscus {
namespace {

using namespace io;
namespace fs = std::filesystem;

[[noreturn]] void not_found(const std::string& path, std::string problem, std::string advice = {}) {
  throw Error(ErrorCode::not_found, {std::move(problem), {}, {}, path, {}, {}, std::move(advice)});
}

bool is_file(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_directory(const std::string& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

struct Listing {
  std::vector<std::string> files;        ///< paths
  std::vector<std::string> directories;  ///< paths
};

/// What a directory holds, without hidden names. `prefix` is put before each name.
Listing listing_of(const std::string& directory, const std::string& prefix) {
  std::error_code error;
  fs::directory_iterator at(directory.empty() ? "." : directory, error);
  Listing listing;
  for (; !error && at != fs::directory_iterator(); at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with('.')) continue;
    std::error_code status_error;
    if (at->is_directory(status_error)) {
      listing.directories.push_back(prefix + name);
    } else if (at->is_regular_file(status_error)) {
      listing.files.push_back(prefix + name);
    }
  }
  if (error) {
    throw Error(ErrorCode::io_failed, {"cannot list the directory", {}, error.message(), directory, {}, {}, {}});
  }
  std::sort(listing.files.begin(), listing.files.end());
  std::sort(listing.directories.begin(), listing.directories.end());
  return listing;
}

/// The frames as a list (.pvd, .series) beside them has them, with their times, if one names all of them; else as they
/// were found.
FrameSequence listed_there(const std::vector<std::string>& files, FrameSequence found, const ReadOptions& options) {
  const auto plain = [](const std::string& path) { return fs::path(path).lexically_normal().string(); };
  for (const std::string& file : files) {
    if (!is_series_name(file)) continue;
    try {
      FrameSequence listed = frames_of_series(file, options);
      std::set<std::string> named;
      for (const FramePath& frame : listed.frames) {
        named.insert(plain(frame.path));
        for (const std::string& part : frame.further) named.insert(plain(part));
      }
      // A list of more frames lists more than the water.
      if (listed.frames.size() > found.frames.size() ||
          !std::all_of(found.frames.begin(), found.frames.end(),
                       [&](const FramePath& frame) { return named.contains(plain(frame.path)); }))
        continue;
      // What was left out of a series of files may be a part of a frame.
      const bool joined = std::any_of(listed.frames.begin(), listed.frames.end(),
                                      [](const FramePath& frame) { return !frame.further.empty(); });
      if (joined) found.notes = {fmt::format("the parts of frames are those that '{}' lists", file)};
      listed.notes.insert(listed.notes.begin(), found.notes.begin(), found.notes.end());
      return listed;
    } catch (const Error&) {
      continue;  // nobody asked for the list
    }
  }
  return found;
}

FrameSequence frames_of_directory(const std::string& directory, const ReadOptions& options) {
  const std::string prefix = directory.ends_with('/') ? directory : directory + "/";
  const Listing listing = listing_of(directory, prefix);
  FrameSequence sequence = most_likely_water(listing.files);
  if (!sequence.frames.empty()) return listed_there(listing.files, std::move(sequence), options);

  // Simulators often write into directories below the one that was named.
  std::string advice = "frames are .bgeo, .vtk, .vtu, .vtp, .ply, .hdf5, .geo, .xyz, .txt or .csv files";
  for (const std::string& below : listing.directories) {
    std::vector<std::string> files;
    try {
      files = listing_of(below, below + "/").files;
    } catch (const Error&) {
      continue;  // not ours to read
    }
    if (!most_likely_water(files).frames.empty()) {
      advice = fmt::format("name the directory '{}' instead", below);
      break;
    }
  }
  not_found(directory, "holds no particle frames", advice);
}

/// Paths that match a wildcard, directories left out.
std::vector<std::string> matches_of(const std::string& wildcard) {
  glob_t found{};
  const int status = ::glob(wildcard.c_str(), GLOB_NOSORT, nullptr, &found);
  std::vector<std::string> paths;
  if (status == 0) paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  std::erase_if(paths, [](const std::string& path) { return !is_file(path); });
  std::sort(paths.begin(), paths.end());
  return paths;
}

FrameSequence frames_of_wildcard(const std::string& wildcard) {
  const std::vector<std::string> paths = matches_of(wildcard);
  if (paths.empty()) not_found(wildcard, "no file matches the pattern");
  // A wildcard over directories (run_*/fluid.vtk) is a sequence of its own; in one directory the water is chosen.
  const std::string directory = directory_of(paths[0]);
  const bool one_directory =
      std::all_of(paths.begin(), paths.end(), [&](const std::string& path) { return directory_of(path) == directory; });
  FrameSequence sequence;
  if (one_directory) {
    sequence = most_likely_water(paths);
  } else {
    for (const std::string& path : paths) sequence.frames.push_back({path, {}, {}, {}});
    std::sort(sequence.frames.begin(), sequence.frames.end(),
              [](const FramePath& a, const FramePath& b) { return natural_less(a.path, b.path); });
  }
  if (sequence.frames.empty()) not_found(wildcard, "no particle file matches the pattern");
  return sequence;
}

/// "{:04}" and "{:04d}" are how many digits a number is written with: read is any number, as by "{}".
std::string without_widths(const std::string& pattern) {
  std::string plain;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    plain += pattern[i];
    if (pattern[i] != '{' || i + 1 == pattern.size() || pattern[i + 1] != ':') continue;
    std::size_t end = pattern.find_first_not_of("0123456789", i + 2);
    if (end != std::string::npos && pattern[end] == 'd') ++end;
    if (end < pattern.size() && pattern[end] == '}') i = end - 1;
  }
  return plain;
}

/// Frames of "directory/fluid_{}.bgeo" or "frame_{}/fluid.vtk".
FrameSequence frames_of_pattern(const std::string& pattern) {
  const std::size_t braces = pattern.find("{}");
  if (pattern.find("{}", braces + 2) != std::string::npos) {
    throw Error(ErrorCode::invalid_argument,
                {"the pattern has {} twice", "one {} for the frame number", {}, pattern, {}, {}, {}});
  }
  const std::string directory = directory_of(pattern.substr(0, braces));
  const std::string before = pattern.substr(directory.size(), braces - directory.size());
  const std::size_t slash = std::min(pattern.find('/', braces), pattern.size());
  const std::string after = pattern.substr(braces + 2, slash - braces - 2);
  const std::string rest = pattern.substr(slash);
  if (!is_directory(directory.empty() ? "." : directory)) not_found(directory, "there is no such directory");

  const Listing listing = listing_of(directory, directory);
  FrameSequence sequence;
  for (const std::string& path : rest.empty() ? listing.files : listing.directories) {
    const std::string name = name_in(path);
    if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) continue;
    const std::string digits = name.substr(before.size(), name.size() - before.size() - after.size());
    if (!std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; })) continue;
    if (rest.empty() || is_file(path + rest)) sequence.frames.push_back({path + rest, number_of(digits), {}, {}});
  }
  if (sequence.frames.empty()) not_found(pattern, "no file matches the pattern", "{} stands for digits only");
  std::sort(sequence.frames.begin(), sequence.frames.end(),
            [](const FramePath& a, const FramePath& b) { return natural_less(a.path, b.path); });
  if (const auto missing = missing_note(sequence.frames)) sequence.notes.push_back(*missing);
  return sequence;
}

/// Files that were named one by one. Those of one series come in natural order, for a shell expands * to
/// frame_1 frame_10 frame_2; an order that falls throughout is meant so and kept.
FrameSequence frames_of_files(const std::vector<std::string>& paths) {
  const std::vector<Series> all = series_of(paths);
  const std::string directory = directory_of(paths[0]);
  const bool one_directory =
      std::all_of(paths.begin(), paths.end(), [&](const std::string& path) { return directory_of(path) == directory; });
  FrameSequence sequence;
  if (all.size() == 1 && one_directory) {
    sequence.frames = all[0].frames;
    if (const auto missing = missing_note(sequence.frames)) sequence.notes.push_back(*missing);
    const bool falling = paths.size() > 1 && std::is_sorted(paths.rbegin(), paths.rend(), natural_less);
    if (falling) std::reverse(sequence.frames.begin(), sequence.frames.end());
    return sequence;
  }
  std::map<std::string, std::optional<std::int64_t>> numbers;
  for (const Series& series : all) {
    for (const FramePath& frame : series.frames) numbers[frame.path] = frame.number;
  }
  for (const std::string& path : paths) sequence.frames.push_back({path, numbers[path], {}, {}});
  if (all.size() < paths.size()) {
    sequence.notes.push_back(fmt::format("the {} files named belong to {} series and are taken in the order given",
                                         paths.size(), all.size()));
  }
  return sequence;
}

void append(FrameSequence& sequence, FrameSequence more) {
  sequence.frames.insert(sequence.frames.end(), std::make_move_iterator(more.frames.begin()),
                         std::make_move_iterator(more.frames.end()));
  sequence.notes.insert(sequence.notes.end(), more.notes.begin(), more.notes.end());
}

}  // namespace

FrameSequence find_frames(std::span<const std::string> arguments, const ReadOptions& options) {
  if (arguments.empty()) throw Error(ErrorCode::not_found, "no frames are named");
  FrameSequence sequence;
  std::vector<std::string> files;  // named one after the other
  const auto flush = [&] {
    if (!files.empty()) append(sequence, frames_of_files(files));
    files.clear();
  };
  for (const std::string& argument : arguments) {
    // A name that exists is that file, whatever signs it has.
    if (is_file(argument)) {
      if (is_series_name(argument)) {
        flush();
        append(sequence, frames_of_series(argument, options));
        continue;
      }
      files.push_back(argument);
      continue;
    }
    flush();
    if (is_directory(argument)) {
      append(sequence, frames_of_directory(argument, options));
    } else if (const std::string pattern = without_widths(argument); pattern.find("{}") != std::string::npos) {
      append(sequence, frames_of_pattern(pattern));
    } else if (argument.find_first_of("*?[") != std::string::npos) {
      append(sequence, frames_of_wildcard(argument));
    } else {
      not_found(argument, "there is no such file or directory");
    }
  }
  flush();
  sequence.reading = options;
  return sequence;
}

}  // namespace meniscus
