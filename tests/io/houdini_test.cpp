#include "houdini_frames.h"

#include "damage.h"
#include "io/frame_head.h"

namespace meniscus {
namespace {

/// A file of one attribute P with the words that `values` writes, and `count` points.
template <class Values>
std::string with_positions(HoudiniForm form, std::int64_t count, Values values) {
  HoudiniWriter out(form);
  out.begin().word("pointcount").whole(count).word("attributes").begin().word("pointattributes").begin();
  out.attribute("P").word("values").begin();
  values(out);
  out.end().end().end().end().end().end();
  return out.result();
}

bool has_note(const Particles& particles, const std::string& text) {
  return std::any_of(particles.notes.begin(), particles.notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

TEST(Houdini, ReadsPagesTuplesArraysAndTextsInEveryForm) {
  const Scratch scratch;
  for (const HoudiniForm form : kHoudiniForms) {
    const Particles particles = read_particles(scratch.write(houdini_name(form), small_houdini(form)));
    EXPECT_EQ(particles.format, "houdini");
    expect_small(particles);
    EXPECT_EQ(particles.attributes.size(), 4u);
    ASSERT_NE(particles.find("id"), nullptr);
    EXPECT_EQ(particles.find("id")->values[6], 60.0f);
    ASSERT_NE(particles.find("kind"), nullptr);
    EXPECT_EQ(particles.find("kind")->values, (std::vector<float>{1, 1, 1, 1, 0, 1, 0}));
    EXPECT_TRUE(has_note(particles, "'kind' gives its texts as numbers: 0 'water', 1 'oil'"));
    EXPECT_TRUE(has_note(particles, "'near' is of type 'arraydata'"));
    EXPECT_TRUE(has_note(particles, "2 primitives"));
  }
}

TEST(Houdini, IsTheSameCompressedAndUnderAnyName) {
  const Scratch scratch;
  for (const HoudiniForm form : kHoudiniForms)
    for (const char* name : {"f.bgeo.gz", "f.geo.gz", "nameless"})
      expect_small(read_particles(scratch.write(name, gzipped(small_houdini(form)))));
}

TEST(Houdini, WithLineEndsOfDosAMarkAndMapsForListsIsRead) {
  const Scratch scratch;
  std::string text = small_houdini(HoudiniForm::text);
  for (std::size_t at = text.find(','); at != std::string::npos; at = text.find(',', at + 1))
    text.insert(at + 1, "\r\n\t");
  expect_small(read_particles(scratch.write("f.geo", "\xef\xbb\xbf\r\n" + text)));
  const std::string map =
      "{\"pointcount\": 1, \"attributes\": {\"pointattributes\": [[{\"type\": \"numeric\", \"name\": \"P\"}, "
      "{\"values\": {\"size\": 3, \"tuples\": [[1, 2, 3]]}}]]}}";
  EXPECT_EQ(read_particles(scratch.write("g.geo", map)).position(0), vec3(1, 2, 3));
}

TEST(Houdini, OfNoPointsIsAnEmptyFrame) {
  const Scratch scratch;
  for (const HoudiniForm form : kHoudiniForms)
    EXPECT_TRUE(read_particles(scratch.write(houdini_name(form), small_houdini(form, 0))).empty());
  EXPECT_TRUE(read_particles(scratch.write("f.geo", "[\"pointcount\", 0]")).empty());
}

TEST(Houdini, TakesPartsOfAPositionFromTheirOwnPages) {
  // As Houdini 12 writes it: x, y, z vary and the fourth, a weight, is constant in each page of two.
  const Scratch scratch;
  for (const HoudiniForm form : kHoudiniForms) {
    const std::string bytes = with_positions(form, 3, [](HoudiniWriter& out) {
      out.word("size").whole(4).word("packing").begin().whole(3).whole(1).end().word("pagesize").whole(2);
      out.word("constantpageflags").begin().bits({false, false}).bits({true, true}).end();
      out.word("rawpagedata").run(std::vector<float>{1, 2, 3, 4, 5, 6, 1, 7, 8, 9, 1});
    });
    const Particles particles = read_particles(scratch.write(houdini_name(form), bytes));
    ASSERT_EQ(particles.size(), 3u);
    EXPECT_EQ(particles.position(1), vec3(4, 5, 6));
    EXPECT_EQ(particles.position(2), vec3(7, 8, 9));
  }
}

TEST(Houdini, ReadsComponentsInArraysOfTheirOwnAndDoubles) {
  const Scratch scratch;
  for (const HoudiniForm form : kHoudiniForms) {
    const std::string bytes = with_positions(form, 2, [](HoudiniWriter& out) {
      out.word("size").whole(3).word("arrays").begin().run(std::vector<double>{500000.001, 500000.002});
      out.run(std::vector<double>{1, 2}).run(std::vector<double>{3, 4}).end();
    });
    const Particles particles = read_particles(scratch.write(houdini_name(form), bytes));
    ASSERT_EQ(particles.size(), 2u);
    EXPECT_NEAR(static_cast<double>(particles.x[1]) + particles.origin.x, 500000.002, 1e-7);
    EXPECT_EQ(particles.z[1], 4.0f);
  }
}

TEST(Houdini, ReadsNumbersOf16BitsAndLongLists) {
  const Scratch scratch;
  constexpr int kMany = 300;  // more than a length of one byte counts
  const std::string bytes = with_positions(HoudiniForm::little, kMany, [](HoudiniWriter& out) {
    out.word("size").whole(3).word("pagesize").whole(1024).word("rawpagedata").bytes("\x40\x18").length(3 * kMany);
    for (int i = 0; i < 3 * kMany; ++i) out.bytes(std::string_view(i % 2 == 0 ? "\x00\x3c" : "\x00\xc0", 2));
  });
  const Particles particles = read_particles(scratch.write("f.bgeo", bytes));
  ASSERT_EQ(particles.size(), static_cast<std::size_t>(kMany));
  EXPECT_EQ(particles.position(kMany - 2), vec3(1, -2, 1));
}

TEST(Houdini, ScalesAndLeavesOutWhatIsNotFinite) {
  const Scratch scratch;
  const std::string bytes = with_positions(HoudiniForm::text, 2, [](HoudiniWriter& out) {
    out.word("size").whole(3).word("tuples").bytes(",[[1,2,3],[nan,0,0]]");
  });
  ReadOptions options;
  options.scale = 2;
  const Particles particles = read_particles(scratch.write("f.geo", bytes), options);
  ASSERT_EQ(particles.size(), 1u);
  EXPECT_EQ(particles.dropped_non_finite, 1u);
  EXPECT_EQ(particles.position(0), vec3(2, 4, 6));
}

TEST(Houdini, TellsItsPointsFromItsStart) {
  const Scratch scratch;
  for (const HoudiniForm form : kHoudiniForms) {
    const io::FrameHead head = io::look_at_frame(scratch.write(houdini_name(form), small_houdini(form)));
    EXPECT_TRUE(head.counted);
    EXPECT_EQ(head.particles, 7u);
    EXPECT_EQ(head.text, form == HoudiniForm::text);
  }
  // A long list before the number: judged from the size of the file.
  const std::string late = "[\"fileversion\", \"" + std::string(1 << 17, 'a') + "\", \"pointcount\", 0]";
  EXPECT_FALSE(io::look_at_frame(scratch.write("late.geo", late)).counted);
  EXPECT_TRUE(read_particles(scratch.path("late.geo")).empty());
}

TEST(Houdini, CompressedByBloscIsRefusedWithAdvice) {
  const Scratch scratch;
  const Error error = refused(scratch.write("f.bgeo.sc", "scf1" + std::string(20, '\x01')));
  EXPECT_EQ(error.code(), ErrorCode::unsupported);
  EXPECT_NE(error.detail().advice.find("gconvert"), std::string::npos);
}

TEST(HoudiniDamaged, UnevenTuplesAreRefused) {
  const Scratch scratch;
  const auto tuples = [&](const char* text) {
    return scratch.write("f.geo", with_positions(HoudiniForm::text, 5, [&](HoudiniWriter& out) {
                           out.word("size").whole(3).word("tuples").bytes(text);
                         }));
  };
  EXPECT_EQ(read_particles(tuples(",[[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,1]]")).size(), 5u);
  for (const char* uneven : {",[[0,0],[0,1,0,0],[0,1,0,0,0,1,1,1,1]]", ",[0,[0,0,1],0,0,[0,1,0],0,0,0,1,1,1,1]"})
    EXPECT_EQ(refused(tuples(uneven)).code(), ErrorCode::malformed_file);
  for (const HoudiniForm form : {HoudiniForm::little, HoudiniForm::big}) {
    const std::string bytes = with_positions(form, 2, [](HoudiniWriter& out) {
      out.word("size").whole(3).word("tuples").begin().run(std::vector<float>{1, 2});
      out.run(std::vector<float>{3, 4, 5, 6}).end();
    });
    EXPECT_EQ(refused(scratch.write("f.bgeo", bytes)).code(), ErrorCode::malformed_file);
  }
}

TEST(Houdini, TakesMarksOfPagesOf32Bits) {
  const Scratch scratch;
  for (const HoudiniForm form : kHoudiniForms) {
    const std::string bytes = with_positions(form, 3, [](HoudiniWriter& out) {
      out.word("size").whole(3).word("packing").begin().whole(3).end().word("pagesize").whole(2);
      out.word("constantpageflags").begin().run(std::vector<std::int32_t>{1, 0}).end();
      out.word("rawpagedata").run(std::vector<float>{1, 2, 3, 7, 8, 9});
    });
    const Particles particles = read_particles(scratch.write(houdini_name(form), bytes));
    ASSERT_EQ(particles.size(), 3u);
    EXPECT_EQ(particles.position(1), vec3(1, 2, 3));
    EXPECT_EQ(particles.position(2), vec3(7, 8, 9));
  }
}

TEST(HoudiniDamaged, EveryPrefixIsRefused) {
  for (const HoudiniForm form : kHoudiniForms) {
    const std::string bytes = small_houdini(form);
    check_prefixes(houdini_name(form), bytes, bytes.size());
  }
}

TEST(HoudiniDamaged, EveryChangedByteIsReadOrRefused) {
  for (const HoudiniForm form : kHoudiniForms) check_changed_bytes(houdini_name(form), small_houdini(form));
}

TEST(HoudiniDamaged, BytesBehindTheEndAreNotRead) {
  const Scratch scratch;
  for (const HoudiniForm form : kHoudiniForms)
    expect_small(read_particles(scratch.write(houdini_name(form), small_houdini(form) + std::string(1000, '\x7f'))));
}

TEST(HoudiniDamaged, ImpossibleCountsAreRefused) {
  const Scratch scratch;
  for (const char* count : {"-1", "2147483648", "9223372036854775808", "18446744073709551616", "nan", "inf", "1e300",
                            "7.5", "\"7\"", "[7]", "null", "true", "8", "6"})
    refused_within(scratch.write("f.geo", replaced(small_houdini(HoudiniForm::text), "\"pointcount\",7",
                                                   std::string("\"pointcount\",") + count)),
                   32);
  const auto one = [](HoudiniWriter& out) {
    out.word("size").whole(3).word("rawpagedata").run(std::vector<float>{1, 2, 3});
  };
  for (const std::int64_t count :
       {std::int64_t{-1}, std::int64_t{1} << 31, std::int64_t{1} << 52, std::int64_t{1} << 53, std::int64_t{1} << 62,
        std::numeric_limits<std::int64_t>::min()})
    for (const HoudiniForm form : kHoudiniForms)
      refused_within(scratch.write(houdini_name(form), with_positions(form, count, one)), 32);
}

TEST(HoudiniDamaged, ImpossibleNumbersOfPagesAndComponentsAreRefused) {
  const Scratch scratch;
  const std::string good =
      "[\"pointcount\",3,\"attributes\",[\"pointattributes\",[[[\"type\",\"numeric\",\"name\",\"P\"],[\"values\","
      "[\"size\",3,\"packing\",[2,1],\"pagesize\",2,\"constantpageflags\",[[false,false],[true,true]],"
      "\"rawpagedata\",[0,0,1,1,7,2,2,7]]]]]]]";
  ASSERT_EQ(read_particles(scratch.write("f.geo", good)).position(1), vec3(1, 1, 7));
  for (const char* value : {"0", "-1", "1", "2147483648", "9223372036854775808", "nan", "\"3\"", "257", "[]"}) {
    for (const char* name : {"\"size\",3", "\"pagesize\",2"}) {
      const std::string was(name), key = was.substr(0, was.find(','));
      refused_within(scratch.write("f.geo", replaced(good, was, key + "," + value)), 32);
    }
  }
  for (const char* packing : {"[]", "[3]", "[0,3]", "[2,2]", "[-1,4]", "[1e300,1]", "[nan,1]", "[1,1,1,1]", "7"})
    refused_within(scratch.write("f.geo", replaced(good, "[2,1]", packing)), 32);
  for (const char* flags : {"[[false,false],[true]]", "[[false],[true,true]]", "[[],[],[]]",
                            "[[true,true],[true,true]]", "[[false,false],[\"a\",true]]", "[7]", "7"})
    refused_within(scratch.write("f.geo", replaced(good, "[[false,false],[true,true]]", flags)), 32);
}

TEST(HoudiniDamaged, ConstantPagesStandForNoMoreThanParticles) {
  const Scratch scratch;
  for (const std::int64_t count : {std::int64_t{1} << 24, std::int64_t{1} << 40, std::int64_t{1} << 52}) {
    for (const HoudiniForm form : kHoudiniForms) {
      const std::string bytes = with_positions(form, count, [&](HoudiniWriter& out) {
        out.word("size").whole(3).word("pagesize").whole(count).word("constantpageflags").begin().bits({true}).end();
        out.word("rawpagedata").run(std::vector<float>{1, 2, 3});
      });
      refused_within(scratch.write(houdini_name(form), bytes), 32);
    }
  }
  // Attribute after attribute of it, each of which alone would be believed.
  HoudiniWriter out(HoudiniForm::little);
  constexpr std::int64_t kMany = 1 << 20;
  out.begin().word("pointcount").whole(kMany).word("attributes").begin().word("pointattributes").begin();
  for (int i = 0; i < 1000; ++i) {
    out.attribute(i == 0 ? "P" : "a" + std::to_string(i)).word("values").begin().word("size").whole(3);
    out.word("pagesize").whole(kMany).word("constantpageflags").begin().bits({true}).end();
    out.word("rawpagedata").run(std::vector<float>{1, 2, 3}).end().end().end();
  }
  out.end().end().end();
  EXPECT_EQ(refused_within(scratch.write("many.bgeo", out.result()), 128).code(), ErrorCode::limit_exceeded);
}

TEST(HoudiniDamaged, LengthsBeyondTheFileAreRefused) {
  const Scratch scratch;
  const auto file = [&](std::string_view mark, std::uint64_t length) {
    HoudiniWriter out(HoudiniForm::little);
    out.begin().word("pointcount").whole(1).word("x").bytes(mark).length(length).bytes("12345678");
    return scratch.write("f.bgeo", out.result());
  };
  for (const std::uint64_t length : {std::uint64_t{1} << 16, std::uint64_t{1} << 31, std::uint64_t{0xffffffff},
                                     std::uint64_t{1} << 63, ~std::uint64_t{0}, std::uint64_t{6148914691236517206}})
    for (const char* mark :
         {"\x27", "\x2b\x01", "\x40\x10", "\x40\x11", "\x40\x19", "\x40\x1a", "\x40\x27", "\x40\x26"})
      refused_within(file(mark, length), 32);
  for (const char* mark : {"\x26", "\xf1", "\xff", "\x40\x40", "\x40\x2b", "\x3a", "\x2c"})
    refused_within(file(mark, 9), 32);
}

TEST(HoudiniDamaged, NestedDeepIsRefused) {
  const Scratch scratch;
  const std::string text = "[\"pointcount\",1,\"x\"";
  HoudiniWriter binary(HoudiniForm::little);
  binary.begin().word("pointcount").whole(1).word("x");
  for (const char* bracket : {"[", "{"}) {
    std::string deep;
    for (int i = 0; i < 1'000'000; ++i) deep += bracket;
    EXPECT_EQ(refused_within(scratch.write("f.geo", text + "," + deep), 32).code(), ErrorCode::malformed_file);
    EXPECT_EQ(refused_within(scratch.write("f.bgeo", binary.result() + deep), 32).code(), ErrorCode::malformed_file);
  }
  EXPECT_EQ(refused(scratch.write("f.geo", text + ",{]")).code(), ErrorCode::malformed_file);
  EXPECT_EQ(refused(scratch.write("g.geo", text + "]")).code(), ErrorCode::malformed_file);
}

TEST(HoudiniDamaged, DefinedTextsAreCounted) {
  const Scratch scratch;
  HoudiniWriter out(HoudiniForm::little);
  out.begin();
  for (std::uint64_t i = 0; i < 70'000; ++i) out.bytes("\x2b").length(i).length(0);
  EXPECT_EQ(refused_within(scratch.write("f.bgeo", out.result()), 32).code(), ErrorCode::malformed_file);
}

TEST(HoudiniDamaged, WithoutPositionsOrWithTwoComponentsIsRefused) {
  const Scratch scratch;
  EXPECT_EQ(refused(scratch.write("f.geo", "[\"pointcount\",1]")).code(), ErrorCode::malformed_file);
  EXPECT_EQ(refused(scratch.write("g.geo", "[\"fileversion\",\"12\"]")).code(), ErrorCode::malformed_file);
  const std::string two = with_positions(HoudiniForm::text, 1, [](HoudiniWriter& out) {
    out.word("size").whole(2).word("tuples").begin().run(std::vector<float>{1, 2}).end();
  });
  EXPECT_EQ(refused(scratch.write("h.geo", two)).code(), ErrorCode::malformed_file);
  const std::string none = with_positions(
      HoudiniForm::text, 1, [](HoudiniWriter& out) { out.word("size").whole(3).word("other").begin().end(); });
  EXPECT_EQ(refused(scratch.write("i.geo", none)).code(), ErrorCode::unsupported);
}

TEST(HoudiniDamaged, NamesThatAreNoUtf8AreMadeReadable) {
  const Scratch scratch;
  for (const HoudiniForm form : kHoudiniForms) {
    std::string bytes = replaced(replaced(small_houdini(form), "density", "dens\xe9ty"), "near", "n\x01\xffr");
    const Particles particles = read_particles(scratch.write(houdini_name(form), bytes));
    EXPECT_NE(particles.find("dens?ty"), nullptr);
    EXPECT_TRUE(has_note(particles, "'n??r' is of type"));
  }
}

}  // namespace
}  // namespace meniscus
