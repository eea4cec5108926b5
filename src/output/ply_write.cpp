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

}  // namespace

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
