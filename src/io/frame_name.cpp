#include "io/frame_name.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "io/text.h"

namespace meniscus::io {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

/// The run of digits that starts `text`.
std::string_view digits_of(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  return text.substr(0, end);
}

std::string_view without_zeros(std::string_view digits) {
  while (digits.size() > 1 && digits.front() == '0') digits.remove_prefix(1);
  return digits;
}

// Dense binary formats of particles first, then those that also hold meshes, then text.
constexpr std::array<std::pair<std::string_view, int>, 17> kExtensions{{{".bgeo", 0},
                                                                        {".vtk", 1},
                                                                        {".vtu", 1},
                                                                        {".vtp", 1},
                                                                        {".pvtu", 1},
                                                                        {".pvtp", 1},
                                                                        {".hdf5", 2},
                                                                        {".h5", 2},
                                                                        {".ply", 3},
                                                                        {".pdb", 3},
                                                                        {".bin", 3},
                                                                        {".geo", 4},
                                                                        {".npz", 4},
                                                                        {".xyz", 4},
                                                                        {".csv", 5},
                                                                        {".txt", 6},
                                                                        {".dat", 6}}};

std::string_view without_gz(std::string_view extension) {
  if (extension.ends_with(".gz")) extension.remove_suffix(3);
  return extension;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a, whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view run_a = digits_of(a), run_b = digits_of(b);
      const std::string_view value_a = without_zeros(run_a), value_b = without_zeros(run_b);
      if (value_a.size() != value_b.size()) return value_a.size() < value_b.size();
      if (value_a != value_b) return value_a < value_b;
      a.remove_prefix(run_a.size());
      b.remove_prefix(run_b.size());
    } else {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() != b.empty()) return a.empty();
  return whole_a < whole_b;  // 01 and 1: equal as numbers, but the order must be total
}

FrameName::FrameName(std::string_view name) {
  // The extension: from the last dot, with what stands before a .gz. A name that begins with its only dot has none.
  const std::string plain = lower(name);
  std::size_t end = plain.size();
  if (plain.ends_with(".gz")) end -= 3;
  const std::size_t dot = end > 0 ? plain.rfind('.', end - 1) : std::string::npos;
  if (dot != std::string::npos && dot > 0 &&
      std::any_of(plain.begin() + static_cast<std::ptrdiff_t>(dot), plain.end(), is_letter)) {
    extension = plain.substr(dot);
    name = name.substr(0, dot);
  }
  texts.emplace_back();
  while (!name.empty()) {
    if (const std::string_view run = digits_of(name); !run.empty()) {
      digits.emplace_back(run);
      texts.emplace_back();
      name.remove_prefix(run.size());
    } else {
      texts.back() += name.front();
      name.remove_prefix(1);
    }
  }
}

std::optional<std::size_t> FrameName::likely_number() const {
  for (std::size_t i = digits.size(); i-- > 0;) {
    const std::string& after = texts[i + 1];
    const bool in_word = !after.empty() && is_letter(after.front());
    const bool in_decimal = (i > 0 && texts[i] == ".") || (i + 1 < digits.size() && after == ".");
    // "sim.0012" has a point before its number, but no digit before that.
    if (!in_word && !in_decimal) return i;
  }
  return std::nullopt;
}

std::string FrameName::with_braces(std::optional<std::size_t> run) const {
  std::string name = texts[0];
  for (std::size_t i = 0; i < digits.size(); ++i) name += (run == i ? "{}" : digits[i]) + texts[i + 1];
  return name + extension;
}

std::optional<std::int64_t> number_of(const std::string& digits) {
  std::int64_t number = 0;
  const std::string_view value = without_zeros(digits);
  if (value.empty() || value.size() > 18) return std::nullopt;
  std::from_chars(value.data(), value.data() + value.size(), number);
  return number;
}

std::optional<int> rank_of_extension(std::string_view extension) {
  extension = without_gz(extension);
  for (const auto& [known, rank] : kExtensions) {
    if (extension == known) return rank;
  }
  return std::nullopt;
}

bool is_any_text(std::string_view extension) {
  extension = without_gz(extension);
  return extension == ".txt" || extension == ".csv" || extension == ".dat";
}

bool is_any_binary(std::string_view extension) {
  extension = without_gz(extension);
  return extension == ".bin" || extension == ".pdb";
}

std::string directory_of(const std::string& path) { return path.substr(0, path.find_last_of('/') + 1); }
std::string name_in(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

}  // namespace meniscus::io
