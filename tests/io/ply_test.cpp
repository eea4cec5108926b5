#include <cmath>

#include "small_frames.h"

namespace meniscus {
namespace {

TEST(Ply, ReadsBothByteOrdersListsAndElementsAroundTheVertices) {
  const Scratch scratch;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    for (const bool with_list : {false, true}) {
      const Particles particles = read_particles(scratch.write("f.ply", small_ply(order, with_list)));
      EXPECT_EQ(particles.format, "ply");
      expect_small(particles);
      EXPECT_EQ(particles.find("id")->values[6], 60.0f);
      EXPECT_EQ(particles.notes.size(), with_list ? 1u : 0u);
    }
  }
}

TEST(Ply, ReadsText) {
  const Scratch scratch;
  const Particles particles = read_particles(scratch.write(
      "f.ply",
      "ply\r\nformat ascii 1.0\r\ncomment c\r\nobj_info o\r\nelement face 2\r\nproperty list uchar int i\r\n"
      "element vertex 2\r\nproperty list uchar int n\r\nproperty float x\r\nproperty float y\r\nproperty double z\r\n"
      "property float nx\r\nproperty float ny\r\nproperty float nz\r\nproperty uchar quality\r\nend_header\r\n"
      "3 0 1 2\r\n1 7\r\n0 1 2 3 0 0 1 9\r\n2 5 6 4 5 6 0 1 0 8\r\n"));
  ASSERT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.position(1), vec3(4, 5, 6));
  EXPECT_EQ(particles.find("normal")->values, (std::vector<float>{0, 0, 1, 0, 1, 0}));
  EXPECT_EQ(particles.find("quality")->values, (std::vector<float>{9, 8}));
}

TEST(Ply, OfDoublesFarFromTheOriginLosesNothing) {
  const Scratch scratch;
  for (const bool is_text : {false, true}) {
    const std::string head = std::string("ply\nformat ") + (is_text ? "ascii" : "binary_little_endian") +
                             " 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\n"
                             "end_header\n";
    ByteWriter out(std::endian::little);
    for (const double value : {4e6, 5e6, 6e6, 4e6 + 0.1, 5e6 + 0.2, 6e6 + 0.3}) out.put(value);
    const Particles particles = read_particles(
        scratch.write("f.ply", head + (is_text ? "4e6 5e6 6e6\n4000000.1 5000000.2 6000000.3\n" : out.bytes())));
    ASSERT_EQ(particles.size(), 2u);
    EXPECT_NEAR(particles.origin.z + static_cast<double>(particles.z[1]), 6e6 + 0.3, 1e-7) << is_text;
  }
}

class PlyByVtk : public testing::TestWithParam<const char*> {};

TEST_P(PlyByVtk, IsReadWithLinearColours) {
  const Particles particles = read_particles(sample(GetParam()));
  expect_small(particles, false);
  const Attribute* colour = particles.find("color");
  ASSERT_NE(colour, nullptr);
  ASSERT_EQ(colour->components, 3);
  // sRGB 0 and 255 are linear 0 and 1; 160/255 by the definition of sRGB.
  EXPECT_EQ(colour->values[0], 0.0f);
  EXPECT_EQ(colour->values[1], 1.0f);
  EXPECT_NEAR(colour->values[12], std::pow((160.0 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Samples, PlyByVtk, testing::Values("mesh_ascii.ply", "mesh_little.ply", "mesh_big.ply"),
                         [](const auto& info) {
                           return std::string(info.param).substr(5, std::string(info.param).size() - 9);
                         });

TEST(Ply, WithoutVerticesOrPositionsIsMalformed) {
  const Scratch scratch;
  const std::string head = "ply\nformat ascii 1.0\n";
  for (const std::string rest :
       {"element face 0\nproperty list uchar int i\nend_header\n",
        "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
        "element vertex 1\nproperty float x\nproperty float y\nproperty list uchar float z\nend_header\n1 2 1 3\n",
        "element vertex one\nend_header\n", "property float x\nend_header\n",
        "element vertex 1\nproperty real x\nend_header\n", "novelty\nend_header\n"}) {
    EXPECT_EQ(refused(scratch.write("f.ply", head + rest)).code(), ErrorCode::malformed_file) << rest;
  }
  EXPECT_EQ(refused(scratch.write("f.ply", "ply\nformat binary_pdp 1.0\nend_header\n")).code(),
            ErrorCode::malformed_file);
  EXPECT_EQ(refused(scratch.write("f.ply", "ply\nelement vertex 0\nend_header\n")).code(), ErrorCode::malformed_file);
}

TEST(Ply, OfNoVerticesIsAnEmptyFrame) {
  const Scratch scratch;
  const Particles particles = read_particles(
      scratch.write("f.ply",
                    "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                    "property float z\nend_header\n"));
  EXPECT_TRUE(particles.empty());
}

TEST(Ply, LeavesOutVerticesThatAreNotFinite) {
  const Scratch scratch;
  const Particles particles = read_particles(
      scratch.write("f.ply",
                    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                    "property int id\nend_header\n1 2 3 0\n1 nan 3 1\n4 5 6 2\n"));
  EXPECT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.find("id")->values, (std::vector<float>{0, 2}));
}

TEST(PlyDamaged, FewerVerticesThanThereAreAreRefused) {
  const Scratch scratch;
  const auto ply = [&](const char* form, int count, const std::string& rows) {
    return scratch.write("f.ply", std::string("ply\nformat ") + form + " 1.0\nelement vertex " + std::to_string(count) +
                                      "\nproperty float x\nproperty float y\nproperty float z\nelement face 0\n"
                                      "property list uchar int vertex_indices\nend_header\n" +
                                      rows);
  };
  const std::string text = "0 0 0\n1 0 0\n0 1 0\n", binary(36, '\0');
  EXPECT_EQ(read_particles(ply("ascii", 3, text + "\n \n")).size(), 3u);
  EXPECT_EQ(read_particles(ply("binary_little_endian", 3, binary + "\n")).size(), 3u);
  for (const int count : {0, 2}) {
    EXPECT_EQ(refused(ply("ascii", count, text)).code(), ErrorCode::malformed_file);
    EXPECT_EQ(refused(ply("binary_little_endian", count, binary)).code(), ErrorCode::malformed_file);
  }
}

}  // namespace
}  // namespace meniscus
