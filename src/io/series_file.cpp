#include "io/series_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>

#include "io/named_files.h"
#include "io/readable.h"
#include "io/series.h"
#include "io/text.h"
#include "io/vtk_xml_file.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kMostBytes = std::size_t{16} << 20;
constexpr std::size_t kMostListed = 5;  ///< names in a note

/// One line of a list.
struct Entry {
  std::string name;
  std::optional<double> time;
  std::string part;    ///< which of several files of one time; empty: the only one
  std::size_t at = 0;  ///< byte offset, for messages
};

std::vector<Entry> entries_of_collection(const Source& source) {
  const VtkXmlFile file = open_vtk_xml(source);
  const XmlElement* list = file.kind == "Collection" ? file.root.child("Collection") : nullptr;
  if (list == nullptr)
    source.malformed("lists no frames", file.root.at, "type=\"Collection\" and <Collection>",
                     fmt::format("type '{:.40}'", file.kind));
  std::vector<Entry> entries;
  for (const XmlElement& set : list->children) {
    if (set.name != "DataSet") continue;
    Entry entry{set.value("file"), std::nullopt, set.value("group") + "/" + set.value("part"), set.at};
    double time = 0;
    if (const std::string* text = set.find("timestep")) {
      const std::vector<std::string_view> words = words_of(*text);
      if (words.size() != 1 || !parse_number(words[0], time) || !std::isfinite(time))
        source.malformed("a timestep is no number", set.at, {}, fmt::format("'{:.40}'", *text));
      entry.time = time;
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

/// {"file-series-version": "1.0", "files": [{"name": "a.vtk", "time": 0.5}, ...]}
std::vector<Entry> entries_of_json(const Source& source) {
  using Json = nlohmann::json;
  constexpr int kDeepest = 8;
  const auto check_depth = [&](int depth, Json::parse_event_t, const Json&) {
    if (depth > kDeepest) source.malformed("the JSON is nested too deep", 0, fmt::format("{} levels", kDeepest));
    return true;
  };
  Json json;
  try {
    const char* begin = source.bytes.data();
    json = Json::parse(begin, begin + source.bytes.size(), check_depth, true, true);
  } catch (const Json::parse_error& error) {
    source.malformed("the JSON is damaged", error.byte > 0 ? error.byte - 1 : 0, {}, error.what());
  } catch (const Json::exception& error) {
    source.malformed("the JSON holds what cannot be read", 0, {}, error.what());
  }
  const auto files = json.is_object() ? json.find("files") : json.end();
  if (!json.is_object() || files == json.end() || !files->is_array())
    source.malformed("lists no frames", 0, "{\"files\": [{\"name\": ..., \"time\": ...}, ...]}");
  std::vector<Entry> entries;
  for (const Json& file : *files) {
    const auto name = file.is_object() ? file.find("name") : file.end();
    if (!file.is_object() || name == file.end() || !name->is_string())
      source.malformed(fmt::format("frame {} has no name", entries.size()), 0, "{\"name\": ..., \"time\": ...}");
    Entry& entry = entries.emplace_back();
    entry.name = name->get<std::string>();
    if (const auto time = file.find("time"); time != file.end()) {
      if (!time->is_number()) source.malformed(fmt::format("the time of frame {} is no number", entries.size() - 1), 0);
      entry.time = time->get<double>();
    }
  }
  return entries;
}

/// The name of the part, of those that a list has, that is most likely the water; a note tells of the others.
std::string water_among(const Source& source, const std::vector<Entry>& entries, const ReadOptions& options,
                        std::vector<std::string>& notes) {
  std::map<std::string, std::string> first_paths;  // of each part
  for (const Entry& entry : entries)
    if (!first_paths.contains(entry.part))
      first_paths[entry.part] = path_of_named(source, entry.name, entry.at, options);
  if (first_paths.size() <= 1) return first_paths.empty() ? "" : first_paths.begin()->first;
  // Parts that follow each other in time, as lists of restarted runs have them, are no parts of one time.
  bool together = false;
  std::map<double, std::string> part_at;
  for (const Entry& entry : entries) {
    const auto [place, is_new] = part_at.try_emplace(entry.time.value_or(0), entry.part);
    together = together || (!is_new && place->second != entry.part);
  }
  if (!together) return {};

  std::vector<std::string> paths;
  for (const auto& [part, path] : first_paths) paths.push_back(path);
  const std::string water = likeliest_water(paths);
  std::string others;
  std::size_t listed = 0;
  std::string chosen = first_paths.begin()->first;
  for (const auto& [part, path] : first_paths) {
    if (path == water) chosen = part;
    if (path != water && listed++ < kMostListed) others += (others.empty() ? "" : ", ") + path;
  }
  notes.push_back(fmt::format("'{}' has {} parts a frame; took the one of {} for the water, left out {}{}", source.path,
                              first_paths.size(), water, others, listed > kMostListed ? " and more" : ""));
  return chosen;
}

/// Gives frames the numbers in their names.
void set_numbers(std::vector<FramePath>& frames) {
  std::vector<std::string> paths;
  for (const FramePath& frame : frames) paths.push_back(frame.path);
  std::map<std::string, std::optional<std::int64_t>> numbers;
  for (const Series& series : series_of(paths))
    for (const FramePath& frame : series.frames) numbers[frame.path] = frame.number;
  for (FramePath& frame : frames) frame.number = numbers[frame.path];
}

}  // namespace

bool is_series_name(std::string_view path) {
  const std::string name = lower(path);
  return name.ends_with(".pvd") || name.ends_with(".series");
}

bool is_json_series(const Source& start) {
  const std::string_view text(start.bytes.data(), std::min<std::size_t>(start.bytes.size(), 1 << 12));
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return first != std::string_view::npos && text[first] == '{' &&
         text.find("\"file-series-version\"") != std::string_view::npos;
}

namespace {

FrameSequence frames_listed(const std::string& path, const ReadOptions& options) {
  const Bytes bytes = read_file(path, kMostBytes);
  const Source source{path, bytes.span()};
  if (bytes.size() == kMostBytes) source.malformed("is far larger than a list of frames", kMostBytes);
  FrameSequence sequence;
  const std::vector<Entry> entries = is_vtk_xml(source) ? entries_of_collection(source) : entries_of_json(source);
  const std::string water = water_among(source, entries, options, sequence.notes);

  std::size_t missing = 0;
  std::string missing_names;
  for (const Entry& entry : entries) {
    if (!water.empty() && entry.part != water) continue;
    FramePath frame;
    frame.path = path_of_named(source, entry.name, entry.at, options);
    if (is_series_name(frame.path))
      source.malformed("names another list of frames", entry.at, "frames", fmt::format("'{:.200}'", entry.name));
    frame.time = entry.time;
    std::error_code error;
    if (std::filesystem::is_regular_file(frame.path, error)) {
      sequence.frames.push_back(std::move(frame));
    } else if (missing++ < kMostListed) {
      missing_names += (missing_names.empty() ? "" : ", ") + entry.name;
    }
  }
  if (missing > 0)
    sequence.notes.push_back(fmt::format("{} of the files that '{}' lists {} not there: {}{}", missing, path,
                                         missing == 1 ? "is" : "are", missing_names,
                                         missing > kMostListed ? ", ..." : ""));
  if (sequence.frames.empty())
    throw Error(
        ErrorCode::not_found,
        {entries.empty() ? "lists no frames" : "none of the frames that it lists is there", {}, {}, path, {}, {}, {}});
  set_numbers(sequence.frames);
  for (std::string& note : sequence.notes) make_readable(note);
  return sequence;
}

}  // namespace

FrameSequence frames_of_series(const std::string& path, const ReadOptions& options) {
  try {
    return frames_listed(path, options);
  } catch (const Error& error) {
    throw readable(error);
  }
}

Particles refuse_series(const Source& source, const ReadOptions& /*options*/) {
  source.unsupported("lists a series of frames and holds none", "name it where frames are named");
}

}  // namespace meniscus::io
