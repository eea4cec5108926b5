// What the binary writers make is read back bit by bit, and is laid out as their formats say.
#include <array>

#include "damage.h"

namespace meniscus {
namespace {

Particles frame(bool far = false) {
  Particles particles;
  for (int i = 0; i < kSmallCount; ++i) {
    const vec3 p = small_position(i) + 1.0f / 3.0f;
    particles.x.push_back(p.x);
    particles.y.push_back(-p.y);
    particles.z.push_back(p.z * 1e-3f);
  }
  if (far) particles.origin = {1e6, 0, -3e7};
  Attribute velocity{"velocity", 3, {}}, density{"density", 1, {}}, id{"id", 1, {}}, pair{"pair", 2, {}};
  for (int i = 0; i < kSmallCount; ++i) {
    for (int c = 0; c < 3; ++c) velocity.values.push_back(0.1f * static_cast<float>(i + c));
    density.values.push_back(1000.1f + static_cast<float>(i));
    id.values.push_back(static_cast<float>(10 * i - 5));
    pair.values.push_back(static_cast<float>(i));
    pair.values.push_back(-0.5f);
  }
  particles.attributes = {velocity, density, id, pair};
  particles.time = 0.1;
  particles.spacing = 0.025f;
  particles.up = Axis::z;
  return particles;
}

const Attribute& attribute(const Particles& particles, const std::string& name) {
  const Attribute* found = particles.find(name);
  EXPECT_NE(found, nullptr) << name;
  static const Attribute none;
  return found == nullptr ? none : *found;
}

void expect_same_values(const Particles& read, const Particles& written) {
  EXPECT_EQ(read.x, written.x);
  EXPECT_EQ(read.y, written.y);
  EXPECT_EQ(read.z, written.z);
  EXPECT_EQ(read.origin, written.origin);
  for (const char* name : {"velocity", "density", "id"})
    EXPECT_EQ(attribute(read, name).values, attribute(written, name).values) << name;
}

TEST(BinaryWriters, AreReadBackBitByBit) {
  const Scratch scratch;
  const Particles particles = frame();
  for (const char* name : {"f.npz", "f.ply", "f.bgeo", "f.bgeo.gz"}) {
    SCOPED_TRACE(name);
    write_particles(scratch.path(name), particles);
    expect_same_values(read_particles(scratch.path(name)), particles);
  }
  for (const char* name : {"f.npz", "f.bgeo"})
    EXPECT_EQ(attribute(read_particles(scratch.path(name)), "pair").values, particles.attributes[3].values);
  for (const char* name : {"f.npz", "f.ply"}) {
    const Particles read = read_particles(scratch.path(name));
    EXPECT_EQ(read.time, particles.time);
    EXPECT_EQ(read.spacing, particles.spacing);
    EXPECT_EQ(read.up, particles.up);
  }
}

TEST(BinaryWriters, KeepPositionsFarFromTheOriginWhereTheFormatCan) {
  const Scratch scratch;
  const Particles particles = frame(true);
  ReadOptions options;
  options.origin = particles.origin;
  for (const char* name : {"f.npz", "f.ply"}) {
    SCOPED_TRACE(name);
    write_particles(scratch.path(name), particles);
    const Particles read = read_particles(scratch.path(name), options);
    for (std::size_t i = 0; i < read.size(); ++i) {
      // What a double of 3e7 can hold.
      EXPECT_NEAR(read.x[i], particles.x[i], 1e-9);
      EXPECT_NEAR(read.z[i], particles.z[i], 1e-8);
    }
  }
}

TEST(BinaryWriters, WriteEmptyFramesAndFramesWithoutAttributes) {
  const Scratch scratch;
  Particles one;
  one.x = one.y = one.z = {1.5f};
  for (const char* name : {"f.npz", "f.ply", "f.bgeo", "f.bgeo.gz"}) {
    write_particles(scratch.path(name), Particles{});
    EXPECT_TRUE(read_particles(scratch.path(name)).empty()) << name;
    write_particles(scratch.path(name), one);
    EXPECT_EQ(read_particles(scratch.path(name)).x, one.x) << name;
  }
}

TEST(BinaryWriters, LeaveNothingWhereArraysDoNotFit) {
  const Scratch scratch;
  Particles particles = frame();
  particles.attributes[0].values.pop_back();
  for (const char* name : {"f.npz", "f.ply", "f.bgeo"}) {
    EXPECT_THROW(write_particles(scratch.path(name), particles), Error);
    EXPECT_FALSE(std::filesystem::exists(scratch.path(name)));
  }
}

TEST(BinaryWriters, GiveNpzAttributesNamesThatNothingElseHas) {
  const Scratch scratch;
  Particles particles = frame();
  particles.attributes[1].name = "positions";
  particles.attributes[2].name = "a/b\n";
  write_particles(scratch.path("f.npz"), particles);
  const Particles read = read_particles(scratch.path("f.npz"));
  EXPECT_EQ(read.x, particles.x);
  EXPECT_EQ(attribute(read, "positions_").values, particles.attributes[1].values);
  EXPECT_EQ(attribute(read, "a_b_").values, particles.attributes[2].values);
}

TEST(BgeoWriter, LaysTheFileOutByteByByte) {
  const Scratch scratch;
  Particles particles;
  particles.x = {1, 2}, particles.y = {3, 4}, particles.z = {5, 6};
  particles.attributes = {{"id", 1, {7, -8}}, {"velocity", 3, {1, 2, 3, 4, 5, 6}}, {"density", 1, {0.5f, 1.5f}}};
  write_particles(scratch.path("f.bgeo"), particles);
  ByteWriter out;
  out.text("BgeoV");
  for (const std::int32_t number : {5, 2, 0, 0, 0, 3, 0, 0, 0}) out.put(number);
  out.counted("id").put<std::uint16_t>(1).put<std::int32_t>(1).put<std::int32_t>(0);
  out.counted("velocity").put<std::uint16_t>(3).put<std::int32_t>(5).put(0.0f).put(0.0f).put(0.0f);
  out.counted("density").put<std::uint16_t>(1).put<std::int32_t>(0).put(0.0f);
  out.put(1.0f).put(3.0f).put(5.0f).put(1.0f).put<std::int32_t>(7).put(1.0f).put(2.0f).put(3.0f).put(0.5f);
  out.put(2.0f).put(4.0f).put(6.0f).put(1.0f).put<std::int32_t>(-8).put(4.0f).put(5.0f).put(6.0f).put(1.5f);
  out.put<std::uint8_t>(0x00).put<std::uint8_t>(0xff);
  EXPECT_EQ(bytes_of_file(scratch.path("f.bgeo")), out.bytes());
}

}  // namespace
}  // namespace meniscus
