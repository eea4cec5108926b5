#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/temporary_file.h"
#include "io/particle_writers.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kAtOnce = 16384;  ///< points
constexpr std::size_t kMostPoints = 0x7fffffff;
constexpr std::size_t kMost16 = 0xffff;

/// Big-endian numbers put one after the other.
class BigEndian {
 public:
  void u16(std::uint32_t value) {
    bytes_ += static_cast<char>(value >> 8 & 0xffu);
    bytes_ += static_cast<char>(value & 0xffu);
  }
  void u32(std::uint32_t value) {
    u16(value >> 16);
    u16(value & 0xffffu);
  }
  void real(float value) { u32(std::bit_cast<std::uint32_t>(value)); }
  void text(std::string_view words) {
    u16(static_cast<std::uint32_t>(words.size()));
    bytes_ += words;
  }
  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

/// The file, through gzip or not.
class Output {
 public:
  Output(const std::string& path, bool packs) : stream_(path), packs_(packs) {
    constexpr int kGzip = 16 + MAX_WBITS, kFast = 3, kMemory = 8;
    if (packs_ && deflateInit2(&z_, kFast, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  ~Output() {
    if (packs_) deflateEnd(&z_);
  }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  void write(const std::string& bytes) { put(bytes, Z_NO_FLUSH); }
  void commit() {
    if (packs_) put({}, Z_FINISH);
    stream_.commit();
  }

 private:
  void put(const std::string& bytes, int flush) {
    if (!packs_) {
      stream_.write(bytes);
      return;
    }
    z_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    z_.avail_in = static_cast<uInt>(bytes.size());
    packed_.resize(1 << 16);
    do {
      z_.next_out = reinterpret_cast<Bytef*>(packed_.data());
      z_.avail_out = static_cast<uInt>(packed_.size());
      deflate(&z_, flush);
      stream_.write(std::span(packed_).first(packed_.size() - z_.avail_out));
    } while (z_.avail_out == 0);
  }

  TemporaryStream stream_;
  bool packs_;
  z_stream z_{};
  std::vector<char> packed_;
};

enum class Kind : std::uint32_t { real = 0, integer = 1, vector = 5 };

Kind kind_of(const Attribute& attribute) {
  constexpr float kMostWhole = 16777216;  // 2^24: beyond, floats are not every whole number
  if (attribute.components == 3) {
    for (const std::string_view name : {"velocity", "v", "normal", "N"})
      if (attribute.name == name) return Kind::vector;
  }
  const auto whole = [](float value) { return std::abs(value) <= kMostWhole && value == std::trunc(value); };
  return attribute.name == "id" && std::all_of(attribute.values.begin(), attribute.values.end(), whole) ? Kind::integer
                                                                                                        : Kind::real;
}

void check_limits(const std::string& path, const Particles& particles) {
  bool fits = particles.size() <= kMostPoints && particles.attributes.size() <= kMost16;
  for (const Attribute& attribute : particles.attributes)
    fits = fits && attribute.name.size() <= kMost16 && static_cast<std::size_t>(attribute.components) <= kMost16;
  if (!fits)
    throw Error(ErrorCode::limit_exceeded, {"there is more than BGEO can count",
                                            "below 2^31 points; names, components and attributes below 2^16",
                                            fmt::format("{} points", particles.size()),
                                            path,
                                            {},
                                            {},
                                            "write .npz or .vtp"});
}

}  // namespace

void write_bgeo(const std::string& path, const Particles& particles) {
  check_lengths(path, particles);
  check_limits(path, particles);
  Output output(path, lower(path).ends_with(".gz"));
  std::vector<Kind> kinds;
  BigEndian header;
  header.bytes() = "BgeoV";
  // Version, points, primitives, point groups, primitive groups, attributes of points, vertices, primitives, of all.
  for (const std::size_t number : {std::size_t{5}, particles.size(), std::size_t{0}, std::size_t{0}, std::size_t{0},
                                   particles.attributes.size(), std::size_t{0}, std::size_t{0}, std::size_t{0}})
    header.u32(static_cast<std::uint32_t>(number));
  for (const Attribute& attribute : particles.attributes) {
    kinds.push_back(kind_of(attribute));
    header.text(attribute.name);
    header.u16(static_cast<std::uint32_t>(attribute.components));
    header.u32(static_cast<std::uint32_t>(kinds.back()));
    for (int c = 0; c < attribute.components; ++c) header.u32(0);  // default values
  }
  output.write(header.bytes());

  const bool moved = has_origin(particles);
  const auto coordinate = [&](float value, int axis) {
    return moved ? static_cast<float>(particles.origin[axis] + static_cast<double>(value)) : value;
  };
  BigEndian points;
  for (std::size_t first = 0; first < particles.size(); first += kAtOnce) {
    points.bytes().clear();
    for (std::size_t i = first; i < std::min(first + kAtOnce, particles.size()); ++i) {
      points.real(coordinate(particles.x[i], 0));
      points.real(coordinate(particles.y[i], 1));
      points.real(coordinate(particles.z[i], 2));
      points.real(1);
      for (std::size_t a = 0; a < kinds.size(); ++a) {
        const Attribute& attribute = particles.attributes[a];
        const auto parts = static_cast<std::size_t>(attribute.components);
        for (std::size_t part = 0; part < parts; ++part) {
          const float value = attribute.values[i * parts + part];
          if (kinds[a] == Kind::integer) {
            points.u32(static_cast<std::uint32_t>(static_cast<std::int32_t>(value)));
          } else {
            points.real(value);
          }
        }
      }
    }
    output.write(points.bytes());
  }
  // No detail attributes; what other programs write at the end.
  output.write(std::string("\x00\xff", 2));
  output.commit();
}

}  // namespace meniscus::io
