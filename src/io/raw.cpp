#include "io/raw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "io/file_bytes.h"
#include "io/positions.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr std::uint64_t kMostValues = 4096;  ///< a particle
constexpr std::size_t kSampled = 4096;       ///< particles that are looked at to see whether the form is right
constexpr std::size_t kRun = 64;             ///< of these that stand one after the other

/// Of all coordinates of some particles, how many are plausible: finite, no more than a million kilometres, and not
/// below what simulations know. Bytes in the wrong order or of another type seldom are.
double plausible_share(const RawForm& form, const Source& source) {
  const std::size_t rows = source.bytes.size() / form.row_bytes();
  const std::size_t step = kRun * std::max<std::size_t>(rows / kSampled, 1);
  PieceBuffer buffer;
  std::size_t looked_at = 0, plausible = 0;
  for (std::size_t run = 0; run < rows; run += step) {
    const std::size_t run_rows = std::min(kRun, rows - run);
    const char* bytes = buffer.bytes(source.stored(run * form.row_bytes()), run_rows * form.row_bytes());
    for (std::size_t row = 0; row < run_rows; ++row)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double value =
            std::abs(read_value(form.type, form.order, bytes + row * form.row_bytes() + axis * size_of(form.type)));
        ++looked_at;
        if (value == 0 || (value > 1e-30 && value < 1e9)) ++plausible;
      }
  }
  return looked_at == 0 ? 1 : static_cast<double>(plausible) / static_cast<double>(looked_at);
}

/// A form in which the bytes are more plausible, for advice; empty: none. The other byte order comes first.
std::string better_form(const RawForm& form, const Source& source) {
  const bool wide = form.type == Scalar::float64;
  const std::string_view own = wide ? "f64" : "f32", other = wide ? "f32" : "f64";
  const std::string_view swapped = form.order == std::endian::big ? "" : "be";
  for (const auto& [type, order] : {std::pair{own, swapped}, {other, std::string_view()}, {other, "be"}}) {
    const std::string text = fmt::format("{}{}x{}", type, order, form.values);
    const RawForm tried = parse_raw_form(text);
    if (source.bytes.size() % tried.row_bytes() == 0 && plausible_share(tried, source) > 0.9) return text;
  }
  return {};
}

void check(const Source& source, const RawForm& form) {
  const std::size_t rest = source.bytes.size() % form.row_bytes();
  if (rest != 0)
    throw Error(
        ErrorCode::malformed_file,
        {"the size is no multiple of a particle's",
         fmt::format("{} bytes a particle ({} numbers of {})", form.row_bytes(), form.values, size_of(form.type)),
         fmt::format("{} particles and {} bytes", source.bytes.size() / form.row_bytes(), rest), source.path,
         source.bytes.size() - rest, std::nullopt,
         "say what a particle has: --raw f32x3, f64x3, f32x4 ...; if that is right, write the frame again"});
  if (plausible_share(form, source) >= 0.5) return;
  const std::string better = better_form(form, source);
  throw Error(ErrorCode::malformed_file,
              {"most of the numbers cannot be positions", "lengths", "numbers that are not finite, huge or tiny",
               source.path, 0, std::nullopt,
               better.empty() ? "check type and number of values: --raw f32x3, f64x3, f32bex3 ..."
                              : fmt::format("perhaps it is --raw {}", better)});
}

std::size_t chosen_column(const std::string& text, const RawForm& form, const std::string& path) {
  std::uint64_t number = 0;
  if (parse_count(text, number) && number >= 1 && number <= form.values) return number - 1;
  throw Error(ErrorCode::invalid_argument, {fmt::format("there is no column '{}'", text),
                                            fmt::format("numbers from 1 to {}", form.values),
                                            {},
                                            path,
                                            {},
                                            {},
                                            {}});
}

/// Characters that no text has.
bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 0x20 && !is_blank(c);
}

}  // namespace

RawForm parse_raw_form(std::string_view text) {
  const auto refuse = [&] {
    throw Error(ErrorCode::invalid_argument,
                {fmt::format("'{}' is no form of raw numbers", text),
                 "f32x3, f64x3, f32x4, f32bex3 (big-endian) ...",
                 {},
                 {},
                 {},
                 {},
                 "type (f32, f64), byte order (be, if not little-endian), x, values a particle"});
  };
  RawForm form;
  const std::string plain = lower(text);
  std::string_view rest = plain;
  if (!rest.starts_with("f32") && !rest.starts_with("f64")) refuse();
  if (rest.starts_with("f64")) form.type = Scalar::float64;
  rest.remove_prefix(3);
  if (rest.starts_with("be")) form.order = std::endian::big;
  if (rest.starts_with("be") || rest.starts_with("le")) rest.remove_prefix(2);
  std::uint64_t values = 0;
  if (!rest.starts_with('x') || !parse_count(rest.substr(1), values) || values < 3 || values > kMostValues) refuse();
  form.values = values;
  return form;
}

bool is_raw_xyz(const Source& start) {
  const std::string name = lower(start.path);
  if (!name.ends_with(".xyz") && !name.ends_with(".xyz.gz")) return false;
  const RawForm form;
  if (start.bytes.size() < form.row_bytes()) return false;
  // Tables with a few bytes for text are text, and so are letters beyond ASCII.
  if (start.starts_with("\xef\xbb\xbf") || std::none_of(start.bytes.begin(), start.bytes.end(), is_control))
    return false;
  const auto binary = std::count_if(start.bytes.begin(), start.bytes.end(),
                                    [](char c) { return is_control(c) || static_cast<unsigned char>(c) >= 0x7f; });
  return static_cast<double>(binary) > 0.1 * static_cast<double>(start.bytes.size()) &&
         plausible_share(form, start) > 0.8;
}

Particles read_raw(const Source& source, const ReadOptions& options) {
  const RawForm form = options.raw.empty() ? RawForm{} : parse_raw_form(options.raw);
  check(source, form);
  std::array<std::size_t, 3> position{0, 1, 2};
  if (!options.columns.empty()) {
    if (options.columns.size() != 3)
      throw Error(ErrorCode::invalid_argument, {"the columns of the position are not three",
                                                "--columns 1,2,3",
                                                fmt::format("{} columns", options.columns.size()),
                                                source.path,
                                                {},
                                                {},
                                                {}});
    for (std::size_t axis = 0; axis < 3; ++axis)
      position[axis] = chosen_column(options.columns[axis], form, source.path);
  }
  Particles particles;
  particles.format = "raw";
  if (form.values > 3)
    particles.notes.push_back(
        fmt::format("{} numbers a particle beside x y z were left out: nothing names them", form.values - 3));
  std::array<Column, 3> columns;
  for (std::size_t axis = 0; axis < 3; ++axis)
    columns[axis] = {source.stored(position[axis] * size_of(form.type)), form.row_bytes()};
  set_positions(form.type, form.order, columns, source.bytes.size() / form.row_bytes(), options, particles);
  return particles;
}

void look_at_raw(const Source& /*start*/, FrameHead& head) {
  head.format = "raw";
  head.particles = head.plain_bytes / RawForm{}.row_bytes();
  head.counted = true;
}

}  // namespace meniscus::io
