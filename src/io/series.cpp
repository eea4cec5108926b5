#include "io/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>
#include <tuple>

namespace meniscus::io {
namespace {

struct File {
  std::string path;
  FrameName name;
};

bool same_number(const std::string& a, const std::string& b) {
  const auto number_a = number_of(a), number_b = number_of(b);
  return number_a && number_b ? *number_a == *number_b : a == b;
}

/// The digits of a name but for one run.
std::vector<std::string> other_digits(const FrameName& name, std::size_t run) {
  std::vector<std::string> digits = name.digits;
  digits.erase(digits.begin() + static_cast<std::ptrdiff_t>(run));
  return digits;
}

/// How files whose names differ in digits only are split into series.
struct Split {
  std::optional<std::size_t> run;  ///< which run of digits is the frame number
  bool by_others = false;          ///< the other runs tell series apart
};

Split split_of(const std::vector<File>& files) {
  const std::size_t runs = files[0].name.digits.size();
  std::vector<std::size_t> varying;
  for (std::size_t run = 0; run < runs; ++run) {
    const bool varies = std::any_of(files.begin(), files.end(), [&](const File& file) {
      return !same_number(file.name.digits[run], files[0].name.digits[run]);
    });
    if (varies) varying.push_back(run);
  }
  if (varying.empty()) return {files[0].name.likely_number(), false};
  if (varying.size() == 1) return {varying[0], false};

  // Several numbers differ, as in body_1_frame_12: the frame number is the one that gives the fewest series,
  // the last of equals. Where every file would be a series of its own (frame_12_4732_particles) it is one series.
  Split best;
  std::size_t fewest = files.size();
  for (const std::size_t run : varying) {
    std::set<std::vector<std::string>> others;
    for (const File& file : files) others.insert(other_digits(file.name, run));
    if (others.size() <= fewest && others.size() < files.size()) {
      fewest = others.size();
      best = {run, true};
    }
  }
  return best.run ? best : Split{varying[0], false};
}

Series series_from(const std::vector<const File*>& files, std::optional<std::size_t> run) {
  Series series;
  const FrameName& first = files[0]->name;
  series.name = first.with_braces(run);
  series.extension = first.extension;
  series.stem = series.name.substr(0, series.name.size() - series.extension.size());
  for (const File* file : files) {
    FramePath& frame = series.frames.emplace_back();
    frame.path = file->path;
    if (run) frame.number = number_of(file->name.digits[*run]);
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(file->path, error);
    if (!error) series.bytes += size;
  }
  std::stable_sort(series.frames.begin(), series.frames.end(), [](const FramePath& a, const FramePath& b) {
    if (a.number && b.number && *a.number != *b.number) return *a.number < *b.number;
    return natural_less(a.path, b.path);
  });
  return series;
}

}  // namespace

std::vector<Series> series_of(const std::vector<std::string>& paths) {
  // Names that are equal but for their digits.
  std::map<std::pair<std::vector<std::string>, std::string>, std::vector<File>> alike;
  for (const std::string& path : paths) {
    FrameName name(name_in(path));
    alike[{name.texts, name.extension}].push_back({path, name});
  }
  std::vector<Series> all;
  for (const auto& [key, files] : alike) {
    const Split split = split_of(files);
    std::map<std::vector<std::string>, std::vector<const File*>> parts;
    for (const File& file : files) {
      parts[split.by_others ? other_digits(file.name, *split.run) : std::vector<std::string>{}].push_back(&file);
    }
    for (const auto& [others, part] : parts) all.push_back(series_from(part, split.run));
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Series& a, const Series& b) { return natural_less(a.name, b.name); });
  return all;
}

std::optional<std::string> missing_note(const std::vector<FramePath>& frames) {
  std::set<std::int64_t> numbers;
  for (const FramePath& frame : frames) {
    if (frame.number) numbers.insert(*frame.number);
  }
  // The most common difference, the smallest of equals; it must be what half of the frames keep to.
  std::map<std::int64_t, std::size_t> differences;
  for (auto at = numbers.begin(); at != numbers.end() && std::next(at) != numbers.end(); ++at) {
    ++differences[*std::next(at) - *at];
  }
  if (differences.empty() || numbers.size() < 3) return std::nullopt;
  const auto [step, times] = *std::max_element(differences.begin(), differences.end(),
                                               [](const auto& a, const auto& b) { return a.second < b.second; });
  if (2 * times < numbers.size() - 1) return std::nullopt;

  constexpr std::size_t kMostListed = 5;
  std::int64_t missing = 0;
  std::string listed;
  std::size_t listed_count = 0;
  for (auto at = numbers.begin(); std::next(at) != numbers.end(); ++at) {
    const std::int64_t gap = *std::next(at) - *at;
    if (gap <= step || gap % step != 0) continue;
    missing += gap / step - 1;
    for (std::int64_t number = *at + step; number < *std::next(at) && listed_count < kMostListed; number += step) {
      listed += fmt::format("{}{}", listed_count++ > 0 ? ", " : "", number);
    }
  }
  if (missing == 0) return std::nullopt;
  const std::string every = step == 1 ? "" : fmt::format(" (frames come every {})", step);
  if (missing == 1) return fmt::format("frame {} is missing{}", listed, every);
  return fmt::format("{} frames are missing{}: {}{}", missing, every, listed,
                     missing > static_cast<std::int64_t>(listed_count) ? ", ..." : "");
}

}  // namespace meniscus::io
