#include "meniscus/io.h"
#include "scratch.h"

namespace meniscus {
namespace {

Particles with_comments(const Scratch& scratch, const std::string& comments) {
  return read_particles(scratch.write("f.ply", "ply\nformat ascii 1.0\n" + comments +
                                                   "element vertex 1\nproperty float x\nproperty float y\n"
                                                   "property float z\nend_header\n1 2 3\n"));
}

TEST(PlyComments, TellTimeSpacingAndUp) {
  const Scratch scratch;
  const Particles particles = with_comments(scratch, "comment time 0.04\ncomment spacing 0.025\ncomment up z\n");
  EXPECT_EQ(particles.time, 0.04);
  EXPECT_EQ(particles.spacing, 0.025f);
  EXPECT_EQ(particles.up, Axis::z);
}

TEST(PlyComments, ForPeopleTellNothing) {
  const Scratch scratch;
  for (const char* text : {"comment\n", "comment time\n", "comment time of day\n", "comment time now\n",
                           "comment time inf\n", "comment spacing 0\n", "comment spacing -1\n", "comment spacing nan\n",
                           "comment spacing 1e60\n", "comment up w\n", "comment up yy\n", "obj_info time 3\n"}) {
    const Particles particles = with_comments(scratch, text);
    EXPECT_EQ(particles.size(), 1u) << text;
    EXPECT_FALSE(particles.time || particles.spacing || particles.up) << text;
  }
}

}  // namespace
}  // namespace meniscus
