#include "io/csv_write.h"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>

#include "base/temporary_file.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kRowsAPiece = std::size_t{1} << 13;
constexpr std::size_t kPiecesAtOnce = 32;  ///< formatted before they are written

using Text = fmt::memory_buffer;

template <class T>
void put(Text& text, T value) {
  fmt::format_to(std::back_inserter(text), FMT_COMPILE("{}"), value);
}

/// A name as a cell: quoted if it has what separates cells.
std::string cell_of(const std::string& name) {
  if (name.find_first_of(",;\"\t\n\r") == std::string::npos && !name.empty()) return name;
  std::string cell = "\"";
  for (const char c : name) cell += c == '"' ? "\"\"" : std::string(1, c == '\n' || c == '\r' ? ' ' : c);
  return cell + "\"";
}

std::string header_of(const Particles& particles) {
  std::string header = "x,y,z";
  for (const Attribute& attribute : particles.attributes) {
    for (int c = 0; c < attribute.components; ++c)
      header += "," + cell_of(attribute.components == 1 ? attribute.name : fmt::format("{}:{}", attribute.name, c));
  }
  return header + "\n";
}

void put_position(Text& text, float value, double origin) {
  if (origin == 0) {
    put(text, value);
  } else {
    put(text, origin + static_cast<double>(value));
  }
}

void put_rows(const Particles& particles, std::size_t begin, std::size_t end, Text& text) {
  for (std::size_t i = begin; i < end; ++i) {
    put_position(text, particles.x[i], particles.origin.x);
    text.push_back(',');
    put_position(text, particles.y[i], particles.origin.y);
    text.push_back(',');
    put_position(text, particles.z[i], particles.origin.z);
    for (const Attribute& attribute : particles.attributes) {
      const auto components = static_cast<std::size_t>(attribute.components);
      for (std::size_t c = 0; c < components; ++c) {
        text.push_back(',');
        put(text, attribute.values[i * components + c]);
      }
    }
    text.push_back('\n');
  }
}

}  // namespace

void write_csv(const std::string& path, const Particles& particles) {
  TemporaryStream file(path);
  file.write(header_of(particles));
  const std::size_t count = particles.size();
  std::vector<Text> pieces(kPiecesAtOnce);
  for (std::size_t first = 0; first < count; first += kPiecesAtOnce * kRowsAPiece) {
    parallel_for(kPiecesAtOnce, 1, [&](std::size_t piece, std::size_t) {
      pieces[piece].clear();
      const std::size_t begin = std::min(count, first + piece * kRowsAPiece);
      put_rows(particles, begin, std::min(count, begin + kRowsAPiece), pieces[piece]);
    });
    for (const Text& text : pieces) file.write({text.data(), text.size()});
  }
  file.commit();
}

}  // namespace meniscus::io
