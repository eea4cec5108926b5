#include <fmt/format.h>
#include <bit>
#include <cstring>

#include "meniscus/output.h"
#include "base/temporary_file.h"

namespace meniscus {
namespace {

constexpr std::size_t kProperties = 7;
constexpr std::size_t kAtOnce = 16384;  ///< points

void put_float(char* to, float value) {
  auto bits = std::bit_cast<std::uint32_t>(value);
  for (int i = 0; i < 4; ++i, bits >>= 8) to[i] = static_cast<char>(bits & 0xffu);
}

/// Names of a vector's parts that readers of PLY files know; else name_0, name_1 ...
std::string part_name(const Attribute& attribute, int part) {
  if (attribute.components == 1) return attribute.name;
  if (attribute.components == 3) {
    const char axis = "xyz"[part];
    if (attribute.name == "velocity") return std::string("v") + axis;
    if (attribute.name == "normal") return std::string("n") + axis;
  }
  return fmt::format("{}_{}", attribute.name, part);
}

std::string particles_header(const Particles& particles) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  if (particles.time) header += fmt::format("comment time {}\n", *particles.time);
  if (particles.spacing) header += fmt::format("comment spacing {}\n", *particles.spacing);
  if (particles.up) header += fmt::format("comment up {}\n", name_of(*particles.up));
  header += fmt::format("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n", particles.size());
  for (const Attribute& attribute : particles.attributes)
    for (int part = 0; part < attribute.components; ++part)
      header += fmt::format("property float {}\n", part_name(attribute, part));
  return header + "end_header\n";
}

void check_lengths(const std::string& path, const Particles& particles) {
  const std::size_t count = particles.size();
  bool good = particles.y.size() == count && particles.z.size() == count;
  for (const Attribute& attribute : particles.attributes)
    good = good && attribute.components > 0 &&
           attribute.values.size() == count * static_cast<std::size_t>(attribute.components);
  if (!good)
    throw Error(ErrorCode::invalid_argument,
                {"the particles' arrays have different lengths", {}, {}, path, {}, {}, {}});
}

}  // namespace

void write_particles_ply(const std::string& path, const Particles& particles) {
  check_lengths(path, particles);
  TemporaryStream stream(path);
  stream.write(particles_header(particles));
  std::vector<char> bytes;
  const auto put = [&bytes](float value) {
    bytes.resize(bytes.size() + 4);
    put_float(bytes.data() + bytes.size() - 4, value);
  };
  for (std::size_t first = 0; first < particles.size(); first += kAtOnce) {
    bytes.clear();
    for (std::size_t i = first; i < std::min(first + kAtOnce, particles.size()); ++i) {
      for (const float value : {particles.x[i], particles.y[i], particles.z[i]}) put(value);
      for (const Attribute& attribute : particles.attributes) {
        const auto parts = static_cast<std::size_t>(attribute.components);
        for (std::size_t part = 0; part < parts; ++part) put(attribute.values[i * parts + part]);
      }
    }
    stream.write(bytes);
  }
  stream.commit();
}

void write_point_ply(const std::string& path, std::span<const vec3> positions, std::span<const vec3> normals,
                     std::span<const float> radii) {
  if (normals.size() != positions.size() || radii.size() != positions.size())
    throw Error(ErrorCode::invalid_argument, fmt::format("{}: {} points have {} normals and {} radii", path,
                                                         positions.size(), normals.size(), radii.size()));
  TemporaryStream stream(path);
  std::string header = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", positions.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "radius"})
    header += fmt::format("property float {}\n", name);
  header += "end_header\n";
  stream.write(header);
  std::vector<char> bytes;
  for (std::size_t first = 0; first < positions.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, positions.size() - first);
    bytes.resize(count * kProperties * 4);
    char* at = bytes.data();
    for (std::size_t i = first; i < first + count; ++i)
      for (const float value :
           {positions[i].x, positions[i].y, positions[i].z, normals[i].x, normals[i].y, normals[i].z, radii[i]}) {
        put_float(at, value);
        at += 4;
      }
    stream.write(bytes);
  }
  stream.commit();
}

}  // namespace meniscus
