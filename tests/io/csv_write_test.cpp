#include "io/csv_write.h"

#include <bit>
#include <cmath>

#include "small_frames.h"

namespace meniscus {
namespace {

Particles written_and_read(const Particles& particles) {
  const Scratch scratch;
  const std::string path = scratch.path("f.csv");
  io::write_csv(path, particles);
  ReadOptions options;
  options.boundaries = true;
  return read_particles(path, options);
}

/// Floats of all sizes and signs, by their bits.
float any_float(std::uint32_t& state) {
  while (true) {
    state = state * 1664525u + 1013904223u;
    const auto value = std::bit_cast<float>(state);
    if (std::isfinite(value)) return value;
  }
}

TEST(CsvWriter, KeepsEveryBitOfPositionsAndAttributes) {
  Particles particles;
  Attribute velocity{"velocity", 3, {}}, pair{"pair", 2, {}}, id{"id", 1, {}};
  std::uint32_t state = 7;
  const std::size_t count = 20000;
  for (std::size_t i = 0; i < count; ++i) {
    particles.x.push_back(any_float(state));
    particles.y.push_back(any_float(state));
    particles.z.push_back(any_float(state));
    for (int c = 0; c < 3; ++c) velocity.values.push_back(any_float(state));
    for (int c = 0; c < 2; ++c) pair.values.push_back(any_float(state));
    id.values.push_back(static_cast<float>(i));
  }
  velocity.values[4] = NAN;
  velocity.values[5] = -INFINITY;
  particles.attributes = {velocity, pair, id};
  const Particles read = written_and_read(particles);
  const auto same = [](const std::vector<float>& a, const std::vector<float>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (std::isnan(a[i]) && std::isnan(b[i])) continue;
      ASSERT_EQ(std::bit_cast<std::uint32_t>(a[i]), std::bit_cast<std::uint32_t>(b[i])) << a[i] << " " << b[i];
    }
  };
  same(read.x, particles.x);
  same(read.y, particles.y);
  same(read.z, particles.z);
  same(read.find("velocity")->values, velocity.values);
  same(read.find("id")->values, id.values);
  for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(read.find("pair:1")->values[i], pair.values[2 * i + 1]);
}

TEST(CsvWriter, WritesPositionsFarFromZeroAsTheyAre) {
  Particles particles;
  particles.x = {0.125f, 0.25f};
  particles.y = {1, 2};
  particles.z = {3, 4};
  particles.origin = {5e6, 0, -7e6};
  const Scratch scratch;
  const std::string path = scratch.path("f.csv");
  io::write_csv(path, particles);
  EXPECT_EQ(bytes_of_file(path), "x,y,z\n5000000.125,1,-6999997\n5000000.25,2,-6999996\n");
}

TEST(CsvWriter, QuotesNamesThatWouldSeparateCells) {
  Particles particles;
  particles.x = particles.y = particles.z = {1};
  particles.attributes = {{"a,b", 1, {2}}, {"say \"c\"", 1, {3}}, {"d;e", 1, {4}}};
  const Particles read = written_and_read(particles);
  ASSERT_EQ(read.attributes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read.attributes[i].name, particles.attributes[i].name);
    EXPECT_EQ(read.attributes[i].values, particles.attributes[i].values);
  }
}

TEST(CsvWriter, OfNoParticlesWritesTheNames) {
  Particles particles;
  particles.attributes = {{"velocity", 3, {}}};
  EXPECT_TRUE(written_and_read(particles).empty());
}

TEST(CsvWriter, LeavesNothingBehindWhereItFails) {
  const Scratch scratch;
  EXPECT_THROW(io::write_csv(scratch.path("absent/f.csv"), {}), Error);
  EXPECT_FALSE(std::filesystem::exists(scratch.path("absent")));
}

}  // namespace
}  // namespace meniscus
