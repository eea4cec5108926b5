#include "damage.h"

namespace meniscus {
namespace {

class NpyByNumpy : public testing::TestWithParam<const char*> {};

TEST_P(NpyByNumpy, IsReadInAnyTypeOrderAndVersion) {
  const Particles particles = read_particles(sample(GetParam()));
  EXPECT_EQ(particles.format, "npy");
  expect_small(particles, false);
}

INSTANTIATE_TEST_SUITE_P(Samples, NpyByNumpy,
                         testing::Values("double.npy", "fortran.npy", "half.npy", "version_2.npy", "version_3.npy",
                                         "structured.npy"),
                         [](const auto& info) {
                           const std::string name = info.param;
                           return name.substr(0, name.size() - 4);
                         });

TEST(Npy, OfStructuresKeepsItsFieldsAsAttributes) {
  const Particles particles = read_particles(sample("structured.npy"));
  expect_small(particles);
  EXPECT_EQ(particles.find("id")->values[6], 60.0f);
  EXPECT_EQ(particles.find("flag")->values, (std::vector<float>{0, 0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(particles.find("kind"), nullptr);
  ASSERT_EQ(particles.notes.size(), 1u);
  EXPECT_NE(particles.notes[0].find("'kind'"), std::string::npos);
}

TEST(Npy, OfDoublesFarFromTheOriginLosesNothing) {
  const std::string bytes = bytes_of_file(sample("double.npy"));
  std::string far = bytes;
  for (int i = 0; i < kSmallCount; ++i)
    for (int c = 0; c < 3; ++c) {
      const double value = 5e6 + static_cast<double>(small_position(i)[c]) + 1.0 / 1024;
      std::memcpy(far.data() + 128 + (3 * i + c) * 8, &value, 8);
    }
  const Scratch scratch;
  const Particles particles = read_particles(scratch.write("f.npy", far));
  ASSERT_EQ(particles.size(), 7u);
  for (int i = 0; i < kSmallCount; ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(particles.origin[c] + static_cast<double>(particles.position(static_cast<std::size_t>(i))[c]),
                5e6 + static_cast<double>(small_position(i)[c]) + 1.0 / 1024);
}

/// A header as NumPy writes it, and values behind it.
std::string npy_of(const std::string& descr, const std::string& shape, std::size_t bytes) {
  std::string header = "{'descr': " + descr + ", 'fortran_order': False, 'shape': " + shape + ", }\n";
  ByteWriter out(std::endian::little);
  out.text("\x93NUMPY").put<std::uint8_t>(1).put<std::uint8_t>(0).put(static_cast<std::uint16_t>(header.size()));
  return out.bytes() + header + std::string(bytes, '\0');
}

TEST(Npy, OfMoreColumnsTakesThreeAndSaysSo) {
  const Scratch scratch;
  const Particles particles = read_particles(scratch.write("f.npy", npy_of("'<f4'", "(5, 6)", 120)));
  EXPECT_EQ(particles.size(), 5u);
  ASSERT_EQ(particles.notes.size(), 1u);
  EXPECT_NE(particles.notes[0].find("first 3 of 6"), std::string::npos);
}

TEST(Npy, WithoutParticlesIsAnEmptyFrame) {
  const Scratch scratch;
  EXPECT_TRUE(read_particles(scratch.write("f.npy", npy_of("'<f4'", "(0, 3)", 0))).empty());
  EXPECT_TRUE(read_particles(scratch.write("g.npy", npy_of("'<f4'", "(0L, 3L)", 0))).empty());
}

TEST(Npy, OfFewerRowsThanTheFileHoldsIsMalformed) {
  const Scratch scratch;
  for (const char* shape : {"(4, 3)", "(0, 3)"}) {
    const Error error = refused(scratch.write("f.npy", npy_of("'<f4'", shape, 60)));
    EXPECT_EQ(error.code(), ErrorCode::malformed_file);
    EXPECT_TRUE(error.detail().byte_offset.has_value());
  }
}

TEST(Npy, OfOtherShapesOrTypesSaysWhatItFound) {
  const Scratch scratch;
  struct Case {
    std::string descr, shape;
    std::size_t bytes;
  };
  for (const auto& [descr, shape, bytes] : std::vector<Case>{{"'<f4'", "(7, 2)", 56},
                                                             {"'<f4'", "(21,)", 84},
                                                             {"'<f4'", "(7, 3, 1)", 84},
                                                             {"'<f4'", "()", 4},
                                                             {"'<c8'", "(7, 3)", 168},
                                                             {"'<U3'", "(7, 3)", 252},
                                                             {"'|V4'", "(7, 3)", 84},
                                                             {"'<f16'", "(7, 3)", 336},
                                                             {"[('a', '<f4')]", "(7,)", 28},
                                                             {"[('x', '<f4', (2, 2))]", "(7,)", 112},
                                                             {"[('p', [('x', '<f4')], (3,))]", "(7,)", 84}}) {
    const Error error = refused(scratch.write("f.npy", npy_of(descr, shape, bytes)));
    EXPECT_EQ(error.code(), ErrorCode::unsupported) << descr << shape;
    EXPECT_FALSE(error.detail().found.empty());
  }
}

TEST(Npy, NamesTheFieldsThatOptionsAskFor) {
  const Scratch scratch;
  const std::string path =
      scratch.write("f.npy", npy_of("[('a', '<f8'), ('b', '<f8'), ('c', '<f4'), ('w', '<f4', (3,))]", "(9,)", 9 * 32));
  ReadOptions options;
  options.positions = "a, b ,c";
  EXPECT_EQ(read_particles(path, options).size(), 9u);
  options.positions = "w";
  const Particles particles = read_particles(path, options);
  EXPECT_EQ(particles.attributes.size(), 3u);
  options.positions = "a,b,d";
  try {
    read_particles(path, options);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_NE(error.detail().found.find("w (9 x 3 float32)"), std::string::npos) << error.what();
  }
  for (const char* names : {"a", "a,b", "a,b,w", "a,b,c,a", ","}) {
    options.positions = names;
    EXPECT_EQ(outcome_of(path, options), Outcome::refused) << names;
  }
}

TEST(Npy, OfPickledObjectsIsRefusedWithAdvice) {
  const Error error = refused(sample("object.npy"));
  EXPECT_EQ(error.code(), ErrorCode::unsupported);
  EXPECT_NE(error.detail().advice.find("numpy.savez"), std::string::npos);
}

TEST(Npy, OfEveryPrefixIsRefused) {
  for (const char* name : {"double.npy", "fortran.npy", "structured.npy", "version_3.npy"}) {
    const std::string bytes = bytes_of_file(sample(name));
    check_prefixes("f.npy", bytes, bytes.size());
  }
}

TEST(Npy, OfEveryChangedByteIsReadOrRefused) {
  for (const char* name : {"half.npy", "structured.npy", "version_2.npy"})
    check_changed_bytes("f.npy", bytes_of_file(sample(name)));
}

TEST(Npy, OfAbsurdHeadersIsRefused) {
  const Scratch scratch;
  const char* const lengths[] = {
      "-1",  "2147483648", "4294967296", "9223372036854775808", "18446744073709551615", "99999999999999999999",
      "nan", "1e9",        "None"};
  for (const std::string length : lengths) {
    refused_within(scratch.write("a.npy", npy_of("'<f4'", "(" + length + ", 3)", 84)), 16);
    refused_within(scratch.write("b.npy", npy_of("'<f4'", "(7, " + length + ")", 84)), 16);
    refused_within(scratch.write("c.npy", npy_of("'<f4'", "(" + length + ", " + length + ", 3)", 84)), 16);
    refused_within(scratch.write("d.npy", npy_of("'<f" + length + "'", "(7, 3)", 84)), 16);
    refused_within(scratch.write("e.npy", npy_of("[('x', '<f4', (" + length + ",))]", "(7,)", 84)), 16);
    refused_within(scratch.write("f.npy", npy_of("'|V0'", "(" + length + ",)", 84)), 16);
    refused_within(scratch.write("g.npy", npy_of("[('p', '<f4', (0, " + length + "))]", "(7,)", 84)), 16);
    refused_within(scratch.write("h.npy", npy_of("'<f4'", "(" + length + ", 0)", 84)), 16);
  }
  refused_within(scratch.write("i.npy", npy_of("'<f4'", std::string(60000, '('), 0)), 16);
  refused_within(scratch.write("j.npy", npy_of("[" + std::string(30000, '['), "(7,)", 0)), 16);
  std::string wide = npy_of("'<f4'", "(7, 3)", 84);
  wide[6] = 2;  // the length of the header takes 32 bits: 0x7b....
  refused_within(scratch.write("k.npy", wide), 16);
  wide[6] = 4;
  EXPECT_EQ(refused(scratch.write("l.npy", wide)).code(), ErrorCode::unsupported);
  // No numbers of the size of nothing: a count of them is worth nothing.
  refused_within(scratch.write("m.npy", npy_of("[]", "(9223372036854775807,)", 0)), 16);
}

}  // namespace
}  // namespace meniscus
