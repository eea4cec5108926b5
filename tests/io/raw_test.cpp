#include "io/raw.h"

#include "small_frames.h"

namespace meniscus {
namespace {

template <class T>
std::string rows(std::endian order, int extra = 0, int count = kSmallCount) {
  ByteWriter out(order);
  for (int i = 0; i < count; ++i) {
    const vec3 p = small_position(i % kSmallCount);
    out.put(static_cast<T>(p.x)).put(static_cast<T>(p.y)).put(static_cast<T>(p.z));
    for (int k = 0; k < extra; ++k) out.put(static_cast<T>(100 + k));
  }
  return out.bytes();
}

Particles read_as(const std::string& form, const std::string& bytes, std::vector<std::string> columns = {}) {
  ReadOptions options;
  options.raw = form;
  options.columns = std::move(columns);
  return io::read_raw(io::Source{"f.bin", {bytes.data(), bytes.size()}}, options);
}

Error refused_as(const std::string& form, const std::string& bytes, std::vector<std::string> columns = {}) {
  try {
    read_as(form, bytes, std::move(columns));
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << form << " was read";
  return {ErrorCode::not_found, "nothing was thrown"};
}

TEST(Raw, IsReadInTheFormThatIsAskedFor) {
  expect_small(read_as("f32x3", rows<float>(std::endian::little)), false);
  expect_small(read_as("F32LEx3", rows<float>(std::endian::little)), false);
  expect_small(read_as("f32bex3", rows<float>(std::endian::big)), false);
  expect_small(read_as("f64x3", rows<double>(std::endian::little)), false);
  expect_small(read_as("f64bex5", rows<double>(std::endian::big, 2)), false);
  const Particles seven = read_as("f32x7", rows<float>(std::endian::little, 4));
  expect_small(seven, false);
  EXPECT_EQ(seven.notes.size(), 1u) << "four numbers were left out";
  const Particles turned = read_as("f32x3", rows<float>(std::endian::little), {"3", "1", "2"});
  EXPECT_EQ(turned.position(2), vec3(4, 0.5f, 0));
  EXPECT_TRUE(read_as("f32x3", "").empty());
}

TEST(Raw, OfAPartOfAParticleIsRefused) {
  const std::string bytes = rows<float>(std::endian::little);
  for (std::size_t size = 1; size < bytes.size(); ++size) {
    if (size % 12 == 0) continue;
    const Error error = refused_as("f32x3", bytes.substr(0, size));
    EXPECT_EQ(error.code(), ErrorCode::malformed_file);
    EXPECT_EQ(error.detail().byte_offset, size / 12 * 12);
  }
  EXPECT_EQ(refused_as("f64x3", bytes).code(), ErrorCode::malformed_file);
}

TEST(Raw, InTheWrongByteOrderIsRefusedWithTheRightOne) {
  const std::string bytes = rows<float>(std::endian::big, 0, 100);
  EXPECT_NE(refused_as("f32x3", bytes).detail().advice.find("f32bex3"), std::string::npos);
  const std::string wide = rows<double>(std::endian::big, 0, 100);
  EXPECT_NE(refused_as("f64x3", wide).detail().advice.find("f64bex3"), std::string::npos);
}

TEST(Raw, FormsThatAreNoneAreRefused) {
  for (const char* form : {"f", "f32", "f32x", "f32x2", "f16x3", "i32x3", "f32x3 ", "f32x99999999999", "f32x-3", "x3",
                           "f32bebex3", "f32x4097"})
    EXPECT_EQ(refused_as(form, "").code(), ErrorCode::invalid_argument) << form;
  EXPECT_EQ(refused_as("f32x3", "", {"1", "2"}).code(), ErrorCode::invalid_argument);
  EXPECT_EQ(refused_as("f32x3", "", {"1", "2", "4"}).code(), ErrorCode::invalid_argument);
}

TEST(Raw, OfTriplesIsToldFromTextByItsContent) {
  const Scratch scratch;
  const Particles particles = read_particles(scratch.write("f.xyz", rows<float>(std::endian::little)));
  expect_small(particles, false);
  EXPECT_EQ(particles.format, "raw");
  for (const std::string text : {"1 2 3\n4 5 6\n",
                                 "\xef\xbb\xbf"
                                 "1 2 3\n4 5 6",
                                 "# \xe6\xb0\xb4\xe6\xb0\xb4\xe6\xb0\xb4\n1 2 3\n4 5 6"})
    EXPECT_EQ(read_particles(scratch.write("g.xyz", text)).size(), 2u) << text;
  EXPECT_EQ(read_particles(scratch.write("h.xyz.gz", gzipped(rows<float>(std::endian::little)))).format, "raw");
  // The first bytes tell; that the end is missing is an error, not another format.
  const std::string cut = rows<float>(std::endian::little, 0, 500).substr(0, 5999);
  EXPECT_EQ(refused(scratch.write("i.xyz", cut)).code(), ErrorCode::malformed_file);
  EXPECT_EQ(refused(scratch.write("j.xyz", rows<float>(std::endian::big, 0, 100))).code(), ErrorCode::unsupported);
}

TEST(Raw, BytesOfAnyKindAreReadOrRefused) {
  std::string bytes = rows<float>(std::endian::little);
  const Scratch scratch;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int change : {0x01, 0x80, 0xff}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ change);
      const std::string path = scratch.write("f.xyz", damaged);
      try {
        const Particles particles = read_particles(path);
        EXPECT_EQ(particles.size() + particles.dropped_non_finite, static_cast<std::size_t>(kSmallCount));
      } catch (const Error& error) {
        EXPECT_EQ(error.detail().path, path);
      }
    }
  }
}

}  // namespace
}  // namespace meniscus
