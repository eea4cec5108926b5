#include "damage.h"
#include "io/frame_head.h"

namespace meniscus {
namespace {

/// The small frame as RealFlow writes it in one of its versions.
std::string small_realflow(int version, int count = kSmallCount) {
  ByteWriter out(std::endian::little);
  out.put<std::uint32_t>(0xfabada).text("Circle01" + std::string(242, '\0')).put(static_cast<std::int16_t>(version));
  out.put(1.0f).put<std::int32_t>(8).put(0.25f).put<std::int32_t>(6).put<std::int32_t>(24).put<std::int32_t>(count);
  out.put(0.1f).text(std::string(36, '\0'));
  if (version >= 7) out.text(std::string(36, '\0'));
  for (int i = 0; i < count; ++i) {
    for (int c = 0; c < 3; ++c) out.put(small_position(i)[c]);
    for (int c = 0; c < 3; ++c) out.put(small_velocity(i)[c]);
    out.text(std::string(12, '\0'));                    // force
    if (version >= 9) out.text(std::string(12, '\0'));  // vorticity
    if (version >= 3) out.text(std::string(12, '\0'));  // normal
    if (version >= 4) out.put<std::int32_t>(i + 1);
    if (version >= 5) out.text(std::string(12, '\0')).put<std::int16_t>(7);
    out.put(0.5f).put(0.0f).put(3.0f).put(1000.0f + static_cast<float>(i)).put(2.0f).put(1.0f).put(300.0f);
    if (version < 12) {
      out.put<std::int32_t>(10 * i);
    } else {
      out.put<std::int64_t>(10 * i);
    }
  }
  return out.put<std::int32_t>(0).put<std::uint8_t>(0).put<std::uint8_t>(1).put<std::int32_t>(0).bytes();
}
constexpr std::size_t kFooter = 10;

TEST(RealFlow, ReadsEveryVersion) {
  const Scratch scratch;
  for (int version = 1; version <= 15; ++version) {
    const Particles particles = read_particles(scratch.write("c_00006.bin", small_realflow(version)));
    EXPECT_EQ(particles.format, "realflow");
    expect_small(particles);
    EXPECT_EQ(particles.time, 0.25);
    EXPECT_EQ(particles.find("id")->values[6], 60.0f) << version;
    EXPECT_EQ(particles.find("temperature")->values[6], 300.0f) << version;
    if (version >= 4) {
      EXPECT_EQ(particles.find("neighbors")->values[6], 7.0f) << version;
    }
  }
  expect_small(read_particles(scratch.write("c_00006.bin.gz", gzipped(small_realflow(11)))));
}

TEST(RealFlow, OfAnUnknownVersionIsUnsupported) {
  const Scratch scratch;
  for (const int version : {0, -1, 16, 32767})
    EXPECT_EQ(refused(scratch.write("f.bin", small_realflow(version))).code(), ErrorCode::unsupported);
  EXPECT_EQ(refused(scratch.write("g.bin", std::string(1000, '\x01'))).code(), ErrorCode::unsupported);
}

TEST(RealFlow, OfNoParticlesIsAnEmptyFrame) {
  const Scratch scratch;
  EXPECT_TRUE(read_particles(scratch.write("f.bin", small_realflow(11, 0))).empty());
}

TEST(RealFlow, IsFoundInADirectoryUnlessItIsSomethingElse) {
  const Scratch scratch;
  for (const char* n : {"1", "2"}) {
    scratch.write(std::string("d/f_") + n + ".bin", small_realflow(11));
    scratch.write(std::string("d/rb_data_") + n + ".bin", std::string(90000, ' '));
  }
  const FrameSequence sequence = find_frames(std::vector<std::string>{scratch.path("d")});
  ASSERT_EQ(sequence.frames.size(), 2u);
  EXPECT_EQ(sequence.frames[0].path, scratch.path("d/f_1.bin"));
}

TEST(RealFlow, TellsItsParticlesFromItsStart) {
  const Scratch scratch;
  const io::FrameHead head = io::look_at_frame(scratch.write("f.bin", small_realflow(12)));
  EXPECT_TRUE(head.counted);
  EXPECT_EQ(head.particles, 7u);
}

TEST(RealFlowDamaged, EveryPrefixIsRefusedUntilTheParticlesAreWhole) {
  for (const int version : {2, 11, 12})
    check_prefixes("f.bin", small_realflow(version), small_realflow(version).size() - kFooter);
}

TEST(RealFlowDamaged, EveryChangedByteIsReadOrRefused) { check_changed_bytes("f.bin", small_realflow(9)); }

TEST(RealFlowDamaged, ImpossibleCountsAreRefused) {
  const Scratch scratch;
  for (const std::uint32_t count : {0xffffffffu, 0x80000000u, 0x7fffffffu, 0x7fc00000u, 8u}) {
    std::string bytes = small_realflow(11);
    bytes.replace(276, 4, ByteWriter(std::endian::little).put(count).bytes());
    refused_within(scratch.write("f.bin", bytes), 32);
    refused_within(scratch.write("f.bin.gz", gzipped(bytes)), 32);
  }
  // A time that is none.
  std::string bytes = small_realflow(11);
  bytes.replace(264, 4, ByteWriter(std::endian::little).put(std::nanf("")).bytes());
  EXPECT_FALSE(read_particles(scratch.write("f.bin", bytes)).time);
}

}  // namespace
}  // namespace meniscus
