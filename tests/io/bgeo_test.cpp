#include "small_frames.h"

namespace meniscus {
namespace {

TEST(Bgeo, ReadsPositionsAndNumbersAndTextsAsNumbers) {
  const Scratch scratch;
  const Particles particles = read_particles(scratch.write("f.bgeo", small_bgeo()));
  EXPECT_EQ(particles.format, "bgeo");
  expect_small(particles);
  ASSERT_NE(particles.find("id"), nullptr);
  EXPECT_EQ(particles.find("id")->values[6], 60.0f);
  ASSERT_NE(particles.find("pair"), nullptr);
  EXPECT_EQ(particles.find("pair")->components, 2);
  EXPECT_EQ(particles.find("pair")->values[13], -6.0f);
  ASSERT_NE(particles.find("kind"), nullptr);
  EXPECT_EQ(particles.find("kind")->values, (std::vector<float>{0, 1, 0, 1, 0, 1, 0}));
  ASSERT_EQ(particles.notes.size(), 1u);
  EXPECT_NE(particles.notes[0].find("'kind' gives its texts as numbers: 0 'water', 1 ''"), std::string::npos)
      << particles.notes[0];
}

TEST(Bgeo, IsTheSameCompressedAndUnderAnyName) {
  const Scratch scratch;
  expect_small(read_particles(scratch.write("f.bgeo", gzipped(small_bgeo()))));
  expect_small(read_particles(scratch.write("f.bgeo.gz", gzipped(small_bgeo()))));
  expect_small(read_particles(scratch.write("f.txt", small_bgeo())));
  expect_small(read_particles(scratch.write("nameless", gzipped(small_bgeo()))));
}

TEST(Bgeo, ReadsGzipOfSeveralMembersAndWithPaddingBehind) {
  const Scratch scratch;
  const std::string bytes = small_bgeo();
  const std::string two = gzipped(bytes.substr(0, 150)) + gzipped(bytes.substr(150));
  expect_small(read_particles(scratch.write("two.bgeo", two)));
  expect_small(read_particles(scratch.write("padded.bgeo", two + std::string(512, '\0'))));
}

TEST(Bgeo, IgnoresWhatStandsBehindThePoints) {
  const Scratch scratch;
  expect_small(read_particles(scratch.write("f.bgeo", small_bgeo() + std::string(1000, '\x7f'))));
}

TEST(Bgeo, OfFewerPointsThanThereAreIsMalformed) {
  const Scratch scratch;
  for (const char count : {'\0', '\3'}) {
    std::string bytes = small_bgeo();
    bytes[12] = count;
    for (const std::string& file : {bytes, gzipped(bytes)})
      EXPECT_EQ(refused(scratch.write("f.bgeo", file)).code(), ErrorCode::malformed_file);
  }
}

TEST(Bgeo, OfNoPointsIsAnEmptyFrame) {
  const Scratch scratch;
  for (const std::string& bytes : {small_bgeo(0), gzipped(small_bgeo(0))}) {
    const Particles particles = read_particles(scratch.write("f.bgeo", bytes));
    EXPECT_TRUE(particles.empty());
    EXPECT_EQ(particles.attributes.size(), 5u);
  }
}

TEST(Bgeo, OfAnotherVersionIsUnsupported) {
  const Scratch scratch;
  std::string bytes = small_bgeo();
  bytes[8] = 6;
  EXPECT_EQ(refused(scratch.write("six.bgeo", bytes)).code(), ErrorCode::unsupported);
}

TEST(Bgeo, OfAnUnknownAttributeTypeIsMalformed) {
  const Scratch scratch;
  std::string bytes = small_bgeo();
  const std::size_t type = bytes.find("density") + 7 + 2;
  bytes[type + 3] = 9;
  EXPECT_EQ(refused(scratch.write("f.bgeo", bytes)).code(), ErrorCode::malformed_file);
}

TEST(Bgeo, SaysHowManyBytesArePromisedAndThere) {
  const Scratch scratch;
  const std::string whole = small_bgeo();
  const Error error = refused(scratch.write("f.bgeo", whole.substr(0, whole.size() - 3)));
  EXPECT_EQ(error.code(), ErrorCode::malformed_file);
  EXPECT_EQ(error.detail().expected, "7 x 48 bytes");
  EXPECT_EQ(error.detail().found, "335 bytes");
  EXPECT_EQ(error.detail().byte_offset, whole.size() - 2 - 7 * 48);
}

TEST(Bgeo, LeavesOutParticlesThatAreNotFiniteAndKeepsAttributesAligned) {
  const Scratch scratch;
  std::string bytes = small_bgeo();
  const std::size_t points = bytes.size() - 2 - 7 * 48;
  const std::string nan("\x7f\xc0\x00\x00", 4), infinity("\xff\x80\x00\x00", 4);
  bytes.replace(points + 2 * 48 + 4, 4, nan);       // y of particle 2
  bytes.replace(points + 6 * 48 + 8, 4, infinity);  // z of particle 6
  bytes.replace(points + 3 * 48 + 12, 4, nan);      // w is not a position
  const Particles particles = read_particles(scratch.write("f.bgeo", bytes));
  ASSERT_EQ(particles.size(), 5u);
  EXPECT_EQ(particles.dropped_non_finite, 2u);
  const int kept[] = {0, 1, 3, 4, 5};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(particles.position(k), small_position(kept[k]));
    EXPECT_EQ(particles.find("id")->values[k], 10.0f * static_cast<float>(kept[k]));
    EXPECT_EQ(particles.find("velocity")->values[3 * k + 2], small_velocity(kept[k]).z);
  }
  EXPECT_EQ(particles.find("velocity")->values.size(), 15u);
}

}  // namespace
}  // namespace meniscus
