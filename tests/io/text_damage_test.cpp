// Whatever happens to a table in text: it is read, or refused with an error that names it.
#include "small_frames.h"

namespace meniscus {
namespace {

const std::vector<std::pair<std::string, std::string>> kTables{
    {"f.csv", "x,y,z,rho,\"kind, of\"\r\n0.5,1,-2e1,1000,a\r\n1.5,2,3,,\"b\"\r\n2.5,3,4,1002,c\r\n"},
    {"g.csv", "TimeStep [s];Np\n0.5;3\nPos.x [m];Pos.y [m];Pos.z [m];Type;\n1;2;3;3;\n4;5;6;0;\n7;8;9;3;\n"},
    {"h.txt", "\xef\xbb\xbf# x y z id\n1 2 3 4\n\n# between\n5.5\t6.5 7.5e1 8\n9 10 11 12"},
    {"i.xyz", "3\nProperties=species:S:1:pos:R:3:id:I:1 Time=1\nO 1 2 3 4\nH 5 6 7 8\nH 9 10 11 12\n"},
    {"j.csv", "x\ty\tz\ta\r1\t2\t3\t\r4\t5\t6\t7\r"}};

/// The particles, or none where the file was refused, as it must be: with an error that names it.
std::optional<Particles> outcome_of(const std::string& path) {
  try {
    ReadOptions options;
    options.boundaries = true;  // which particles are fluid can be told only while none lacks its type
    Particles particles = read_particles(path, options);
    EXPECT_EQ(particles.y.size(), particles.size());
    EXPECT_EQ(particles.z.size(), particles.size());
    for (const Attribute& attribute : particles.attributes)
      EXPECT_EQ(attribute.values.size(), particles.size() * static_cast<std::size_t>(attribute.components));
    return particles;
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
    return std::nullopt;
  }
}

TEST(EveryPrefix, OfATableHasTheFirstRowsOfAllOrIsRefused) {
  const Scratch scratch;
  for (const auto& [name, text] : kTables) {
    const std::optional<Particles> all = outcome_of(scratch.write(name, text));
    ASSERT_TRUE(all) << name;
    for (std::size_t size = 0; size < text.size(); ++size) {
      const auto part = outcome_of(scratch.write(name, std::string_view(text).substr(0, size)));
      if (!part) continue;
      ASSERT_LE(part->size(), all->size()) << name << ": " << size << " bytes";
      // The last row may end in a number that has been cut.
      for (std::size_t i = 0; i + 1 < part->size(); ++i) EXPECT_EQ(part->position(i), all->position(i));
      const bool is_counted = text.find("Properties") != std::string::npos;
      if (is_counted && part->size() > 0) EXPECT_EQ(part->size(), all->size()) << size << " bytes";
    }
  }
}

TEST(EveryChangedByte, OfATableIsReadOrRefused) {
  const Scratch scratch;
  for (const auto& [name, text] : kTables) {
    for (std::size_t at = 0; at < text.size(); ++at) {
      for (const char c : {'\0', '\n', '\r', '"', ',', ';', '\t', '#', '-', '9', '\xff'}) {
        std::string damaged = text;
        damaged[at] = c;
        outcome_of(scratch.write(name, damaged));
      }
    }
  }
}

TEST(Extremes, InTheNumberOfRowsAreRefused) {
  const Scratch scratch;
  for (const std::string count : {"2", "2147483648", "9223372036854775808", "18446744073709551615"})
    EXPECT_FALSE(outcome_of(scratch.write("f.xyz", count + "\n1 2 3\n"))) << count;
  for (const std::string count : {"-1", "nan", "18446744073709551616", "1.5"})
    EXPECT_FALSE(outcome_of(scratch.write("f.xyz", count + "\n1 2 3\n"))) << count << " is no number of rows";
}

TEST(Extremes, OfNumbersAreInfiniteOrZero) {
  const Scratch scratch;
  const auto particles = outcome_of(
      scratch.write("f.csv", "x,y,z,a\n1e-999,2,3,1e999\n1e400,2,3,4\n2147483648,9223372036854775808,-0,5\n"));
  ASSERT_TRUE(particles);
  ASSERT_EQ(particles->size(), 2u);
  EXPECT_EQ(particles->dropped_non_finite, 1u);
  EXPECT_EQ(particles->position(0), vec3(0, 2, 3));
  EXPECT_EQ(particles->position(1), vec3(2147483648.0f, 9223372036854775808.0f, 0));
  EXPECT_TRUE(std::isinf(particles->find("a")->values[0]));
}

}  // namespace
}  // namespace meniscus
