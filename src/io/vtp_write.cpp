#include "io/vtp_write.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/temporary_file.h"
#include "io/particle_writers.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kAtOnce = 1 << 16;  ///< points

/// Bytes of the UTF-8 character that starts `text`, 0 where it is none.
std::size_t utf8_length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return 0;
  return length;
}

/// A name as an attribute's value; what XML cannot hold becomes '?'.
std::string escaped(std::string_view name) {
  std::string result;
  while (!name.empty()) {
    const std::size_t length = utf8_length(name);
    const char c = name[0];
    if (length == 0 || (c >= 0 && c < ' ') || c == '\x7f') {
      result += '?';
    } else if (length == 1 && std::string_view("&<>\"").find(c) != std::string_view::npos) {
      result += fmt::format("&#{};", static_cast<int>(c));
    } else {
      result += name.substr(0, length);
    }
    name.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

/// Writes <DataArray> elements and remembers where their values will stand.
class Header {
 public:
  std::string array(std::string_view type, std::string_view name, std::size_t components, std::uint64_t bytes) {
    const std::string element = fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        type, escaped(name), components, offset_);
    offset_ += sizeof(std::uint64_t) + bytes;
    return element;
  }

 private:
  std::uint64_t offset_ = 0;
};

template <class T>
std::span<const char> bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

void write_length(TemporaryStream& stream, std::uint64_t bytes) {
  stream.write(bytes_of(std::span<const std::uint64_t>(&bytes, 1)));
}

/// x y z of each particle, with the origin added where T is double.
template <class T>
void write_points(TemporaryStream& stream, const Particles& particles) {
  write_length(stream, particles.size() * 3 * sizeof(T));
  std::vector<T> values;
  for (std::size_t first = 0; first < particles.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, particles.size() - first);
    values.resize(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const vec3 point = particles.position(first + i);
      for (int axis = 0; axis < 3; ++axis) {
        T& value = values[3 * i + static_cast<std::size_t>(axis)];
        if constexpr (sizeof(T) == sizeof(double)) {
          value = static_cast<double>(point[axis]) + particles.origin[axis];
        } else {
          value = point[axis];
        }
      }
    }
    stream.write(bytes_of(std::span<const T>(values)));
  }
}

/// first, first + 1, ... : the points of the vertices, and where each vertex ends.
template <class T>
void write_counting(TemporaryStream& stream, T first, std::size_t count) {
  write_length(stream, count * sizeof(T));
  std::vector<T> values;
  for (std::size_t done = 0; done < count; done += kAtOnce) {
    values.resize(std::min(kAtOnce, count - done));
    std::iota(values.begin(), values.end(), static_cast<T>(first + static_cast<T>(done)));
    stream.write(bytes_of(std::span<const T>(values)));
  }
}

}  // namespace

void write_vtp(const std::string& path, const Particles& particles) {
  check_lengths(path, particles);
  const std::uint64_t count = particles.size();
  const bool wide = has_origin(particles);
  const bool many = count >= std::uint64_t{1} << 31;

  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"{}\" header_type=\"UInt64\">\n"
      "  <PolyData>\n",
      std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian");
  if (particles.time && std::isfinite(*particles.time))
    text += fmt::format(
        "    <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{}"
        "</DataArray>\n    </FieldData>\n",
        *particles.time);
  text += fmt::format(
      "    <Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n      <Points>\n",
      count);
  Header header;
  text += header.array(wide ? "Float64" : "Float32", "Points", 3, count * 3 * (wide ? 8 : 4));
  text += "      </Points>\n      <PointData>\n";
  for (const Attribute& attribute : particles.attributes)
    text += header.array("Float32", attribute.name, static_cast<std::size_t>(attribute.components),
                         attribute.values.size() * sizeof(float));
  text += "      </PointData>\n      <Verts>\n";
  for (const char* name : {"connectivity", "offsets"})
    text += header.array(many ? "Int64" : "Int32", name, 1, count * (many ? 8 : 4));
  text += "      </Verts>\n    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n_";

  TemporaryStream stream(path);
  stream.write(text);
  wide ? write_points<double>(stream, particles) : write_points<float>(stream, particles);
  for (const Attribute& attribute : particles.attributes) {
    write_length(stream, attribute.values.size() * sizeof(float));
    stream.write(bytes_of(std::span<const float>(attribute.values)));
  }
  for (const int first : {0, 1}) {
    if (many) {
      write_counting<std::int64_t>(stream, first, particles.size());
    } else {
      write_counting<std::int32_t>(stream, first, particles.size());
    }
  }
  stream.write(std::string_view("\n  </AppendedData>\n</VTKFile>\n"));
  stream.commit();
}

}  // namespace meniscus::io
