#include "damage.h"

namespace meniscus {
namespace {

TEST(Npz, ReadsThreeColumnsStoredByNumpy) {
  const Particles particles = read_particles(sample("columns.npz"));
  EXPECT_EQ(particles.format, "npz");
  expect_small(particles);
  EXPECT_EQ(particles.find("id")->values[6], 60.0f);
  ASSERT_EQ(particles.notes.size(), 1u);
  for (const char* word : {"'names' is of type <U1", "'spare' has 3 values for 7 particles"})
    EXPECT_NE(particles.notes[0].find(word), std::string::npos) << particles.notes[0];
}

TEST(Npz, ReadsDeflatedArraysAndWhatTheFrameSaysOfItself) {
  const Particles particles = read_particles(sample("packed.npz"));
  expect_small(particles);
  EXPECT_EQ(particles.time, 0.375);
  EXPECT_EQ(particles.spacing, 0.25f);
  EXPECT_EQ(particles.up, Axis::z);
  EXPECT_TRUE(particles.notes.empty());
}

TEST(Npz, ReadsDirectoriesOf64BitNumbersAndBehindThemAComment) { expect_small(read_particles(sample("wide.npz"))); }

TEST(Npz, IsToldFromItsContentUnderAnyName) {
  const Scratch scratch;
  expect_small(read_particles(scratch.write("f.dat", bytes_of_file(sample("packed.npz")))));
  EXPECT_EQ(refused(scratch.write("f.npz", "1 2 3\n")).code(), ErrorCode::malformed_file);
}

TEST(Npz, ReadsTheArrayThatOptionsName) {
  ReadOptions options;
  options.positions = "vel";
  const Particles particles = read_particles(sample("packed.npz"), options);
  ASSERT_EQ(particles.size(), 7u);
  EXPECT_EQ(particles.position(2), small_velocity(2));
  options.positions = "x,y,q";
  EXPECT_EQ(outcome_of(sample("columns.npz"), options), Outcome::refused);
}

TEST(Npz, OfPickledObjectsIsRefusedWithAdvice) {
  const Error error = refused(sample("pickled.npz"));
  EXPECT_EQ(error.code(), ErrorCode::unsupported);
  EXPECT_NE(error.detail().advice.find("PySPH"), std::string::npos);
}

TEST(Npz, WithoutArraysSaysWhatItIs) {
  EXPECT_EQ(refused(sample("lists.zip")).code(), ErrorCode::unsupported);
  const Scratch scratch;
  EXPECT_EQ(refused(scratch.write("e.npz", "PK\x05\x06" + std::string(18, '\0'))).code(), ErrorCode::unsupported);
}

TEST(Npz, OfEveryPrefixIsRefused) {
  for (const char* name : {"packed.npz", "wide.npz"}) {
    const std::string bytes = bytes_of_file(sample(name));
    const bool has_comment = std::string(name) == "wide.npz";
    check_prefixes("f.npz", bytes, bytes.size() - (has_comment ? 0 : 0));
  }
  const std::string bytes = bytes_of_file(sample("columns.npz"));
  check_prefixes("f.npz", bytes, bytes.size(), 7);
}

TEST(Npz, OfEveryChangedByteIsReadOrRefused) {
  check_changed_bytes("f.npz", bytes_of_file(sample("packed.npz")));
  check_changed_bytes("f.npz", bytes_of_file(sample("wide.npz")));
}

TEST(Npz, OfAnyChangedValueIsNoticedByItsSum) {
  const std::string bytes = bytes_of_file(sample("columns.npz"));
  const Scratch scratch;
  const std::size_t values = bytes.find("(7,)") + 70;
  std::string damaged = bytes;
  damaged[values] = static_cast<char>(damaged[values] ^ 0x10);
  const Error error = refused(scratch.write("f.npz", damaged));
  EXPECT_EQ(error.code(), ErrorCode::malformed_file);
  EXPECT_NE(error.detail().problem.find("'x.npy' is damaged"), std::string::npos) << error.what();
}

TEST(Npz, OfAbsurdFieldsIsRefused) {
  const std::string bytes = bytes_of_file(sample("packed.npz"));
  const Scratch scratch;
  // Each number of the first entry of the directory and of its end, and of the member's own header.
  const std::size_t entry = bytes.find("PK\x01\x02"), end = bytes.find("PK\x05\x06");
  for (const std::string& value : {std::string(4, '\0'), std::string(4, '\xff'), std::string("\0\0\0\x80", 4),
                                   std::string("\xff\xff\xff\x7f", 4)}) {
    for (const std::size_t at : {entry + 16, entry + 20, entry + 24, entry + 42, end + 12, end + 16})
      if (bytes.substr(at, 4) != value)
        refused_within(scratch.write("a.npz", std::string(bytes).replace(at, 4, value)), 16);
    for (const std::size_t at : {entry + 10, entry + 28, end + 10})
      refused_within(scratch.write("b.npz", std::string(bytes).replace(at, 2, value.substr(2))), 16);
  }
}

/// An archive of `entries` that all name the same member of so many zeros, deflated.
std::string bomb(std::size_t mebibytes, int entries) {
  const std::string plain(mebibytes << 20, '\0');
  const std::string packed = gzipped(plain);
  // Of gzip: 10 bytes before the stream, its sum and size after it.
  const std::string stream = packed.substr(10, packed.size() - 18);
  std::uint32_t crc = 0;
  std::memcpy(&crc, packed.data() + packed.size() - 8, 4);
  const auto packed_size = static_cast<std::uint32_t>(stream.size()), size = static_cast<std::uint32_t>(plain.size());
  ByteWriter out(std::endian::little);
  const auto numbers = [&](ByteWriter& to) {
    to.put<std::uint16_t>(20).put<std::uint16_t>(0).put<std::uint16_t>(8).put<std::uint32_t>(0);
    to.put(crc).put(packed_size).put(size).put<std::uint16_t>(5).put<std::uint16_t>(0);
  };
  out.text("PK\x03\x04");
  numbers(out);
  out.text("x.npy").text(stream);
  const auto directory = static_cast<std::uint32_t>(out.bytes().size());
  for (int i = 0; i < entries; ++i) {
    out.text("PK\x01\x02").put<std::uint16_t>(20);
    numbers(out);
    out.put<std::uint16_t>(0).put<std::uint16_t>(0).put<std::uint16_t>(0).put<std::uint32_t>(0).put<std::uint32_t>(0);
    out.text("x.npy");
  }
  const auto directory_size = static_cast<std::uint32_t>(out.bytes().size()) - directory;
  out.text("PK\x05\x06").put<std::uint32_t>(0).put(static_cast<std::uint16_t>(entries));
  out.put(static_cast<std::uint16_t>(entries)).put(directory_size).put(directory).put<std::uint16_t>(0);
  return out.bytes();
}

TEST(NpzBomb, OfOneMemberOrOfManyNamesOfItIsStopped) {
  const Scratch scratch;
  const Error one = refused_within(scratch.write("one.npz", bomb(1, 1)), 32);
  EXPECT_EQ(one.code(), ErrorCode::malformed_file) << one.what();  // a mebibyte of zeros is no array
  const Error many = refused_within(scratch.write("many.npz", bomb(8, 2000)), 32);
  EXPECT_EQ(many.code(), ErrorCode::limit_exceeded) << many.what();
}

}  // namespace
}  // namespace meniscus
