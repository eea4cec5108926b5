#include "parse.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "commands.h"

namespace meniscus::apps {
namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view expected) {
  throw UsageError(fmt::format("{}: {} was expected, not '{}'", option, expected, text));
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t at = text.find(separator);
    parts.push_back(text.substr(0, at));
    if (at == std::string_view::npos) return parts;
    text.remove_prefix(at + 1);
  }
}

template <class Real>
bool read(std::string_view text, Real& value) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  const auto result = fast_float::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() && std::isfinite(value);
}

template <class Integer>
bool read_integer(std::string_view text, Integer& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

template <class Vector>
Vector parse_three(std::string_view option, std::string_view text) {
  const auto parts = split(text, ',');
  Vector v{0};
  if (parts.size() != 3 || !read(parts[0], v.x) || !read(parts[1], v.y) || !read(parts[2], v.z))
    refuse(option, text, "three numbers with commas between");
  return v;
}

}  // namespace

PictureSize parse_size(std::string_view option, std::string_view text) {
  const auto parts = split(text, 'x');
  PictureSize size;
  const auto fits = [](int n) { return n >= 1 && n <= 16384; };
  if (parts.size() != 2 || !read_integer(parts[0], size.width) || !read_integer(parts[1], size.height) ||
      !fits(size.width) || !fits(size.height))
    refuse(option, text, "WIDTHxHEIGHT, each 1 to 16384 pixels,");
  return size;
}

std::uint64_t parse_bytes(std::string_view option, std::string_view text) {
  constexpr std::array<std::pair<std::string_view, double>, 11> kUnits{{{"", 1},
                                                                        {"B", 1},
                                                                        {"kB", 1e3},
                                                                        {"KB", 1e3},
                                                                        {"MB", 1e6},
                                                                        {"GB", 1e9},
                                                                        {"TB", 1e12},
                                                                        {"KiB", 0x1p10},
                                                                        {"MiB", 0x1p20},
                                                                        {"GiB", 0x1p30},
                                                                        {"TiB", 0x1p40}}};
  const char* expected = "a size such as 4GB, 512MiB or 0 (units B, kB, MB, GB, TB, KiB, MiB, GiB, TiB)";
  const std::size_t end = std::min(text.find_first_not_of("0123456789."), text.size());
  const std::string_view digits = text.substr(0, end);
  double number = 0;
  const auto result =
      fast_float::from_chars(digits.data(), digits.data() + digits.size(), number, fast_float::chars_format::fixed);
  if (digits.empty() || result.ec != std::errc() || result.ptr != digits.data() + digits.size())
    refuse(option, text, expected);
  for (const auto& [unit, factor] : kUnits) {
    if (text.substr(end) != unit) continue;
    if (!(number * factor <= 0x1p60)) refuse(option, text, "a size of at most 1 EiB");
    if (number > 0 && number * factor < 1) refuse(option, text, expected);
    return static_cast<std::uint64_t>(number * factor);
  }
  refuse(option, text, expected);
}

PointLight parse_lamp(std::string_view option, std::string_view text) {
  const auto parts = split(text, ':');
  if (parts.size() != 2) refuse(option, text, "a place and an intensity, X,Y,Z:INTENSITY or X,Y,Z:R,G,B,");
  PointLight lamp;
  lamp.position = parse_vec3(option, parts[0]);
  float grey = 0;
  lamp.intensity = read(parts[1], grey) ? glm::vec3{grey} : parse_vec3(option, parts[1]);
  if (!(lamp.intensity.x >= 0 && lamp.intensity.y >= 0 && lamp.intensity.z >= 0))
    refuse(option, text, "an intensity from 0 up");
  return lamp;
}

glm::vec3 parse_vec3(std::string_view option, std::string_view text) { return parse_three<glm::vec3>(option, text); }

glm::dvec3 parse_dvec3(std::string_view option, std::string_view text) { return parse_three<glm::dvec3>(option, text); }

glm::vec2 parse_vec2(std::string_view option, std::string_view text) {
  const auto parts = split(text, ',');
  glm::vec2 v{0};
  if (parts.size() != 2 || !read(parts[0], v.x) || !read(parts[1], v.y))
    refuse(option, text, "two numbers with a comma between");
  return v;
}

std::pair<float, float> parse_range(std::string_view option, std::string_view text) {
  const auto parts = split(text, ':');
  std::pair<float, float> range{};
  if (parts.size() != 2 || !read(parts[0], range.first) || !read(parts[1], range.second) ||
      !(range.first < range.second))
    refuse(option, text, "LOW:HIGH, LOW less than HIGH,");
  return range;
}

FrameSelection parse_selection(std::string_view option, std::string_view text) {
  const char* expected = "N or FROM:TO:STEP, STEP at least 1,";
  const auto parts = split(text, ':');
  FrameSelection selection;
  long long number = 0;
  if (parts.size() == 1) {
    if (!read_integer(parts[0], number) || number < 1) refuse(option, text, expected);
    selection.first_n = number;
    return selection;
  }
  if (parts.size() > 3) refuse(option, text, expected);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].empty()) continue;
    if (!read_integer(parts[i], number)) refuse(option, text, expected);
    if (i == 0) selection.begin = number;
    if (i == 1) selection.end = number;
    if (i == 2) selection.step = number;
  }
  if (selection.step < 1) refuse(option, text, expected);
  return selection;
}

std::pair<std::size_t, std::size_t> bounds_of(const FrameSelection& selection, std::size_t count) {
  const auto n = static_cast<long long>(count);
  const auto place = [&](long long at) { return std::clamp(at < 0 ? at + n : at, 0LL, n); };
  const long long begin = selection.first_n ? 0 : place(selection.begin.value_or(0));
  const long long end = selection.first_n ? std::min(*selection.first_n, n) : place(selection.end.value_or(n));
  return {static_cast<std::size_t>(begin), static_cast<std::size_t>(std::max(begin, end))};
}

}  // namespace meniscus::apps
