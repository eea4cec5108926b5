// Each number of a header replaced by extremes: refused where it cannot be, else read; never more memory than bytes.
#include <cmath>
#include <limits>

#include "damage.h"

namespace meniscus {
namespace {

constexpr std::uint64_t kMost = 32;  ///< MiB that reading a small file may take

Outcome outcome_within(const std::string& path) {
  const std::uint64_t before = peak_rss_bytes();
  const Outcome outcome = outcome_of(path);
  EXPECT_LT(peak_rss_bytes() - before, kMost << 20) << path;
  return outcome;
}

template <class T>
std::string with(std::string bytes, std::size_t at, T value, std::endian order) {
  const std::string put = ByteWriter(order).put(value).bytes();
  return bytes.replace(at, put.size(), put);
}

const std::vector<std::uint32_t> kExtremes32{0,           0xffffffffu, 0x80000000u, 0x7fffffffu,
                                             0x7fc00000u, 0xff800000u, 0x00ffffffu, 0x10000000u};

TEST(Extremes, InTheNumbersOfBgeoAreRefusedWhereTheyMatter) {
  const Scratch scratch;
  const std::string good = small_bgeo();
  const auto read_with = [&](std::size_t at, std::uint32_t value) {
    const std::string bytes = with(good, at, value, std::endian::big);
    const Outcome plain = outcome_within(scratch.write("f.bgeo", bytes));
    EXPECT_EQ(outcome_within(scratch.write("f.bgeo.gz", gzipped(bytes))), plain) << at << " " << value;
    return plain;
  };
  for (const std::uint32_t extreme : kExtremes32) {
    EXPECT_EQ(read_with(5, extreme), Outcome::refused) << "version " << extreme;
    EXPECT_EQ(read_with(9, extreme), Outcome::refused) << "points " << extreme;
    for (const std::size_t unused : {13u, 17u, 21u, 29u, 33u, 37u})
      EXPECT_EQ(read_with(unused, extreme), Outcome::read) << "number at " << unused;
    if (extreme == 0) continue;
    EXPECT_EQ(read_with(25, extreme), Outcome::refused) << "attributes " << extreme;
    // The type of the first attribute, and how many texts the second one has.
    EXPECT_EQ(read_with(47, extreme), Outcome::refused) << "type " << extreme;
    EXPECT_EQ(read_with(67, extreme), Outcome::refused) << "texts " << extreme;
  }
  for (const std::uint16_t extreme : {std::uint16_t{0x7fff}, std::uint16_t{0x8000}, std::uint16_t{0xffff}}) {
    for (const std::size_t length : {41u, 45u, 55u, 61u}) {
      const std::string bytes = with(good, length, extreme, std::endian::big);
      EXPECT_EQ(outcome_within(scratch.write("f.bgeo", bytes)), Outcome::refused) << length << " " << extreme;
    }
  }
}

TEST(Extremes, InTheOtherByteOrderBgeoIsRefused) {
  const Scratch scratch;
  const std::string good = small_bgeo();
  for (const std::size_t at : {5u, 9u, 25u})
    EXPECT_EQ(outcome_within(scratch.write("f.bgeo", good.substr(0, at) + good[at + 3] + good[at + 2] + good[at + 1] +
                                                         good[at] + good.substr(at + 4))),
              Outcome::refused);
}

const std::vector<std::string> kCounts{"-1",
                                       "2147483648",
                                       "4294967296",
                                       "9223372036854775808",
                                       "18446744073709551615",
                                       "18446744073709551616",
                                       "6148914691236517206",
                                       "nan",
                                       "1e9",
                                       "7.5"};

TEST(Extremes, InTheCountsOfPlyAreRefused) {
  const Scratch scratch;
  for (const bool with_list : {false, true}) {
    const std::string good = small_ply(std::endian::little, with_list);
    for (const std::string& count : kCounts) {
      for (const char* element : {"element vertex ", "element camera "}) {
        const std::string was = element + std::string(element[8] == 'v' ? "7" : "2");
        EXPECT_EQ(outcome_within(scratch.write("f.ply", replaced(good, "\n" + was, "\n" + (element + count)))),
                  Outcome::refused)
            << element << count;
      }
    }
    EXPECT_EQ(outcome_within(scratch.write("f.ply", replaced(good, "\nelement vertex 7", "\nelement vertex 0"))),
              Outcome::read);
  }
  const std::string text = bytes_of_file(sample("mesh_ascii.ply"));
  for (const std::string& count : kCounts)
    EXPECT_EQ(outcome_within(scratch.write("f.ply", replaced(text, "vertex 7", "vertex " + count))), Outcome::refused);
}

TEST(Extremes, InTheLengthsOfListsOfPlyAreRefused) {
  const Scratch scratch;
  const auto ply_with = [](const std::string& type, const std::string& length) {
    return "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty list " + type +
           " uchar l\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + length +
           std::string(14, '\0');
  };
  const auto bytes_of = [](auto value) { return ByteWriter().put(value).bytes(); };
  EXPECT_EQ(outcome_within(scratch.write("f.ply", ply_with("double", bytes_of(2.0)))), Outcome::read);
  for (const double length : {-1.0, 2147483648.0, 9223372036854775808.0, 1e300, std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(outcome_within(scratch.write("f.ply", ply_with("double", bytes_of(length)))), Outcome::refused) << length;
    EXPECT_EQ(outcome_within(scratch.write("f.ply", ply_with("float", bytes_of(static_cast<float>(length))))),
              Outcome::refused)
        << length;
  }
  for (const std::uint32_t length : {0xffffffffu, 0x80000000u, 0x7fffffffu})
    for (const char* type : {"int", "uint"})
      EXPECT_EQ(outcome_within(scratch.write("f.ply", ply_with(type, bytes_of(length)))), Outcome::refused) << length;
}

TEST(Extremes, OfPositionsOfPlyInTheOtherByteOrderAreNoCrash) {
  const Scratch scratch;
  const std::string good = small_ply(std::endian::little, true);
  EXPECT_EQ(outcome_within(scratch.write("f.ply", replaced(good, "little", "big"))), Outcome::refused);
  outcome_within(scratch.write("g.ply", replaced(small_ply(std::endian::little, false), "little", "big")));
}

TEST(Extremes, OfTheTimeAreNoTime) {
  const Scratch scratch;
  const std::string vtk = bytes_of_file(sample("polydata_42_ascii.vtk"));
  EXPECT_EQ(read_particles(scratch.write("f.vtk", vtk)).time, 0.375);
  for (const char* time : {"nan", "inf", "-1e999"})
    EXPECT_FALSE(read_particles(scratch.write("f.vtk", replaced(vtk, "0.375", time))).time) << time;
}

TEST(Extremes, OfPositionsLeaveNoneOut) {
  // A spread so small that no round number amidst the positions can be counted from.
  const Scratch scratch;
  const Particles particles = read_particles(scratch.write("f.xyz", "1 0 0\n1 1e-320 0\n"));
  ASSERT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.dropped_non_finite, 0u);
  EXPECT_EQ(static_cast<double>(particles.x[0]) + particles.origin.x, 1.0);
}

/// Wherever 8 bytes are one of the arrays' lengths, each extreme is put. (The newer form of HDF5 has checksums over its
/// headers, so this is the older one. Other numbers of it are the library's own business, which may not survive them.)
TEST(Extremes, InTheLengthsOfHdf5AreReadOrRefused) {
  const Scratch scratch;
  for (const char* name : {"rank2.hdf5", "packed.hdf5"}) {
    const std::string good = bytes_of_file(sample(name));
    ASSERT_EQ(outcome_within(sample(name)), Outcome::read);
    int refused_count = 0;
    for (std::size_t at = 0; at + 8 <= good.size(); at += 8) {
      std::uint64_t value = 0;
      std::memcpy(&value, good.data() + at, 8);
      if (value != 7 && value != 3) continue;
      for (const std::uint64_t extreme :
           {std::uint64_t{0}, ~std::uint64_t{0}, std::uint64_t{1} << 31, std::uint64_t{1} << 63,
            std::uint64_t{0x7ff8000000000000}, std::uint64_t{6148914691236517206}}) {
        const std::string bytes = with(good, at, extreme, std::endian::little);
        refused_count += outcome_within(scratch.write("f.hdf5", bytes)) == Outcome::refused ? 1 : 0;
      }
    }
    EXPECT_GT(refused_count, 6) << name;
  }
}

}  // namespace
}  // namespace meniscus
