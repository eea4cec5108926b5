#include "io/series_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "io/frame_head.h"
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
  std::string group;   ///< files of different groups are different things
  std::string part;    ///< which of several files of one time; empty: the only one
  std::string label;   ///< what the list calls it: "Particles"
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
    const std::string group = set.value("group");
    Entry entry{set.value("file"), std::nullopt, group, group + "/" + set.value("part"), set.value("name"), set.at};
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

/// What several files of one time are told by: the first of each part.
struct Part {
  std::string name;
  std::string group;
  std::string path;
  int kind = 1;  ///< as water_class() gives it
};

/// Whether parts of one time are parts of one thing: their names differ in digits only, or they stand in one group and
/// have the same number of values a particle.
bool belong_together(const Part& a, const Part& b, const ReadOptions& options) {
  const FrameName name_a(name_in(a.path)), name_b(name_in(b.path));
  if (name_a.extension != name_b.extension) return false;
  if (name_a.texts == name_b.texts) return true;
  if (a.group != b.group) return false;
  if (a.kind == 0 && b.kind == 0) return true;
  try {
    return std::abs(look_at_frame(a.path, options).values - look_at_frame(b.path, options).values) < 0.5;
  } catch (const Error&) {
    return false;  // what cannot be looked at tells nothing
  }
}

/// Whether several files have one time.
bool have_common_times(const std::vector<Entry>& entries) {
  std::map<double, std::string> part_at;
  for (const Entry& entry : entries) {
    const auto [place, is_new] = part_at.try_emplace(entry.time.value_or(0), entry.part);
    if (!is_new && place->second != entry.part) return true;
  }
  return false;
}

/// 0 water, 2 something else, 1 nobody knows, by the name of a file and by what a list calls it.
int kind_of(const std::string& name, const std::string& label) {
  if (water_class(name) == 2 || water_class(label) == 2) return 2;
  const bool particles = lower(label).find("particle") != std::string::npos;
  return particles || water_class(name) == 0 || water_class(label) == 0 ? 0 : 1;
}

/// The parts of a list, in the order in which they appear.
std::vector<Part> parts_of(const Source& source, const std::vector<Entry>& entries, const ReadOptions& options) {
  std::vector<Part> parts;
  std::set<std::string> known;
  for (const Entry& entry : entries) {
    if (!known.insert(entry.part).second) continue;
    const std::string path = path_of_named(source, entry.name, entry.at, options);
    parts.push_back({entry.part, entry.group, path, kind_of(name_in(path), entry.label)});
  }
  return parts;
}

/// The names of the parts that are the water, of those that a list has; none: the parts follow each other in time, as
/// lists of restarted runs have them, and all are. A note tells of what was left out.
std::set<std::string> water_among(const Source& source, const std::vector<Entry>& entries, const ReadOptions& options,
                                  std::vector<std::string>& notes) {
  const std::vector<Part> parts = parts_of(source, entries, options);
  if (parts.size() <= 1 || !have_common_times(entries)) return {};
  // Of the parts whose names are the most promising one is certain; those that belong to it are the rest of it.
  const int best =
      std::min_element(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.kind < b.kind; })->kind;
  std::vector<std::string> paths;
  for (const Part& part : parts)
    if (part.kind == best) paths.push_back(part.path);
  const std::string water = likeliest_water(paths);
  const Part& certain = *std::find_if(parts.begin(), parts.end(), [&](const Part& part) { return part.path == water; });
  std::set<std::string> taken;
  std::string others;
  std::size_t left_out = 0;
  for (const Part& part : parts) {
    if (&part == &certain || (part.kind == best && belong_together(certain, part, options))) {
      taken.insert(part.name);
    } else if (left_out++ < kMostListed) {
      others += (others.empty() ? "" : ", ") + part.path;
    }
  }
  if (left_out > 0)
    notes.push_back(fmt::format("'{}' has {} parts a frame; took {} of {} for the water, left out {}{}", source.path,
                                parts.size(), taken.size() == 1 ? "the one" : fmt::format("the {}", taken.size()),
                                water, others, left_out > kMostListed ? " and more" : ""));
  return taken;
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

/// The entries of each frame: those of one time, but for parts that are not the water. A part that a time has twice
/// begins another frame.
std::vector<std::vector<const Entry*>> frames_of(const std::vector<Entry>& entries,
                                                 const std::set<std::string>& water) {
  std::vector<std::vector<const Entry*>> frames;
  struct Last {
    std::size_t frame = 0;
    std::set<std::string> parts;  // that it has
  };
  std::map<double, Last> last_at;  // of each time
  for (const Entry& entry : entries) {
    if (!water.empty() && !water.contains(entry.part)) continue;
    const auto last = water.size() > 1 && entry.time ? last_at.find(*entry.time) : last_at.end();
    if (last != last_at.end() && last->second.parts.insert(entry.part).second) {
      frames[last->second.frame].push_back(&entry);
      continue;
    }
    if (entry.time) last_at[*entry.time] = {frames.size(), {entry.part}};
    frames.push_back({&entry});
  }
  return frames;
}

FrameSequence frames_listed(const std::string& path, const ReadOptions& options) {
  const Bytes bytes = read_file(path, kMostBytes);
  const Source source{path, bytes.span()};
  if (bytes.size() == kMostBytes) source.malformed("is far larger than a list of frames", kMostBytes);
  FrameSequence sequence;
  const std::vector<Entry> entries = is_vtk_xml(source) ? entries_of_collection(source) : entries_of_json(source);
  const std::set<std::string> water = water_among(source, entries, options, sequence.notes);

  std::size_t missing = 0;
  std::string missing_names;
  for (const std::vector<const Entry*>& parts : frames_of(entries, water)) {
    FramePath frame;
    frame.time = parts.front()->time;
    bool whole = true;
    for (const Entry* entry : parts) {
      const std::string part = path_of_named(source, entry->name, entry->at, options);
      if (is_series_name(part))
        source.malformed("names another list of frames", entry->at, "frames", fmt::format("'{:.200}'", entry->name));
      std::error_code error;
      if (!std::filesystem::is_regular_file(part, error)) {
        whole = false;
        if (missing++ < kMostListed) missing_names += (missing_names.empty() ? "" : ", ") + entry->name;
      }
      (entry == parts.front() ? frame.path : frame.further.emplace_back()) = part;
    }
    if (whole) sequence.frames.push_back(std::move(frame));
  }
  if (missing > 0)
    sequence.notes.push_back(
        fmt::format("{} of the files that '{}' lists {} not there, which leaves out their frames: {}{}", missing, path,
                    missing == 1 ? "is" : "are", missing_names, missing > kMostListed ? ", ..." : ""));
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
