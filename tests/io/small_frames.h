/// The same small frame in several formats, written byte by byte: particle i of kSmallCount has
/// position (0.25 i, 1 - 0.5 i, i^2), velocity (i, -i, 0.5 i), density 1000 + i and id 10 i.
#pragma once

#include "meniscus/io.h"
#include "scratch.h"

namespace meniscus {

constexpr int kSmallCount = 7;

inline vec3 small_position(int i) {
  const auto f = static_cast<float>(i);
  return {0.25f * f, 1.0f - 0.5f * f, f * f};
}
inline vec3 small_velocity(int i) {
  const auto f = static_cast<float>(i);
  return {f, -f, 0.5f * f};
}

/// BGEO with an id, an indexed string between, a velocity, a density and a colour of two integers.
inline std::string small_bgeo(int count = kSmallCount) {
  ByteWriter out;
  out.text("BgeoV").put<std::int32_t>(5).put<std::int32_t>(count);
  for (const std::int32_t number : {0, 0, 0, 5, 0, 0, 0}) out.put(number);
  out.counted("id").put<std::uint16_t>(1).put<std::int32_t>(1).put<std::int32_t>(0);
  out.counted("kind").put<std::uint16_t>(1).put<std::int32_t>(4).put<std::int32_t>(2).counted("water").counted("");
  out.counted("v").put<std::uint16_t>(3).put<std::int32_t>(5).put(0.0f).put(0.0f).put(0.0f);
  out.counted("density").put<std::uint16_t>(1).put<std::int32_t>(0).put(1000.0f);
  out.counted("pair").put<std::uint16_t>(2).put<std::int32_t>(1).put<std::int32_t>(0).put<std::int32_t>(0);
  for (int i = 0; i < count; ++i) {
    const vec3 p = small_position(i), v = small_velocity(i);
    out.put(p.x).put(p.y).put(p.z).put(1.0f).put<std::int32_t>(10 * i).put<std::int32_t>(i % 2);
    out.put(v.x).put(v.y).put(v.z).put(1000.0f + static_cast<float>(i)).put<std::int32_t>(i).put<std::int32_t>(-i);
  }
  out.put<std::uint8_t>(0x00).put<std::uint8_t>(0xff);
  return out.bytes();
}

/// Binary PLY: an element with a list before the vertices and one after, a list among the vertices' properties.
inline std::string small_ply(std::endian order, bool with_list) {
  ByteWriter out(order);
  out.text("ply\nformat binary_").text(order == std::endian::big ? "big" : "little").text("_endian 1.0\n");
  out.text("comment element vertex 3\nelement camera 2\nproperty list uchar short k\nproperty double f\n");
  out.text("element vertex " + std::to_string(kSmallCount) + "\nproperty ushort id\nproperty double x\n");
  if (with_list) out.text("property list int uint neighbours\n");
  out.text("property float vy\nproperty float y\nproperty float z\nproperty float vx\nproperty float vz\n");
  out.text("property float rho\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n");
  for (int camera = 0; camera < 2; ++camera) {
    out.put(static_cast<std::uint8_t>(camera + 1));
    for (int k = 0; k <= camera; ++k) out.put<std::int16_t>(7);
    out.put(0.5);
  }
  for (int i = 0; i < kSmallCount; ++i) {
    const vec3 p = small_position(i), v = small_velocity(i);
    out.put(static_cast<std::uint16_t>(10 * i)).put(static_cast<double>(p.x));
    if (with_list) {
      out.put<std::int32_t>(i);
      for (int k = 0; k < i; ++k) out.put<std::uint32_t>(static_cast<std::uint32_t>(k));
    }
    out.put(v.y).put(p.y).put(p.z).put(v.x).put(v.z).put(1000.0f + static_cast<float>(i));
  }
  out.put<std::uint8_t>(3).put<std::int32_t>(0).put<std::int32_t>(1).put<std::int32_t>(2);
  return out.bytes();
}

/// Checks the positions, and what there is of velocity, density and id.
inline void expect_small(const Particles& particles, bool with_attributes = true) {
  ASSERT_EQ(particles.size(), static_cast<std::size_t>(kSmallCount));
  ASSERT_EQ(particles.y.size(), particles.size());
  ASSERT_EQ(particles.z.size(), particles.size());
  for (int i = 0; i < kSmallCount; ++i) EXPECT_EQ(particles.position(static_cast<std::size_t>(i)), small_position(i));
  for (const Attribute& attribute : particles.attributes) {
    EXPECT_EQ(attribute.values.size(), particles.size() * static_cast<std::size_t>(attribute.components));
  }
  if (!with_attributes) return;
  const Attribute* velocity = particles.find("velocity");
  const Attribute* density = particles.find("density");
  ASSERT_NE(velocity, nullptr);
  ASSERT_NE(density, nullptr);
  ASSERT_EQ(velocity->components, 3);
  ASSERT_EQ(density->components, 1);
  for (int i = 0; i < kSmallCount; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(vec3(velocity->values[3 * at], velocity->values[3 * at + 1], velocity->values[3 * at + 2]),
              small_velocity(i));
    EXPECT_EQ(density->values[at], 1000.0f + static_cast<float>(i));
  }
}

/// Reads a file that must be refused and returns the error, which names the file.
inline Error refused(const std::string& path) {
  try {
    read_particles(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
    EXPECT_NE(std::string(error.what()).find(path), std::string::npos);
    return error;
  }
  ADD_FAILURE() << path << " was read";
  return {ErrorCode::invalid_argument, "nothing was thrown"};
}

}  // namespace meniscus
