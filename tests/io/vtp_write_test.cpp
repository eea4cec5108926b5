#include <cmath>

#include "io/vtp_write.h"
#include "small_frames.h"

namespace meniscus {
namespace {

Particles some_particles(std::size_t count) {
  Particles particles;
  for (std::size_t i = 0; i < count; ++i) {
    const auto f = static_cast<float>(i);
    particles.x.push_back(std::sin(f));
    particles.y.push_back(1e-30f * f);
    particles.z.push_back(-f / 3);
  }
  particles.attributes = {{"velocity", 3, std::vector<float>(3 * count, 0.1f)},
                          {"a <&> \"b\" \xc3\xbc", 1, particles.x}};
  particles.attributes[0].values[count] = std::numeric_limits<float>::quiet_NaN();
  particles.time = 0.1;
  return particles;
}

void expect_bits(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0);
}

TEST(VtpWriter, KeepsEveryBitOnTheWayAndBack) {
  const Scratch scratch;
  const Particles written = some_particles(200'000);
  io::write_vtp(scratch.path("f.vtp"), written);
  const Particles read = read_particles(scratch.path("f.vtp"));
  expect_bits(read.x, written.x);
  expect_bits(read.y, written.y);
  expect_bits(read.z, written.z);
  EXPECT_EQ(read.time, 0.1);
  ASSERT_EQ(read.attributes.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.attributes[i].name, written.attributes[i].name);
    expect_bits(read.attributes[i].values, written.attributes[i].values);
  }
}

TEST(VtpWriter, AddsTheOriginInDoubles) {
  const Scratch scratch;
  Particles written = some_particles(1000);
  written.origin = {1e6, 0, -3e7};
  io::write_vtp(scratch.path("f.vtp"), written);
  const Particles read = read_particles(scratch.path("f.vtp"));
  ASSERT_EQ(read.size(), 1000u);
  EXPECT_NE(read.origin.x, 0);
  ReadOptions same;
  same.origin = written.origin;
  const Particles back = read_particles(scratch.path("f.vtp"), same);
  for (std::size_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(static_cast<double>(back.z[i]) + back.origin.z,
              static_cast<double>(static_cast<float>(static_cast<double>(written.z[i]) - 3e7 + 3e7)) - 3e7);
    EXPECT_NEAR(static_cast<double>(back.x[i]), static_cast<double>(written.x[i]), 1e-9);
  }
}

TEST(VtpWriter, WritesAnEmptyFrame) {
  const Scratch scratch;
  io::write_vtp(scratch.path("f.vtp"), Particles{});
  EXPECT_TRUE(read_particles(scratch.path("f.vtp")).empty());
}

TEST(VtpWriter, ReplacesWhatXmlCannotHoldInNames) {
  const Scratch scratch;
  Particles particles = some_particles(1);
  particles.attributes = {{"a\x01z\xff\xc3", 1, {7}}};
  io::write_vtp(scratch.path("f.vtp"), particles);
  EXPECT_NE(read_particles(scratch.path("f.vtp")).find("a?z??"), nullptr);
}

TEST(VtpWriter, RefusesArraysOfDifferentLengthsAndLeavesNothing) {
  const Scratch scratch;
  Particles particles = some_particles(3);
  particles.y.pop_back();
  EXPECT_THROW(io::write_vtp(scratch.path("f.vtp"), particles), Error);
  EXPECT_FALSE(std::filesystem::exists(scratch.path("f.vtp")));
  EXPECT_THROW(io::write_vtp(scratch.path("absent/f.vtp"), some_particles(3)), Error);
}

}  // namespace
}  // namespace meniscus
