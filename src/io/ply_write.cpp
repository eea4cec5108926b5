#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/temporary_file.h"
#include "io/particle_writers.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kAtOnce = 16384;  ///< points

/// Names of a vector's parts that readers of PLY files know; else NAME_0, NAME_1 ... A property's name has no blanks.
std::string part_name(const Attribute& attribute, int part) {
  std::string name = attribute.name.empty() ? "unnamed" : attribute.name;
  for (char& c : name)
    if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') c = '_';
  if (attribute.components == 1) return name == "x" || name == "y" || name == "z" ? name + "_" : name;
  if (attribute.components == 3 && name == "velocity") return std::string("v") + "xyz"[part];
  if (attribute.components == 3 && name == "normal") return std::string("n") + "xyz"[part];
  return fmt::format("{}_{}", name, part);
}

std::string header_of(const Particles& particles) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  if (particles.time) header += fmt::format("comment time {}\n", *particles.time);
  if (particles.spacing) header += fmt::format("comment spacing {}\n", *particles.spacing);
  if (particles.up) header += fmt::format("comment up {}\n", name_of(*particles.up));
  header += fmt::format("element vertex {}\n", particles.size());
  for (const char axis : {'x', 'y', 'z'})
    header += fmt::format("property {} {}\n", has_origin(particles) ? "double" : "float", axis);
  for (const Attribute& attribute : particles.attributes)
    for (int part = 0; part < attribute.components; ++part)
      header += fmt::format("property float {}\n", part_name(attribute, part));
  return header + "end_header\n";
}

/// Little-endian.
template <class Word>
void put(std::string& bytes, Word bits) {
  for (std::size_t i = 0; i < sizeof bits; ++i, bits = static_cast<Word>(bits >> 8))
    bytes += static_cast<char>(bits & 0xffu);
}

}  // namespace

void write_ply(const std::string& path, const Particles& particles) {
  check_lengths(path, particles);
  TemporaryStream stream(path);
  stream.write(header_of(particles));
  const bool is_double = has_origin(particles);
  std::string bytes;
  for (std::size_t first = 0; first < particles.size(); first += kAtOnce) {
    bytes.clear();
    for (std::size_t i = first; i < std::min(first + kAtOnce, particles.size()); ++i) {
      const vec3 position = particles.position(i);
      for (int axis = 0; axis < 3; ++axis) {
        if (is_double) {
          put(bytes, std::bit_cast<std::uint64_t>(particles.origin[axis] + static_cast<double>(position[axis])));
        } else {
          put(bytes, std::bit_cast<std::uint32_t>(position[axis]));
        }
      }
      for (const Attribute& attribute : particles.attributes) {
        const auto parts = static_cast<std::size_t>(attribute.components);
        for (std::size_t part = 0; part < parts; ++part)
          put(bytes, std::bit_cast<std::uint32_t>(attribute.values[i * parts + part]));
      }
    }
    stream.write(bytes);
  }
  stream.commit();
}

}  // namespace meniscus::io
