// What headers tell, against what reading the whole frame finds.
#include "io/frame_head.h"

#include "small_frames.h"

namespace meniscus {
namespace {

using io::FrameHead;
using io::look_at_frame;

double values_of(const Particles& particles) {
  double values = 3;
  for (const Attribute& attribute : particles.attributes) values += attribute.components;
  return values;
}

void expect_told(const std::string& path) {
  const Particles particles = read_particles(path);
  const FrameHead head = look_at_frame(path);
  EXPECT_EQ(head.format, particles.format) << path;
  EXPECT_EQ(head.particles, particles.size()) << path;
  EXPECT_TRUE(head.counted) << path;
  EXPECT_GE(head.values, 3) << path;
  EXPECT_GE(static_cast<double>(head.reading_bytes()), 12.0 * static_cast<double>(particles.size())) << path;
}

TEST(FrameHead, CountsTheParticlesOfEveryFormat) {
  const Scratch scratch;
  expect_told(scratch.write("f.bgeo", small_bgeo()));
  expect_told(scratch.write("g.bgeo", gzipped(small_bgeo())));
  for (const std::endian order : {std::endian::little, std::endian::big})
    for (const bool with_list : {false, true}) expect_told(scratch.write("f.ply", small_ply(order, with_list)));
  for (const char* name : {"grid_42_ascii.vtk", "grid_42_binary.vtk", "polydata_51_ascii.vtk", "polydata_51_binary.vtk",
                           "mesh_ascii.ply", "mesh_big.ply", "pysph.hdf5", "pysph_gzip.hdf5"})
    expect_told(sample(name));
  expect_told(scratch.write("f.xyz", "# x y z\n0 0 0\n1 2 3\n4 5 6\n"));
}

TEST(FrameHead, KnowsHowManyNumbersAParticleHas) {
  const Scratch scratch;
  const std::string path = scratch.write("f.bgeo", small_bgeo());
  EXPECT_EQ(look_at_frame(path).values, values_of(read_particles(path)));
  EXPECT_EQ(look_at_frame(scratch.write("f.xyz", "x,y,z,p\n0,0,0,1\n1,1,1,2\n")).values, 4);
  EXPECT_EQ(look_at_frame(scratch.write("g.xyz", "0 0 0 1\n1 1 1 2\n")).values, 3)
      << "columns without names are left out";
}

TEST(FrameHead, JudgesLongTextFromItsFirstRows) {
  const Scratch scratch;
  std::string text;
  for (int i = 0; i < 20000; ++i) text += "0." + std::to_string(1000 + i % 9000) + " 1.5 -2.25\n";
  const FrameHead head = look_at_frame(scratch.write("f.xyz", text));
  EXPECT_FALSE(head.counted);
  EXPECT_NEAR(static_cast<double>(head.particles), 20000, 200);
  EXPECT_TRUE(head.text);
}

TEST(FrameHead, RefusesCountsThatTheFileIsTooShortFor) {
  const Scratch scratch;
  std::string bytes = small_bgeo();
  for (const std::size_t at : {9u, 12u}) bytes[at] = '\xff';
  const std::string vtk = "# vtk DataFile Version 4.1\nt\nBINARY\nDATASET POLYDATA\nPOINTS 99999999999 float\n";
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  for (const std::string& content : {bytes, vtk, ply, std::string("text without numbers\n")}) {
    try {
      look_at_frame(scratch.write("f", content));
      ADD_FAILURE() << content.substr(0, 20);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::malformed_file) << error.what();
    }
  }
  EXPECT_THROW(look_at_frame(scratch.path("missing.ply")), Error);
  EXPECT_EQ(look_at_frame(scratch.write("empty.xyz", "")).particles, 0u);
}

TEST(FrameHead, CountsAllFilesOfAFrame) {
  const Scratch scratch;
  const std::string first = scratch.write("f_0.xyz", "0 0 0\n1 1 1\n"), second = scratch.write("f_1.xyz", "2 2 2\n");
  FramePath frame{first};
  EXPECT_EQ(look_at_frame(frame).particles, look_at_frame(first).particles);
  frame.further = {second};
  const FrameHead head = look_at_frame(frame);
  EXPECT_EQ(head.particles, look_at_frame(first).particles + look_at_frame(second).particles);
  EXPECT_EQ(head.file_bytes, 18u);
}

}  // namespace
}  // namespace meniscus
