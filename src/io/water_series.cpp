#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "io/bytes.h"
#include "io/readers.h"
#include "io/series.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

int class_of(const Series& series) { return water_class(series.stem); }

/// Whether a text file has a line of three numbers among its first.
bool has_numbers(const std::string& path) {
  const Bytes start = read_file(path, 1 << 12);
  const Source source{path, start.span()};
  if (source.starts_with("\x1f\x8b")) return true;
  TextCursor text(source);
  while (!text.at_end()) {
    std::string line(text.line());
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    const std::vector<std::string_view> words = words_of(line);
    float number = 0;
    if (words.size() >= 3 && std::all_of(words.begin(), words.begin() + 3,
                                         [&](std::string_view word) { return parse_number(word, number); })) {
      return true;
    }
  }
  return false;
}

/// Whether a file that is no text is of one of the formats with such names.
bool holds_particles(const std::string& path) {
  const Bytes start = read_file(path, 1 << 12);
  const Source source{path, start.span()};
  return source.starts_with("\x1f\x8b") || is_realflow(source) || is_pdb(source);
}

/// Series of kinds that are read.
std::vector<Series> readable(const std::vector<std::string>& paths) {
  std::vector<Series> all = series_of(paths);
  std::erase_if(all, [](const Series& series) {
    if (!rank_of_extension(series.extension)) return true;
    try {
      const std::string& first = series.frames[0].path;
      return (is_any_text(series.extension) && !has_numbers(first)) ||
             (is_any_binary(series.extension) && !holds_particles(first));
    } catch (const Error&) {
      return true;  // a file that cannot be opened tells nothing
    }
  });
  // What .pvtu and .pvtp files name as their pieces are no frames.
  for (const std::string_view kind : {"vtu", "vtp"}) {
    const auto is_kind = [&](std::string_view before) {
      return [=](const Series& series) { return series.extension == std::string(before) + std::string(kind); };
    };
    if (std::any_of(all.begin(), all.end(), is_kind(".p"))) std::erase_if(all, is_kind("."));
  }
  return all;
}

bool same_frames_better(const Series& a, const Series& b) {
  if (a.frames.size() != b.frames.size()) return a.frames.size() > b.frames.size();
  return rank_of_extension(a.extension) < rank_of_extension(b.extension);
}

bool likelier(const Series& a, const Series& b) {
  const int class_a = class_of(a), class_b = class_of(b);
  const auto key = [](const Series& series, int kind) {
    return std::tuple(kind == 2, series.frames.size() == 1, kind, ~series.bytes);
  };
  const auto key_a = key(a, class_a), key_b = key(b, class_b);
  return key_a != key_b ? key_a < key_b : natural_less(a.name, b.name);
}

std::string note_of(const Series& chosen, const std::vector<Series>& left_out) {
  constexpr std::size_t kMostListed = 6;
  std::string list;
  for (std::size_t i = 0; i < std::min(left_out.size(), kMostListed); ++i) {
    list += fmt::format("{}{} ({})", i > 0 ? ", " : "", left_out[i].name, left_out[i].frames.size());
  }
  if (left_out.size() > kMostListed) list += fmt::format(" and {} more", left_out.size() - kMostListed);
  return fmt::format("took {} ({}) for the water, left out {}", chosen.name, chosen.frames.size(), list);
}

}  // namespace

int water_class(std::string_view stem) {
  constexpr std::array<std::string_view, 17> kOthers{"foam",  "spray", "bubble",  "whitewater", "bound",  "wall",
                                                     "solid", "rigid", "rb_",     "obstacle",   "mesh",   "surface",
                                                     "tank",  "floor", "diffuse", "terrain",    "emitter"};
  constexpr std::array<std::string_view, 3> kWater{"fluid", "water", "liquid"};
  const std::string name = lower(stem);
  const auto speaks_of = [&](std::string_view word) { return name.find(word) != std::string::npos; };
  if (std::any_of(kOthers.begin(), kOthers.end(), speaks_of)) return 2;
  return std::any_of(kWater.begin(), kWater.end(), speaks_of) ? 0 : 1;
}

std::string likeliest_water(const std::vector<std::string>& paths) {
  std::vector<Series> each;
  for (const std::string& path : paths) each.push_back(series_of({path})[0]);
  const auto best = std::min_element(each.begin(), each.end(), likelier);
  return best != each.end() ? best->frames[0].path : std::string();
}

FrameSequence most_likely_water(const std::vector<std::string>& paths) {
  std::vector<Series> all = readable(paths);
  if (all.empty()) return {};

  // The same frames in several formats: one of them; then the likeliest of what differs.
  std::map<std::string, const Series*> by_stem;
  for (const Series& series : all) {
    const Series*& best = by_stem[series.stem];
    if (best == nullptr || same_frames_better(series, *best)) best = &series;
  }
  std::vector<const Series*> candidates;
  for (const auto& [stem, series] : by_stem) candidates.push_back(series);
  const Series chosen = **std::min_element(candidates.begin(), candidates.end(),
                                           [](const Series* a, const Series* b) { return likelier(*a, *b); });

  FrameSequence sequence;
  std::vector<Series> left_out;
  if (chosen.frames.size() > 1) {
    sequence.frames = chosen.frames;
    std::copy_if(all.begin(), all.end(), std::back_inserter(left_out),
                 [&](const Series& series) { return series.name != chosen.name; });
  } else {
    // No series at all: files without numbers, each a frame.
    for (const Series& series : all) {
      const bool alike = series.extension == chosen.extension && class_of(series) == class_of(chosen);
      if (alike) sequence.frames.push_back(series.frames[0]);
      if (!alike) left_out.push_back(series);
    }
  }
  if (!left_out.empty()) sequence.notes.push_back(note_of(chosen, left_out));
  if (const auto missing = missing_note(sequence.frames)) sequence.notes.push_back(*missing);
  return sequence;
}

}  // namespace meniscus::io
