#include <cstring>

#include "meniscus/output.h"
#include "output/scratch.h"

namespace meniscus {
namespace {

TEST(PointPly, IsAHeaderAndSevenLittleEndianFloatsAPoint) {
  const Scratch scratch;
  const std::vector<vec3> positions{{1, 2, 3}, {-4, 0.5f, 6}}, normals{{0, 0, 1}, {0, -1, 0}};
  const std::vector<float> radii{0.25f, 8};
  write_point_ply(scratch / "points.ply", positions, normals, radii);
  std::ifstream file(scratch / "points.ply", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float radius\nend_header\n";
  ASSERT_EQ(bytes.size(), header.size() + 2 * 7 * 4);
  EXPECT_EQ(bytes.substr(0, header.size()), header);
  const float expected[] = {1, 2, 3, 0, 0, 1, 0.25f, -4, 0.5f, 6, 0, -1, 0, 8};
  for (std::size_t i = 0; i < 14; ++i) {
    std::uint32_t bits = 0;
    for (std::size_t b = 0; b < 4; ++b)
      bits |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[header.size() + 4 * i + b])) << (8 * b);
    float value;
    std::memcpy(&value, &bits, sizeof(value));
    EXPECT_EQ(value, expected[i]) << i;
  }
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"points.ply"});
}

TEST(PointPly, RefusesArraysOfDifferentLengthsAndWritesNothing) {
  const Scratch scratch;
  const std::vector<vec3> two(2), three(3);
  const std::vector<float> radii(2);
  EXPECT_THROW(write_point_ply(scratch / "a.ply", two, three, radii), Error);
  EXPECT_THROW(write_point_ply(scratch / "a.ply", three, three, radii), Error);
  EXPECT_TRUE(scratch.names().empty());
  EXPECT_THROW(write_point_ply(scratch / "missing/a.ply", two, two, radii), Error);
}

}  // namespace
}  // namespace meniscus
