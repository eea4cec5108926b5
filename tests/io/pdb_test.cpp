#include "damage.h"
#include "io/frame_head.h"

namespace meniscus {
namespace {

/// A channel of a PDB file, with pointers of 32 or 64 bits.
class PdbWriter {
 public:
  PdbWriter(bool wide, std::endian order, std::uint32_t count, std::uint32_t channels) : wide_(wide), out_(order) {
    out_.put<std::uint32_t>(670).put<std::uint16_t>(1).put<std::uint16_t>(0xf3f3).put(1.0f).put(0.5f);
    out_.put(count).put(channels).text(std::string(32, '\0'));
    pointer();
    count_ = count;
  }
  ByteWriter& channel(const std::string& name, std::uint32_t type, std::uint32_t bytes) {
    out_.put<std::uint16_t>(0xf663).put<std::uint16_t>(1).put<std::uint16_t>(0);
    pointer();
    out_.put(type).put<std::uint32_t>(0).put<std::uint32_t>(0).put(count_ - 1).put<std::uint32_t>(0);
    if (wide_) out_.put<std::uint32_t>(0);
    for (int i = 0; i < 3; ++i) pointer();
    out_.text(name + '\0').put(type).put(bytes).put(count_).put<std::uint32_t>(1);
    pointer();
    return out_;
  }
  const std::string& result() const { return out_.bytes(); }

 private:
  void pointer() {
    out_.put<std::uint32_t>(0);
    if (wide_) out_.put<std::uint32_t>(0);
  }
  bool wide_;
  ByteWriter out_;
  std::uint32_t count_ = 0;
};

/// The small frame: a channel that is not read between, the positions not first.
std::string small_pdb(bool wide, std::endian order = std::endian::little, std::uint32_t count = kSmallCount) {
  PdbWriter file(wide, order, count, 5);
  const int rows = static_cast<int>(count);
  ByteWriter& out = file.channel("id", 3, 4);
  for (int i = 0; i < rows; ++i) out.put<std::int32_t>(10 * i);
  file.channel("position", 1, 12);
  for (int i = 0; i < rows; ++i)
    for (int c = 0; c < 3; ++c) out.put(small_position(i)[c]);
  file.channel("mark", 4, 4).text(std::string(4 * count, 'x'));
  file.channel("velocity", 1, 12);
  for (int i = 0; i < rows; ++i)
    for (int c = 0; c < 3; ++c) out.put(small_velocity(i)[c]);
  file.channel("density", 2, 4);
  for (int i = 0; i < rows; ++i) out.put(1000.0f + static_cast<float>(i));
  return file.result();
}

TEST(Pdb, ReadsPointersOf32And64BitsOfBothByteOrders) {
  const Scratch scratch;
  for (const bool wide : {false, true})
    for (const std::endian order : {std::endian::little, std::endian::big})
      for (const bool packed : {false, true}) {
        const std::string bytes = small_pdb(wide, order);
        const Particles particles = read_particles(scratch.write("f.pdb", packed ? gzipped(bytes) : bytes));
        EXPECT_EQ(particles.format, "pdb");
        expect_small(particles);
        EXPECT_EQ(particles.attributes.size(), 3u);
        EXPECT_EQ(particles.find("id")->values[6], 60.0f);
        ASSERT_EQ(particles.notes.size(), 1u);
        EXPECT_NE(particles.notes[0].find("'mark'"), std::string::npos);
      }
}

TEST(Pdb, OfNoParticlesIsAnEmptyFrame) {
  const Scratch scratch;
  for (const bool wide : {false, true})
    EXPECT_TRUE(read_particles(scratch.write("f.pdb", small_pdb(wide, std::endian::little, 0))).empty());
  EXPECT_TRUE(read_particles(scratch.write("g.pdb", PdbWriter(false, std::endian::little, 0, 0).result())).empty());
}

TEST(Pdb, TellsItsParticlesFromItsStart) {
  const Scratch scratch;
  const io::FrameHead head = io::look_at_frame(scratch.write("f.pdb", small_pdb(true)));
  EXPECT_TRUE(head.counted);
  EXPECT_EQ(head.particles, 7u);
}

TEST(Pdb, IsFoundInADirectoryUnlessItIsSomethingElse) {
  const Scratch scratch;
  for (const char* n : {"1", "2"}) {
    scratch.write(std::string("d/f_") + n + ".pdb", small_pdb(false));
    scratch.write(std::string("d/protein_") + n + ".pdb", "HEADER    OXYGEN TRANSPORT" + std::string(9000, ' '));
  }
  EXPECT_EQ(find_frames(std::vector<std::string>{scratch.path("d")}).frames.size(), 2u);
  EXPECT_EQ(refused(scratch.path("d/protein_1.pdb")).code(), ErrorCode::malformed_file);
}

TEST(PdbDamaged, EveryPrefixIsRefused) {
  for (const bool wide : {false, true}) check_prefixes("f.pdb", small_pdb(wide), small_pdb(wide).size());
}

TEST(PdbDamaged, EveryChangedByteIsReadOrRefused) {
  for (const bool wide : {false, true})
    for (const std::endian order : {std::endian::little, std::endian::big})
      check_changed_bytes("f.pdb", small_pdb(wide, order));
}

TEST(Pdb, LeavesOutCharactersOfAByteEachWithANote) {
  const Scratch scratch;
  PdbWriter file(false, std::endian::little, 5, 2);
  file.channel("position", 1, 12).text(std::string(60, '\0'));
  file.channel("tag", 0, 1).text("abcde");
  const Particles particles = read_particles(scratch.write("f.pdb", file.result()));
  EXPECT_EQ(particles.size(), 5u);
  ASSERT_EQ(particles.notes.size(), 1u);
  EXPECT_NE(particles.notes[0].find("'tag'"), std::string::npos);
}

TEST(PdbDamaged, BytesBehindTheEndAreRefused) {
  const Scratch scratch;
  for (const bool wide : {false, true}) {
    const std::string good = small_pdb(wide);
    EXPECT_EQ(refused(scratch.write("f.pdb", good + "xxxx")).code(), ErrorCode::malformed_file);
    for (const char count : {'\0', '\3'}) {
      std::string bytes = good;
      bytes[16] = count;
      EXPECT_EQ(refused(scratch.write("f.pdb", bytes)).code(), ErrorCode::malformed_file);
    }
  }
}

TEST(PdbDamaged, ExtremesAreRefusedWhereTheyMatter) {
  const Scratch scratch;
  for (const bool wide : {false, true}) {
    const std::string good = small_pdb(wide);
    const std::size_t type = good.find(std::string("position\0", 9)) + 9;
    for (const std::uint32_t extreme : {0xffffffffu, 0x80000000u, 0x7fffffffu, 0x7fc00000u, 0x10000000u, 8u}) {
      const std::string value = ByteWriter(std::endian::little).put(extreme).bytes();
      for (const std::size_t at : {std::size_t{0}, std::size_t{16}, std::size_t{20}, type, type + 4}) {
        std::string bytes = good;
        refused_within(scratch.write("f.pdb", bytes.replace(at, 4, value)), 32);
      }
    }
  }
  EXPECT_EQ(refused(scratch.write("f.pdb", replaced(small_pdb(false), "position", "somewher"))).code(),
            ErrorCode::unsupported);
}

}  // namespace
}  // namespace meniscus
