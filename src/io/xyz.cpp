// Numbers in text, one particle a line.
#include <fmt/format.h>

#include <algorithm>

#include "io/frame_head.h"
#include "io/positions.h"
#include "io/readers.h"
#include "io/text_rows.h"

namespace meniscus::io {
namespace {

void check_count(const Source& source, const TextTable& table, std::uint64_t rows, Particles& particles) {
  if (!table.declared_rows || rows == *table.declared_rows) return;
  if (rows < *table.declared_rows)
    throw Error(ErrorCode::malformed_file,
                {"the file ends inside its rows", fmt::format("{} rows as its first line says", *table.declared_rows),
                 fmt::format("{}", rows), source.path, std::nullopt,
                 line_number(source, table.line_end, source.bytes.size()), "write the frame again"});
  particles.notes.push_back(
      fmt::format("has {} rows although its first line says {}; all are read", rows, *table.declared_rows));
}

void move_columns(const TextTable& table, std::uint64_t row_count, TextRows& rows, Particles& particles) {
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    if (rows.values[c].empty()) continue;  // a position, or there are no rows
    if (rows.missing[c] == row_count) {
      particles.notes.push_back(fmt::format("column '{}' holds no numbers and was left out", table.names[c]));
      continue;
    }
    if (rows.missing[c] > 0)
      particles.notes.push_back(
          fmt::format("column '{}' has no number in {} of {} rows", table.names[c], rows.missing[c], row_count));
    particles.attributes.push_back({table.names[c], 1, std::move(rows.values[c])});
  }
}

}  // namespace

Particles read_xyz(const Source& source, const ReadOptions& options) {
  Particles particles;
  particles.format = "xyz";
  const TextTable table = find_table(source, options);
  particles.notes = table.notes;
  particles.time = table.time;
  if (table.columns == 0) {
    check_count(source, table, 0, particles);
    return particles;
  }
  TextRows rows = read_rows(source, table);
  const std::uint64_t count = rows.positions.size() / 3;
  check_count(source, table, count, particles);
  move_columns(table, count, rows, particles);
  set_positions(rows.positions, options, particles);
  return particles;
}

/// Judges the number of rows from the length of those that are there.
void look_at_xyz(const Source& start, FrameHead& head) {
  head.format = "xyz";
  head.text = true;
  const bool all = start.bytes.size() == head.plain_bytes;
  Source whole = start;
  if (!all) {
    // The last line that is there may be a part of one.
    const std::string_view text(start.bytes.data(), start.bytes.size());
    const std::size_t last = text.find_last_of("\r\n");
    whole.bytes = start.bytes.first(last == std::string_view::npos ? 0 : last + 1);
  }
  TextTable table;
  try {
    table = find_table(whole, {});
  } catch (const Error&) {
    // What is beyond the start may make it a table: reading it will tell.
    if (all) throw;
  }
  if (table.columns == 0) {
    constexpr std::uint64_t kRowBytes = 24;  // about
    head.counted = all;                      // there are none
    head.particles = all ? 0 : head.plain_bytes / kRowBytes;
    return;
  }
  head.values = static_cast<double>(table.kept());
  const std::uint64_t count = std::max<std::uint64_t>(count_rows(whole, table, table.first_row, whole.bytes.size()), 1);
  const auto length = static_cast<double>(whole.bytes.size() - table.first_row);
  const double left = static_cast<double>(head.plain_bytes) - static_cast<double>(table.first_row);
  head.particles = static_cast<std::uint64_t>(std::max(left * static_cast<double>(count) / length + 0.5, 1.0));
  head.counted = all;
}

}  // namespace meniscus::io
