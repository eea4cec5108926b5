#include "damage.h"
#include "io/frame_head.h"

namespace meniscus {
namespace {

/// The small frame as Houdini's classic text.
std::string small_geo(int count = kSmallCount) {
  std::string text = "PGEOMETRY V5\nNPoints " + std::to_string(count) +
                     " NPrims 1\nNPointGroups 0 NPrimGroups 0\nNPointAttrib 4 NVertexAttrib 0 NPrimAttrib 1 NAttrib "
                     "0\nPointAttrib\nid 1 int 0\nkind 1 index 2 \"salt \\\" water\" oil\nv 3 vector 0 0 0\n"
                     "density 1 float 1000\n";
  for (int i = 0; i < count; ++i) {
    const vec3 p = small_position(i), v = small_velocity(i);
    for (const float number : {p.x, p.y, p.z}) text += std::to_string(number) + " ";
    text += "1 (" + std::to_string(10 * i) + "\t" + std::to_string(i % 2) + "\t";
    for (const float number : {v.x, v.y, v.z}) text += std::to_string(number) + " ";
    text += "\t" + std::to_string(1000 + i) + ")\n";
  }
  return text + "PrimitiveAttrib\ngenerator 1 index 1 papi\nPart 2 0 1 [0]\nbeginExtra\nendExtra\n";
}

TEST(Geo, ReadsPointsAndTheirAttributes) {
  const Scratch scratch;
  for (const std::string& bytes : {small_geo(), "\xef\xbb\xbf" + small_geo(), gzipped(small_geo())}) {
    const Particles particles = read_particles(scratch.write("f.geo", bytes));
    EXPECT_EQ(particles.format, "geo");
    expect_small(particles);
    EXPECT_EQ(particles.find("id")->values[6], 60.0f);
    EXPECT_EQ(particles.find("kind")->values, (std::vector<float>{0, 1, 0, 1, 0, 1, 0}));
    ASSERT_EQ(particles.notes.size(), 2u);
    EXPECT_NE(particles.notes[0].find("0 'salt \" water', 1 'oil'"), std::string::npos) << particles.notes[0];
  }
}

TEST(Geo, NeedsNoAttributesAndNoPoints) {
  const Scratch scratch;
  const std::string plain =
      "PGEOMETRY V5\r\nNPoints 2 NPrims 0\r\nNPointGroups 0 NPrimGroups 0\r\nNPointAttrib 0 NVertexAttrib 0 "
      "NPrimAttrib 0 "
      "NAttrib 0\r\n1 2 3 1\r\n4 5 6 1\r\nbeginExtra\r\nendExtra\r\n";
  const Particles particles = read_particles(scratch.write("f.geo", plain));
  ASSERT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.position(1), vec3(4, 5, 6));
  const Particles bare = read_particles(scratch.write("g.geo", plain.substr(0, plain.find("\r\nbegin"))));
  EXPECT_EQ(bare.size(), 2u);
  EXPECT_TRUE(read_particles(scratch.write("f.geo", small_geo(0))).empty());
}

TEST(Geo, NeedsNoBlanksAtBrackets) {
  const Scratch scratch;
  const std::string bytes =
      "PGEOMETRY V5\nNPoints 3 NPrims 0\nNPointGroups 0 NPrimGroups 0\nNPointAttrib 1 NVertexAttrib 0 NPrimAttrib 0 "
      "NAttrib 0\nPointAttrib\nv 2 float 0 0\n0 0 0 1(0 0)1 0 0 1(0 0)0 1 0 1(0 0)";
  EXPECT_EQ(read_particles(scratch.write("f.geo", bytes)).size(), 3u);
}

TEST(GeoDamaged, FewerPointsThanThereAreAreRefused) {
  const Scratch scratch;
  for (const char* count : {"NPoints 0", "NPoints 6"})
    EXPECT_EQ(refused(scratch.write("f.geo", replaced(small_geo(), "NPoints 7", count))).code(),
              ErrorCode::malformed_file);
}

TEST(Geo, TellsItsPointsFromItsStart) {
  const Scratch scratch;
  const io::FrameHead head = io::look_at_frame(scratch.write("f.geo", small_geo()));
  EXPECT_TRUE(head.counted && head.text);
  EXPECT_EQ(head.particles, 7u);
}

TEST(GeoDamaged, EveryPrefixIsRefusedUntilThePointsAreWhole) {
  check_prefixes("f.geo", small_geo(), small_geo().find("\nPrimitiveAttrib"));
}

TEST(GeoDamaged, EveryChangedByteIsReadOrRefused) { check_changed_bytes("f.geo", small_geo()); }

TEST(GeoDamaged, ImpossibleCountsAreRefused) {
  const Scratch scratch;
  for (const char* count : {"-1", "2147483648", "9223372036854775808", "18446744073709551615", "18446744073709551616",
                            "nan", "1e9", "7.5", "8"}) {
    refused_within(scratch.write("f.geo", replaced(small_geo(), "NPoints 7", std::string("NPoints ") + count)), 32);
    refused_within(scratch.write("f.geo", replaced(small_geo(), "Attrib 4", std::string("Attrib ") + count)), 32);
    refused_within(scratch.write("f.geo", replaced(small_geo(), "v 3 ", std::string("v ") + count + " ")), 32);
    refused_within(scratch.write("f.geo", replaced(small_geo(), "index 2", std::string("index ") + count)), 32);
  }
  EXPECT_EQ(refused(scratch.write("f.geo", replaced(small_geo(), "V5", "V4"))).code(), ErrorCode::unsupported);
}

TEST(GeoDamaged, NotFinitePositionsAreLeftOut) {
  const Scratch scratch;
  const Particles particles = read_particles(scratch.write("f.geo", replaced(small_geo(), "0.250000 ", "nan ")));
  EXPECT_EQ(particles.size(), 6u);
  EXPECT_EQ(particles.dropped_non_finite, 1u);
}

}  // namespace
}  // namespace meniscus
