// Options reach the readers, whatever the file's bytes look like.
#include "small_frames.h"

namespace meniscus {
namespace {

TEST(RawFiles, AreReadAsTheOptionSaysWhateverTheyBeginWith) {
  const Scratch scratch;
  ByteWriter bytes(std::endian::little);
  bytes.text("ply\n").put(1.5f).put(-2.0f).put(3.0f).put(4.0f).put(5.0f);
  ReadOptions options;
  options.raw = "f32x3";
  for (const std::string& content : {bytes.bytes(), gzipped(bytes.bytes())}) {
    const Particles particles = read_particles(scratch.write("f.ply", content), options);
    ASSERT_EQ(particles.size(), 2u);
    EXPECT_EQ(particles.y[0], 1.5f);
    EXPECT_EQ(particles.z[1], 5.0f);
  }
}

TEST(Options, ThatDoNotFitAFileNameIt) {
  const Scratch scratch;
  const std::string path = scratch.write("f.xyz", "1 2 3\n");
  ReadOptions options;
  options.where = "type==3";
  try {
    read_particles(path, options);
    ADD_FAILURE() << "there is no type";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_EQ(error.detail().path, path);
  }
}

}  // namespace
}  // namespace meniscus
