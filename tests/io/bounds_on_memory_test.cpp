// Counts that a file claims must be justified by its bytes before anything is allocated for them.
#include <gtest/gtest.h>

#include "small_frames.h"

namespace meniscus {
namespace {

/// Reads a file that must be refused without the process growing by more than `mebibytes`.
Error refused_within(const std::string& path, std::uint64_t mebibytes) {
  const std::uint64_t before = peak_rss_bytes();
  Error error = refused(path);
  EXPECT_LT(peak_rss_bytes() - before, mebibytes << 20) << path;
  return error;
}

TEST(AbsurdCounts, InBgeoAreRefused) {
  const Scratch scratch;
  std::string bytes = small_bgeo();
  for (const std::size_t at : {9u, 12u}) bytes[at] = '\xff';  // the number of points
  EXPECT_EQ(refused_within(scratch.write("f.bgeo", bytes), 16).code(), ErrorCode::malformed_file);
  EXPECT_EQ(refused_within(scratch.write("g.bgeo", gzipped(bytes)), 16).code(), ErrorCode::malformed_file);
  std::string attributes = small_bgeo();
  for (std::size_t at = 25; at < 29; ++at) attributes[at] = '\xff';
  refused_within(scratch.write("h.bgeo", attributes), 16);
}

TEST(AbsurdCounts, InVtkAreRefused) {
  const Scratch scratch;
  const std::string head = "# vtk DataFile Version 4.1\nt\nBINARY\nDATASET POLYDATA\nPOINTS ";
  const std::string one = std::string(12, '\0');
  for (const std::string count :
       {"99999999999", "18446744073709551615", "6148914691236517206", "-1", "99999999999999999999"}) {
    refused_within(scratch.write("f.vtk", head + count + " float\n" + one), 16);
    refused_within(scratch.write("g.vtk", head + "1 float\n" + one + "\nVERTICES 1 " + count + "\n"), 16);
    refused_within(
        scratch.write("h.vtk", head + "1 float\n" + one + "\nPOINT_DATA 1\nFIELD f 1\na " + count + " 1 bit\n"), 16);
    refused_within(
        scratch.write("i.vtk", head + "1 float\n" + one + "\nPOINT_DATA 1\nFIELD f 1\na 65536 " + count + " bit\n"),
        16);
    refused_within(
        scratch.write("j.vtk", head + "1 float\n" + one + "\nPOINT_DATA 1\nFIELD f 1\na 3 " + count + " string\n"), 16);
    refused_within(scratch.write("k.vtk", head + "1 float\n" + one + "\nPOINT_DATA 1\nFIELD f " + count + "\n"), 16);
  }
}

TEST(AbsurdCounts, InPlyAreRefused) {
  const Scratch scratch;
  const std::string xyz = "property float x\nproperty float y\nproperty float z\nend_header\n";
  for (const std::string form : {"ascii", "binary_little_endian"}) {
    const std::string head = "ply\nformat " + form + " 1.0\n";
    refused_within(scratch.write("a.ply", head + "element vertex 99999999999\n" + xyz), 16);
    refused_within(scratch.write("b.ply", head + "element e 99999999999\nproperty int a\nelement vertex 1\n" + xyz),
                   16);
    // Rows of no properties take no bytes: they must not take time either.
    refused_within(scratch.write("c.ply", head + "element e 9999999999999\nelement vertex 1\n" + xyz), 16);
    refused_within(
        scratch.write("d.ply", head + "element vertex 1\nproperty list uint int l\n" + xyz + "\xff\xff\xff\xff"), 16);
  }
}

TEST(AbsurdCounts, InHdf5AreRefused) {
  EXPECT_EQ(refused_within(sample("absurd.hdf5"), 16).code(), ErrorCode::malformed_file);
}

TEST(AbsurdCounts, InTextAreRefused) {
  const Scratch scratch;
  refused_within(scratch.write("f.xyz", "99999999999\n0 0 0\n"), 16);
}

/// Gzip of so many mebibytes of empty lines: one member over and over.
std::string lines_gzipped(int mebibytes) {
  const std::string member = gzipped(std::string(1 << 20, '\n'));
  std::string packed;
  for (int i = 0; i < mebibytes; ++i) packed += member;
  return packed;
}

TEST(GzipBomb, IsStoppedBeforeItFillsTheMemory) {
  const Scratch scratch;
  const std::string path = scratch.write("f.xyz.gz", gzipped("1 2 3\n") + lines_gzipped(400));
  EXPECT_EQ(refused_within(path, 300).code(), ErrorCode::limit_exceeded);
}

TEST(GzipBomb, BehindTheParticlesOfAFrameTakesNoMemory) {
  const Scratch scratch;
  const std::string path = scratch.write("f.bgeo", gzipped(small_bgeo()) + lines_gzipped(50));
  const std::uint64_t before = peak_rss_bytes();
  expect_small(read_particles(path));
  EXPECT_LT(peak_rss_bytes() - before, std::uint64_t{16} << 20);
}

}  // namespace
}  // namespace meniscus
