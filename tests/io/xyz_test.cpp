#include "small_frames.h"

namespace meniscus {
namespace {

Particles read_text(const std::string& text, const std::string& name = "f.xyz") {
  const Scratch scratch;
  return read_particles(scratch.write(name, text));
}

Error refused_text(const std::string& text) {
  const Scratch scratch;
  return refused(scratch.write("f.xyz", text));
}

TEST(Xyz, ReadsNumbersBetweenBlanksTabsAndCommas) {
  for (const std::string text :
       {"1 2.5 -3e2\n4 5 6\n", "1,2.5,-3e2\n4,5,6", "\t1\t2.5  -300 \r\n\r\n 4 5 +6\r\n", "1; 2.5; -300;\n4; 5; 6;\n",
        "\xef\xbb\xbf"
        "1 2.5 -300\n4 5 6"}) {
    const Particles particles = read_text(text);
    ASSERT_EQ(particles.size(), 2u) << text;
    EXPECT_EQ(particles.position(0), vec3(1, 2.5f, -300));
    EXPECT_EQ(particles.position(1), vec3(4, 5, 6));
    EXPECT_EQ(particles.format, "xyz");
    EXPECT_TRUE(particles.attributes.empty());
  }
}

TEST(Xyz, SkipsCommentsAndEmptyLinesAnywhere) {
  const Particles particles = read_text("# made today\n\n% more\n1 2 3\n# between\n\n// and here\n4 5 6\n#");
  ASSERT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.position(1), vec3(4, 5, 6));
}

TEST(Xyz, KeepsColumnsThatAHeaderNames) {
  for (const std::string header : {"x y z vx vy vz rho id", "# x y z u v w density id",
                                   "#x,y,z,vel_x,vel_y,vel_z,Density,id", "X Y Z Vel:0 Vel:1 Vel:2 RHO id"}) {
    const Particles particles = read_text(header + "\n1 2 3 4 5 6 7 8\n10 20 30 40 50 60 70 80\n");
    ASSERT_EQ(particles.size(), 2u) << header;
    ASSERT_EQ(particles.attributes.size(), 3u) << header;
    EXPECT_EQ(particles.find("velocity")->values, (std::vector<float>{4, 5, 6, 40, 50, 60})) << header;
    EXPECT_EQ(particles.find("density")->values, (std::vector<float>{7, 70}));
    EXPECT_EQ(particles.find("id")->values, (std::vector<float>{8, 80}));
  }
}

TEST(Xyz, FindsPositionsInAnyColumns) {
  const Particles particles = read_text(
      "\"Idp\",\"Type\",\"Points:2\",\"Points:0\",\"Points:1\",\"Empty\"\n7,a,3,1,2,\n8,,30,10,20,\n", "f.csv");
  ASSERT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.position(0), vec3(1, 2, 3));
  EXPECT_EQ(particles.position(1), vec3(10, 20, 30));
  EXPECT_EQ(particles.find("Idp")->values, (std::vector<float>{7, 8}));
  EXPECT_EQ(particles.find("Type"), nullptr);
  EXPECT_EQ(particles.notes.size(), 2u);
}

TEST(Xyz, LeavesOutFurtherColumnsWithoutNamesAndSaysSo) {
  const Particles particles = read_text("# written by hand\n1 2 3 4 5\n");
  EXPECT_TRUE(particles.attributes.empty());
  ASSERT_EQ(particles.notes.size(), 1u);
  EXPECT_NE(particles.notes[0].find("2 columns"), std::string::npos);
}

TEST(Xyz, NamesTheLineAndWhatIsWrongInIt) {
  Error error = refused_text("1 2 3\n4 5 6\n\n7 8\n");
  EXPECT_EQ(error.code(), ErrorCode::malformed_file);
  EXPECT_EQ(error.detail().line, 4u);
  error = refused_text("x y z\n1 2 3\n4 five 6\n");
  EXPECT_EQ(error.detail().line, 3u);
  EXPECT_EQ(error.detail().found, "'five'");
  EXPECT_EQ(refused_text("1 2\n3 4\n").detail().line, 1u);
  EXPECT_EQ(refused_text("1 2 3\n1 2 3 4\n").detail().line, 2u);
}

TEST(Xyz, OfProseIsRefused) {
  EXPECT_EQ(refused_text("This is no list of particles.\nIt has words only.\n").code(), ErrorCode::malformed_file);
}

TEST(Xyz, WithACountOnItsFirstLineMustHaveAsMany) {
  EXPECT_EQ(read_text("2\nx y z\n1 2 3\n4 5 6\n").size(), 2u);
  EXPECT_EQ(refused_text("3\n1 2 3\n4 5 6\n").code(), ErrorCode::malformed_file);
  const Particles more = read_text("1\n1 2 3\n4 5 6\n");
  EXPECT_EQ(more.size(), 2u);
  EXPECT_EQ(more.notes.size(), 1u);
}

TEST(Xyz, LeavesOutNumbersThatAreNotFinite) {
  const Particles particles = read_text("x y z id\n1 2 3 0\nnan 2 3 1\n1 -inf 3 2\n1 2 1e999 3\n4 5 6 4\n");
  ASSERT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.dropped_non_finite, 3u);
  EXPECT_EQ(particles.find("id")->values, (std::vector<float>{0, 4}));
}

TEST(Xyz, OfNoLinesIsAnEmptyFrame) {
  EXPECT_TRUE(read_text("").empty());
  EXPECT_TRUE(read_text("# nothing left\n").empty());
}

TEST(Xyz, IsReadThroughGzip) {
  const Scratch scratch;
  EXPECT_EQ(read_particles(scratch.write("f.xyz.gz", gzipped("1 2 3\n4 5 6\n"))).size(), 2u);
}

}  // namespace
}  // namespace meniscus
