// RealFlow's particles, BIN: little-endian, without gaps; what a particle has depends on the version of the file.
#include <fmt/format.h>

#include "io/frame_head.h"
#include "io/particle_rows.h"
#include "io/readers.h"

namespace meniscus::io {
namespace {

constexpr std::string_view kMagic("\xda\xba\xfa\x00", 4);
constexpr std::size_t kVersion = 254, kTime = 264, kCount = 276;  ///< bytes from the start
constexpr std::size_t kHeader = 320;                              ///< 36 more from version 7 on: the emitter
constexpr int kNewest = 15;

double value_at(const Source& source, std::size_t at, Scalar type) {
  return read_value(type, std::endian::little, source.bytes.data() + at);
}

struct RealFlowHeader {
  std::uint64_t count = 0;
  std::size_t first = 0;  ///< byte offset of the first particle
  std::size_t stride = 0;
  std::vector<RowValue> values;
};

/// What stands in a particle behind its position, in order.
std::vector<RowValue> values_of(int version, std::size_t& stride) {
  std::vector<RowValue> values;
  stride = 3 * sizeof(float);
  const auto add = [&](const char* name, std::size_t components, Scalar type = Scalar::float32, int since = 0) {
    if (version < since) return;
    values.push_back({name, type, stride, components});
    stride += components * size_of(type);
  };
  add("velocity", 3);
  add("force", 3);
  add("vorticity", 3, Scalar::float32, 9);
  add("normal", 3, Scalar::float32, 3);
  add("neighbors", 1, Scalar::int32, 4);
  add("uvw", 3, Scalar::float32, 5);
  add("info", 1, Scalar::int16, 5);
  for (const char* name : {"age", "isolation", "viscosity", "density", "pressure", "mass", "temperature"}) add(name, 1);
  add("id", 1, version < 12 ? Scalar::int32 : Scalar::uint64);
  return values;
}

RealFlowHeader header_of(const Source& source) {
  if (source.bytes.size() < kHeader) source.malformed("the file ends inside its header", source.bytes.size());
  const int version = static_cast<int>(value_at(source, kVersion, Scalar::int16));
  if (version < 1 || version > kNewest)
    source.unsupported(fmt::format("is a RealFlow file of version {}; 1 to {} are read", version, kNewest),
                       "convert it with Partio: partconvert FILE FILE.bgeo");
  RealFlowHeader header;
  const double count = value_at(source, kCount, Scalar::int32);
  if (count < 0)
    source.malformed("has an impossible number of particles", kCount, "0 to 2^31", fmt::format("{}", count));
  header.count = static_cast<std::uint64_t>(count);
  header.first = kHeader + (version >= 7 ? 36 : 0);
  if (header.first > source.bytes.size()) source.malformed("the file ends inside its header", source.bytes.size());
  header.values = values_of(version, header.stride);
  return header;
}

}  // namespace

bool is_realflow(const Source& start) { return start.starts_with(kMagic); }

void look_at_realflow(const Source& start, FrameHead& head) {
  const RealFlowHeader header = header_of(start);
  if (header.count > (head.plain_bytes - std::min<std::uint64_t>(head.plain_bytes, header.first)) / header.stride)
    start.malformed("the file is shorter than its particles", header.first);
  head.format = "realflow";
  head.particles = header.count;
  head.counted = true;
  head.values = 3;
  for (const RowValue& value : header.values) head.values += static_cast<double>(value.components);
}

Particles read_realflow(const Source& source, const ReadOptions& options) {
  const RealFlowHeader header = header_of(source);
  source.require(header.first, header.count, header.stride, "particles");
  Particles particles;
  particles.format = "realflow";
  particles.time = value_at(source, kTime, Scalar::float32);
  set_rows(source.stored(header.first), header.stride, static_cast<std::size_t>(header.count), std::endian::little,
           header.values, options, particles);
  return particles;
}

}  // namespace meniscus::io
