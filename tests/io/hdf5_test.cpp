#include <cmath>

#include "damage.h"

#ifdef MENISCUS_SANITIZED
/// The library loses memory over files that it finds to be damaged.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }
#endif

namespace meniscus {
namespace {

TEST(Hdf5, ReadsTheFluidOfPysphWithItsArrays) {
  const Particles particles = read_particles(sample("pysph.hdf5"));
  EXPECT_EQ(particles.format, "hdf5");
  expect_small(particles);
  EXPECT_EQ(particles.time, 0.375);
  EXPECT_EQ(particles.find("gid")->values[6], 60.0f);
  EXPECT_EQ(particles.find("tag")->values[6], 0.0f);
  // An array of two values a particle, one that is not stored, and one of another length.
  ASSERT_NE(particles.find("gradient"), nullptr);
  EXPECT_EQ(particles.find("gradient")->components, 2);
  EXPECT_EQ(particles.find("au"), nullptr);
  EXPECT_EQ(particles.find("spare"), nullptr);
}

TEST(Hdf5, SaysWhichGroupWasReadAndWhichWereNot) {
  const Particles particles = read_particles(sample("pysph.hdf5"));
  ASSERT_FALSE(particles.notes.empty());
  const std::string& note = particles.notes.back();
  for (const char* name : {"'fluid' (7", "'boundary' (3", "'zz_inlet' (5"}) {
    EXPECT_NE(note.find(name), std::string::npos) << note;
  }
}

TEST(Hdf5, KnowsTheSpacingFromMassAndDensity) {
  // m = 1000/64 and a median density of 1003: a cube of edge (15.625 / 1003)^(1/3).
  const Particles particles = read_particles(sample("pysph.hdf5"));
  ASSERT_TRUE(particles.spacing.has_value());
  EXPECT_NEAR(*particles.spacing, 0.25f * std::cbrt(1000.0f / 1003.0f), 1e-6f);
  EXPECT_FALSE(read_particles(sample("tiny.hdf5")).spacing.has_value());
}

TEST(Hdf5, TakesObstaclesLastAndReadsCompressedBigEndianArrays) {
  const Particles particles = read_particles(sample("pysph_gzip.hdf5"));
  ASSERT_EQ(particles.size(), 4u);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(particles.position(static_cast<std::size_t>(i)), small_position(i));
  EXPECT_EQ(particles.time, 0.375);
}

TEST(Hdf5, ReadsBoundariesWhereTheyAreAskedFor) {
  ReadOptions options;
  options.boundaries = true;
  const Particles particles = read_particles(sample("pysph.hdf5"), options);
  ASSERT_EQ(particles.size(), 10u);
  EXPECT_EQ(particles.position(6), small_position(6));
  EXPECT_EQ(particles.position(8), small_position(1) - 5.0f);
  ASSERT_NE(particles.find("density"), nullptr);
  EXPECT_EQ(particles.find("density")->values[8], 1001.0f);
  EXPECT_EQ(particles.find("gid"), nullptr) << "boundaries have none";
}

TEST(Hdf5, ReadsSnapshotsOfGadgetAndSwift) {
  const Particles particles = read_particles(sample("gadget.hdf5"));
  expect_small(particles, false);
  EXPECT_EQ(particles.time, 0.375);
  ASSERT_NE(particles.find("velocity"), nullptr);
  EXPECT_EQ(particles.find("velocity")->values[4], -1.0f);
  ASSERT_NE(particles.find("density"), nullptr);
  EXPECT_EQ(particles.find("ParticleIDs")->values[6], 60.0f);
  std::string notes;
  for (const std::string& note : particles.notes) notes += note;
  EXPECT_NE(notes.find("one of 4 of a snapshot"), std::string::npos) << notes;
  EXPECT_NE(notes.find("'PartType1' (3)"), std::string::npos) << notes;
}

TEST(Hdf5, ReadsTheArraysThatOptionsName) {
  ReadOptions options;
  for (const char* names : {"/PartType1/Coordinates", "PartType1/Coordinates"}) {
    options.positions = names;
    const Particles particles = read_particles(sample("gadget.hdf5"), options);
    ASSERT_EQ(particles.size(), 3u) << names;
    EXPECT_EQ(particles.position(1), small_position(1) - 9.0f);
  }
  for (const char* names : {"/odd/a,/odd/b,/odd/c", "/odd/a,b,c"}) {
    options.positions = names;
    expect_small(read_particles(sample("plain.hdf5"), options), false);
  }
  for (const char* names : {"/odd/a,/odd/b", "/odd/a", "/odd/a,b,nothing", "/odd/a,/root", "/nothing", "", "/", ",,"}) {
    if (*names == '\0') continue;
    options.positions = names;
    try {
      read_particles(sample("plain.hdf5"), options);
      ADD_FAILURE() << names;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << error.what();
    }
  }
}

TEST(Hdf5, ReadsPlainArraysOfAnyTypeAndOrderByTheirNames) {
  const Particles particles = read_particles(sample("plain.hdf5"));
  expect_small(particles);
  EXPECT_EQ(particles.find("half")->values[3], 3.0f);
  EXPECT_EQ(particles.find("words"), nullptr);
}

TEST(Hdf5, FollowsLinksInsideTheFileOnly) {
  const Particles particles = read_particles(sample("links.hdf5"));
  expect_small(particles, false);
  EXPECT_EQ(particles.find("outside"), nullptr);
  ReadOptions options;
  for (const char* name : {"/outside_positions", "/through/Coordinates", "/through2", "/stored_outside"}) {
    options.positions = name;
    EXPECT_EQ(outcome_of(sample("links.hdf5"), options), Outcome::refused) << name;
  }
}

TEST(Hdf5, OfAnotherLayoutSaysWhichArraysThereAre) {
  const Error error = refused(sample("other.hdf5"));
  EXPECT_EQ(error.code(), ErrorCode::unsupported);
  EXPECT_NE(error.detail().found.find("/field/pressure (4 x 5 float64)"), std::string::npos) << error.what();
  EXPECT_NE(error.detail().advice.find("--positions"), std::string::npos);
  const Scratch scratch;
  EXPECT_EQ(refused(scratch.write("f.hdf5.gz", gzipped(bytes_of_file(sample("tiny.hdf5"))))).code(),
            ErrorCode::unsupported);
}

TEST(Hdf5, OfAnyPrefixIsRefused) {
  const std::string gadget = bytes_of_file(sample("gadget.hdf5"));
  check_prefixes("f.hdf5", gadget, gadget.size(), 41);
}

TEST(Hdf5, OfChangedBytesIsReadOrRefused) {
  // The library itself crashes on some of these.
  const Scratch scratch;
  int refusals = 0, read = 0;
  for (const char* name : {"pysph_gzip.hdf5", "tiny.hdf5"}) {
    const std::string whole = bytes_of_file(sample(name));
    for (std::size_t at = 5; at < whole.size(); at += 1 + whole.size() / 300)
      for (const char value : {'\x00', '\xff'}) {
        std::string changed = whole;
        changed[at] = value;
        try {
          read += read_particles(scratch.write("f.hdf5", changed)).empty() ? 0 : 1;
        } catch (const Error& error) {
          EXPECT_FALSE(error.detail().path.empty());
          ++refusals;
        }
      }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refusals, 50);
}

TEST(Hdf5, ThatCrashesTheLibraryBehindAnArrayOfTextsIsRefused) {
  const Error error = refused(sample("damaged.hdf5"));
  EXPECT_EQ(error.code(), ErrorCode::malformed_file);
  EXPECT_NE(error.detail().problem.find("damaged"), std::string::npos) << error.what();
}

TEST(Hdf5, OfGroupsInCirclesIsRead) { expect_small(read_particles(sample("circle.hdf5")), false); }

TEST(Hdf5, IsToldFromItsContentUnderAnyName) {
  const Scratch scratch;
  expect_small(read_particles(scratch.write("f.txt", bytes_of_file(sample("tiny.hdf5")))), false);
  EXPECT_EQ(refused(scratch.write("f.hdf5", "1 2 3\n")).code(), ErrorCode::malformed_file);
}

TEST(Hdf5, ReadsTheWholeExampleSequence) {
  const std::string directory[] = {std::string(MENISCUS_SOURCE_DIR) + "/data/dam_break_3d"};
  const FrameSequence sequence = find_frames(directory);
  ASSERT_EQ(sequence.frames.size(), 58u);
  EXPECT_TRUE(sequence.notes.empty());
  double time = -1;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    EXPECT_EQ(sequence.frames[i].number, static_cast<std::int64_t>(90 * i));
    const Particles particles = read_particles(sequence.frames[i].path);
    EXPECT_EQ(particles.size(), 42042u);
    ASSERT_TRUE(particles.time.has_value());
    EXPECT_GT(*particles.time, time);
    time = *particles.time;
    ASSERT_NE(particles.find("velocity"), nullptr);
    // Inside the tank, whose walls give way a little.
    const Bounds bounds = particles.bounds();
    EXPECT_GT(bounds.low.x, 0.0f);
    EXPECT_LT(bounds.high.x, 3.23f);
    EXPECT_GT(bounds.low.y, -0.5f);
    EXPECT_LT(bounds.high.y, 0.5f);
    EXPECT_GT(bounds.low.z, 0.0f);
    EXPECT_LT(bounds.high.z, 1.2f);
  }
  EXPECT_NEAR(time, 1.41, 0.01);
}

}  // namespace
}  // namespace meniscus
