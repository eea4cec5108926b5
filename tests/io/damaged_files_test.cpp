// Whatever happens to a file: it is read, or refused with an error that names it; never anything else.
#include "small_frames.h"

namespace meniscus {
namespace {

enum class Outcome { read, refused };

Outcome outcome_of(const std::string& path) {
  try {
    const Particles particles = read_particles(path);
    EXPECT_EQ(particles.y.size(), particles.size());
    EXPECT_EQ(particles.z.size(), particles.size());
    for (const Attribute& attribute : particles.attributes) {
      EXPECT_EQ(attribute.values.size(), particles.size() * static_cast<std::size_t>(attribute.components));
    }
    return Outcome::read;
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
    return Outcome::refused;
  }
}

/// Reads every `step`th prefix. Those shorter than `least_whole` bytes must be refused.
void check_prefixes(const std::string& name, const std::string& bytes, std::size_t least_whole, std::size_t step = 1) {
  const Scratch scratch;
  ASSERT_EQ(outcome_of(scratch.write(name, bytes)), Outcome::read);
  for (std::size_t size = 0; size < bytes.size(); size += step) {
    const Outcome outcome = outcome_of(scratch.write(name, std::string_view(bytes).substr(0, size)));
    if (size < least_whole) {
      ASSERT_EQ(outcome, Outcome::refused) << name << ": " << size << " of " << bytes.size() << " bytes";
    }
  }
}

/// Reads copies with one byte changed.
void check_changed_bytes(const std::string& name, const std::string& bytes) {
  const Scratch scratch;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int change : {0x01, 0x80, 0xff}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(damaged[at] ^ change);
      outcome_of(scratch.write(name, damaged));
    }
  }
}

TEST(EveryPrefix, OfBgeoIsRefusedUntilItsPointsAreWhole) {
  const std::string bytes = small_bgeo();
  check_prefixes("f.bgeo", bytes, bytes.size() - 2);
  const std::string packed = gzipped(bytes);
  check_prefixes("f.bgeo.gz", packed, packed.size());
}

TEST(EveryPrefix, OfPlyIsRefusedUntilItsVerticesAreWhole) {
  for (const bool with_list : {false, true}) {
    const std::string bytes = small_ply(std::endian::big, with_list);
    check_prefixes("f.ply", bytes, bytes.size() - 13);
  }
  // A shorter last number is a number too, and what follows is a face.
  const std::string text = bytes_of_file(sample("mesh_ascii.ply"));
  check_prefixes("f.ply", text, text.find("36 240 15"));
}

TEST(EveryPrefix, OfVtkIsRefusedUntilItsPointsAreWhole) {
  for (const char* name : {"polydata_42_ascii.vtk", "polydata_51_binary.vtk", "grid_42_binary.vtk", "grid_51_ascii.vtk",
                           "grid_51_binary.vtk"}) {
    const std::string bytes = bytes_of_file(sample(name));
    const std::size_t cells = std::min(bytes.find("VERTICES"), bytes.find("CELLS"));
    check_prefixes("f.vtk", bytes, cells - 5);
  }
}

TEST(EveryPrefix, OfTextIsReadOrRefused) { check_prefixes("f.xyz", "# x y z rho\n1 2 3 4\n\n5.5 6.5 7.5e1 8\n", 0); }

TEST(EveryPrefix, OfHdf5IsRefused) {
  const std::string tiny = bytes_of_file(sample("tiny.hdf5"));
  check_prefixes("f.hdf5", tiny, tiny.size());
  const std::string pysph = bytes_of_file(sample("pysph.hdf5"));
  check_prefixes("f.hdf5", pysph, pysph.size(), 53);
}

TEST(EveryChangedByte, OfBgeoIsReadOrRefused) {
  check_changed_bytes("f.bgeo", small_bgeo());
  check_changed_bytes("f.bgeo", gzipped(small_bgeo()));
}

TEST(EveryChangedByte, OfCompressedBytesIsNoticedUnlessItChangesNothing) {
  // The checksum of gzip guards what the numbers alone would not tell. Some bits of a packed stream mean nothing.
  const Scratch scratch;
  const std::string bytes = gzipped(small_bgeo());
  int refused_count = 0;
  for (std::size_t at = 10; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const std::string path = scratch.write("f.bgeo", damaged);
    if (outcome_of(path) == Outcome::refused) {
      ++refused_count;
    } else {
      expect_small(read_particles(path));
    }
  }
  EXPECT_GT(refused_count, static_cast<int>(bytes.size()) * 9 / 10);
}

TEST(EveryChangedByte, OfPlyIsReadOrRefused) {
  check_changed_bytes("f.ply", small_ply(std::endian::little, true));
  check_changed_bytes("f.ply", bytes_of_file(sample("mesh_ascii.ply")));
}

TEST(EveryChangedByte, OfVtkIsReadOrRefused) {
  check_changed_bytes("f.vtk", bytes_of_file(sample("polydata_51_binary.vtk")));
  check_changed_bytes("f.vtk", bytes_of_file(sample("grid_42_ascii.vtk")));
}

TEST(EveryChangedByte, OfTextIsReadOrRefused) {
  check_changed_bytes("f.xyz", "# x y z rho\n1 2 3 4\n\n5.5 6.5 7.5e1 8\n");
}

TEST(Refusal, NamesWhatIsNoFrame) {
  const Scratch scratch;
  EXPECT_EQ(refused(scratch.path("absent.vtk")).code(), ErrorCode::not_found);
  EXPECT_EQ(refused(scratch.path("")).code(), ErrorCode::io_failed);
  EXPECT_EQ(refused("/dev/zero").code(), ErrorCode::io_failed);
  for (const char* name : {"f.bgeo", "f.vtk", "f.ply", "f.hdf5", "f.vtk.gz"}) {
    EXPECT_EQ(refused(scratch.write(name, "1 2 3\n")).code(), ErrorCode::malformed_file) << name;
    EXPECT_EQ(refused(scratch.write(name, "")).code(), ErrorCode::malformed_file) << name;
  }
  EXPECT_EQ(refused(scratch.write("body.obj", "v 1 2 3\n")).code(), ErrorCode::unsupported);
  EXPECT_EQ(refused(scratch.write("f.npz", "PK\x03\x04")).code(), ErrorCode::malformed_file);
  EXPECT_EQ(refused(scratch.write("f", std::string(100, '\x01'))).code(), ErrorCode::unsupported);
}

}  // namespace
}  // namespace meniscus
