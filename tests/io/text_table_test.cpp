// Tables of numbers in text as programs and people write them.
#include "io/frame_head.h"
#include "small_frames.h"

namespace meniscus {
namespace {

Particles read_text(const std::string& text, const ReadOptions& options = {}, const std::string& name = "f.csv") {
  const Scratch scratch;
  return read_particles(scratch.write(name, text), options);
}

Error refused_text(const std::string& text, const ReadOptions& options = {}) {
  const Scratch scratch;
  const std::string path = scratch.write("f.csv", text);
  try {
    read_particles(path, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
    return error;
  }
  ADD_FAILURE() << text << " was read";
  return {ErrorCode::invalid_argument, "nothing was thrown"};
}

ReadOptions with_columns(std::vector<std::string> columns) {
  ReadOptions options;
  options.columns = std::move(columns);
  return options;
}

bool has_note(const Particles& particles, std::string_view words) {
  return std::any_of(particles.notes.begin(), particles.notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

/// Two particles (1, 2, 3) and (4, 5, 6), whatever else.
void expect_two(const Particles& particles, const std::string& text) {
  ASSERT_EQ(particles.size(), 2u) << text;
  EXPECT_EQ(particles.position(0), vec3(1, 2, 3)) << text;
  EXPECT_EQ(particles.position(1), vec3(4, 5, 6)) << text;
}

TEST(TextTable, OfDualSphysicsHasItsHeaderBelowOtherLines) {
  const std::string text =
      " TimeStep [s];Np;Case\n 0.25;2;dam\n\nPos.x [m];Pos.y [m];Pos.z [m];Idp;Vel.x [m/s];Vel.y [m/s];Vel.z "
      "[m/s];Rhop [kg/m^3];Type;\n1;2;3;7;0.5;0;-1;1000.5;3;\n4;5;6;8;1.5;0;-2;1001;3;\n";
  for (const std::string& form : {text, std::string("run of today\n\n") + text.substr(text.find("Pos"))}) {
    const Particles particles = read_text(form);
    expect_two(particles, form);
    EXPECT_EQ(particles.find("velocity")->values, (std::vector<float>{0.5f, 0, -1, 1.5f, 0, -2}));
    EXPECT_EQ(particles.find("density")->values, (std::vector<float>{1000.5f, 1001}));
    EXPECT_EQ(particles.find("Idp")->values, (std::vector<float>{7, 8}));
  }
  EXPECT_EQ(read_text(text).time, 0.25);
}

TEST(TextTable, OfPartVtkIsReadWithSemicolonsAndWithCommas) {
  // Two lines on the frame, an empty one, names, rows; lines of names and rows end in a separator. -csvsep:1 is a
  // comma.
  const std::string text =
      "TimeStep [s];Np;Nbound;Nfixed;Nmoving;Nfloat;Nfluid\n0.1500027;4;2;1;0;1;2\n\n"
      "Pos.x [m];Pos.y [m];Pos.z [m];Zone;Idp;Vel.x [m/s];Vel.y [m/s];Vel.z [m/s];Rhop [kg/m^3];Mass [kg];Press [Pa];"
      "Type;Mk;\n"
      "-0.01;0;0;0;0;0;0;0;1000;0.008;0;0;11;\n"
      "1;2;3;0;2;0.5;0;-1;1000.5;0.008;4.905e+02;3;1;\n"
      "9;9;9;0;1;0;0;0;1000;0.008;0;2;60;\n"
      "4;5;6;0;3;1.5;0;-2;1001;0.008;-1.2E-03;3;1;\n";
  std::string commas = text;
  std::replace(commas.begin(), commas.end(), ';', ',');
  std::string dos = text;
  for (std::size_t at = dos.find('\n'); at != std::string::npos; at = dos.find('\n', at + 2)) dos.insert(at, "\r");
  for (const std::string& form : {text, commas, dos, "\xef\xbb\xbf" + text}) {
    const Particles particles = read_text(form);
    expect_two(particles, form);
    EXPECT_EQ(particles.time, 0.1500027);
    EXPECT_EQ(particles.find("velocity")->values, (std::vector<float>{0.5f, 0, -1, 1.5f, 0, -2}));
    EXPECT_EQ(particles.find("density")->values, (std::vector<float>{1000.5f, 1001}));
    EXPECT_EQ(particles.find("Press")->values, (std::vector<float>{490.5f, -1.2e-3f}));
    EXPECT_EQ(particles.find("Mk")->values, (std::vector<float>{1, 1}));
  }
}

TEST(TextTable, OfPartVtkOutNamesWhatWasLost) {
  const Particles particles = read_text(
      "Pos.x [m];Pos.y [m];Pos.z [m];PartOut;Motive;Idp;Vel.x [m/s];Vel.y [m/s];Vel.z [m/s];Rhop [kg/m^3];\n"
      "1;2;3;1;1;10;2;0;0;1000;\n4;5;6;2;1;12;0;4;0;1000;\n");
  expect_two(particles, "PartVtkOut");
  EXPECT_EQ(particles.find("PartOut")->values, (std::vector<float>{1, 2}));
}

TEST(TextTable, WithNamesButWithoutRowsIsAnEmptyFrame) {
  EXPECT_TRUE(read_text("Pos.x [m],Pos.y [m],Pos.z [m],PartOut,Motive\n").empty());
  EXPECT_EQ(refused_text("Pos.x [m],Pos.y [m],Pos.z").code(), ErrorCode::malformed_file) << "a line without its end";
}

TEST(TextTable, MayBeWrittenInManyWays) {
  for (const std::string text : {
           "x,y,z,p\n1,2,3,9\n4,5,6,9\n",
           "x;y;z;p;\n1;2;3;9;\n4;5;6;9;\n",
           "x;y;z;p\n1;2;3;9;\n4;5;6;9\n",
           "x\ty\tz\tp\n1\t2\t3\t9\n4\t5\t6\t9",
           "x [m] y [m] z [m] p [kg / s]\n1 2 3 9\n4 5 6 9\n",
           "\"x\" , \"y\" , \"z\", \"p\"\n\"1\",\"2\",\"3\",9\n\"4\", \"5\" ,6,9\n",
           "\"p\",\"x (m)\",\"y (m)\",\"z (m)\"\r\n9,1,2,3\r\n9,4,5,6\r\n",
           "x,y,z,p\r1,2,3,9\r4,5,6,9\r",
           "\xef\xbb\xbfx,y,z,p\r\n1,2,3,9\r\n4,5,6,9\r\n",
           "# x y z p\n# 2 rows\n1 2 3 9\n4 5 6 9\n",
           "2\nProperties=species:S:1:pos:R:3:p:R:1 Time=0.5\nH 1 2 3 9\nO 4 5 6 9\n",
           "x,y,z,p\n1.0D+00,2d0,+3,9\n4,5,0.6E1,9\n",
           "x,y,z,p\n1,2,3,9\n,,,\n4,5,6,9\n,,,\n\n",
           "group,x,y,z,p\nwater,1,2,3,9\n\"rest, of it\",4,5,6,9\n",
       }) {
    const Particles particles = read_text(text);
    expect_two(particles, text);
    ASSERT_NE(particles.find("p"), nullptr) << text;
    EXPECT_EQ(particles.find("p")->values, (std::vector<float>{9, 9})) << text;
  }
}

TEST(TextTable, OfAChemistHasNamesBeforeItsNumbers) {
  expect_two(read_text("2\nwater at rest\nO 1 2 3\nH 4 5 6\n"), "atoms");
  expect_two(read_text("2\n\nO 1 2 3\nH 4 5 6\n"), "no title");
}

TEST(TextTable, MayMissNumbersWhichAreCounted) {
  const Particles particles = read_text("x\ty\tz\ta\tb\n1\t2\t3\t\t7\n4\t5\t6\tnone\t\n");
  expect_two(particles, "tabs");
  EXPECT_EQ(particles.find("a"), nullptr);
  EXPECT_TRUE(has_note(particles, "'a' holds no numbers"));
  ASSERT_NE(particles.find("b"), nullptr);
  EXPECT_EQ(particles.find("b")->values[0], 7);
  EXPECT_TRUE(std::isnan(particles.find("b")->values[1]));
  EXPECT_TRUE(has_note(particles, "'b' has no number in 1 of 2 rows"));
}

TEST(TextTable, TakesSingleControlBytesForSmallNumbers) {
  const std::string text = std::string("Idp,Type,x,y,z\n0,") + '\0' + ",1,2,3\n1,\x03,4,5,6\n";
  ReadOptions options;
  options.boundaries = true;
  const Particles particles = read_text(text, options);
  expect_two(particles, "bytes");
  EXPECT_EQ(particles.find("Type")->values, (std::vector<float>{0, 3}));
}

TEST(TextTable, WithDecimalCommasIsRefusedWithAdvice) {
  for (const std::string text :
       {"x;y;z\n1,5;2;3\n", "x;y;z\n1;2;3\n1;2,25;3\n", "x;y;z;p\n1;2;3;4\n1;2;3;4,5\n", "1,5 2,5 3,5\n",
        "x\ty\tz\n1,5\t2,5\t3,5\n", "1 2 3\n4,5 6 7\n", "x;y;z\n1;2;3\n1;2;-,5\n"}) {
    const Error error = refused_text(text);
    EXPECT_EQ(error.code(), ErrorCode::malformed_file) << text;
    EXPECT_NE(std::string(error.what()).find("decimal points"), std::string::npos) << error.what();
  }
}

TEST(TextTable, OfUtf16IsRefusedWithAdvice) {
  const Error error =
      refused_text(std::string("\xff\xfe"
                               "1\0 \0",
                               6));
  EXPECT_NE(error.detail().advice.find("UTF-8"), std::string::npos);
}

TEST(TextTable, IsReadFromTheColumnsThatAreAskedFor) {
  const std::string text = "t,Alpha [m],b,C,x,y,z\n0,1,2,3,7,8,9\n0,4,5,6,7,8,9\n";
  expect_two(read_text(text, with_columns({"alpha", "B", "c [m]"})), "names");
  expect_two(read_text(text, with_columns({"2", "3", "4"})), "numbers");
  const Particles turned = read_text(text, with_columns({"4", "b", "Alpha [m]"}));
  EXPECT_EQ(turned.position(0), vec3(3, 2, 1));
  EXPECT_NE(turned.find("t"), nullptr) << "the others stay attributes";
  expect_two(read_text("9 1 2 3 9\n9 4 5 6 9\n", with_columns({"2", "3", "4"})), "no header");
  expect_two(read_text("made today\n0.5;1\na;b;c\n1;2;3\n4;5;6\n", with_columns({"a", "b", "c"})), "below others");
}

TEST(TextTable, ListsItsColumnsWhereOneIsNotThere) {
  const Error error = refused_text("t,u,v,w\n1,2,3,4\n", with_columns({"u", "v", "q"}));
  EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
  EXPECT_NE(std::string(error.what()).find("1 t, 2 u, 3 v, 4 w"), std::string::npos) << error.what();
  EXPECT_EQ(refused_text("1 2 3\n", with_columns({"1", "2", "4"})).code(), ErrorCode::invalid_argument);
  EXPECT_EQ(refused_text("1 2 3\n", with_columns({"1", "2", "0"})).code(), ErrorCode::invalid_argument);
  EXPECT_EQ(refused_text("1 2 3\n", with_columns({"1", "2", "2"})).code(), ErrorCode::invalid_argument);
  EXPECT_EQ(refused_text("1 2 3\n", with_columns({"1", "2"})).code(), ErrorCode::invalid_argument);
}

TEST(TextTable, IsNotReadFromColumnsThatAreOnlyPartlyPositions) {
  const Error error = refused_text("x,z,rho\n1,2,3\n");
  EXPECT_EQ(error.code(), ErrorCode::malformed_file);
  EXPECT_NE(std::string(error.what()).find("no column for y"), std::string::npos) << error.what();
  EXPECT_TRUE(has_note(read_text("a,b,c\n1,2,3\n"), "names no x, y, z"));
}

TEST(TextTable, WithRowsBeforeItsHeaderIsRefused) {
  // A second table in the same file, or one that was appended, is no title.
  EXPECT_EQ(refused_text("1 2 3\n4 5 6\nx y z\n7 8 9\n").detail().line, 3u);
  EXPECT_EQ(refused_text("1 2 3\n4 5 6\nx y z p\n7 8 9 1\n").detail().line, 3u);
  EXPECT_EQ(refused_text("x,y,z\n1,2,3\nx,y,z\n1,2,3\n").detail().line, 3u);
}

TEST(TextTable, NamesTheLineThatHasAnotherNumberOfColumns) {
  for (const std::string text : {"x,y,z\n1,2,3\n1,2\n", "x,y,z\n1,2,3\n1,2,3,4\n", "x;y;z\n1;2;3\n1;2;3;;\n",
                                 "1 2 3\n\n1 2\n", "1 2 3\n# c\n1 2 3 4\n", "x,y,z\n1,2,3\n7\n"}) {
    const Error error = refused_text(text);
    EXPECT_EQ(error.code(), ErrorCode::malformed_file) << text;
    EXPECT_EQ(error.detail().line, 3u) << text;
  }
  EXPECT_EQ(refused_text("x,y,z,p\n1,2,3\n").code(), ErrorCode::malformed_file);
  EXPECT_EQ(refused_text("1;2;\n3;4;\n").detail().line, 1u) << "what is behind the last separator is no column";
  EXPECT_EQ(refused_text("a;b\n1;2;\n").detail().line, 2u);
  EXPECT_EQ(refused_text("x,y,z\n1,,3\n").detail().line, 2u) << "a coordinate is missing";
}

/// Rows enough for many pieces, with a line to be replaced.
std::string many_rows(int count, int replaced = -1, const std::string& line = {}) {
  std::string text = "x,y,z,p\n";
  for (int i = 0; i < count; ++i) {
    const std::string number = std::to_string(i);
    text += i == replaced ? line : number + ".25,-" + number + ",0.5," + number + "\n";
    if (i % 1000 == 0) text += "# and further\n";
  }
  return text;
}

TEST(ManyRows, AreTheSameForAnyNumberOfThreads) {
  const int count = 150000;
  const std::string text = many_rows(count);
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const Particles particles = read_text(text);
    ASSERT_EQ(particles.size(), static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < particles.size(); ++i) {
      ASSERT_EQ(particles.position(i), vec3(static_cast<float>(i) + 0.25f, -static_cast<float>(i), 0.5f));
      ASSERT_EQ(particles.find("p")->values[i], static_cast<float>(i));
    }
  }
}

TEST(ManyRows, AreRefusedByTheFirstErrorInTheFile) {
  std::string text = many_rows(150000, 70000, "1,2\n");
  text += "1,two,3,4\n";
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    // 70001 rows, the line of names, and a comment behind rows 0, 1000 ... 69000.
    EXPECT_EQ(refused_text(text).detail().line, 70002u + 70u);
  }
}

TEST(ManyRows, OfOneLineAreNoReasonToWait) {
  const std::string blanks(std::size_t{1} << 22, ' ');
  EXPECT_EQ(read_text("1 2 3" + blanks + "\n4 5 6\n").size(), 2u);
  EXPECT_EQ(read_text("#" + blanks + "\n1 2 3\n#" + blanks + "\n4 5 6").size(), 2u);
  EXPECT_EQ(refused_text(std::string(std::size_t{1} << 22, 'a')).code(), ErrorCode::malformed_file);
  std::string ones;
  for (int i = 0; i < 1 << 20; ++i) ones += "1 ";
  EXPECT_EQ(refused_text(ones).code(), ErrorCode::malformed_file) << "too many columns";
  EXPECT_EQ(refused_text("1 2 3\n" + ones).detail().line, 2u);
}

TEST(ManyRows, ThatAreTooShortTakeNoMemory) {
  const Scratch scratch;
  std::string text = "x,y,z,p,q,r,s,t,u,v,w\n1,2,3,4,5,6,7,8,9,10,11\n";
  for (int i = 0; i < 1 << 21; ++i) text += "1\n";
  const std::string path = scratch.write("f.csv", text);
  const std::uint64_t before = peak_rss_bytes();
  EXPECT_EQ(refused(path).detail().line, 3u);
  EXPECT_LT(peak_rss_bytes() - before, std::uint64_t{64} << 20);
}

TEST(TextHead, IsJudgedFromAnyPartOfATable) {
  const Scratch scratch;
  const std::string text = many_rows(3000);
  const std::string path = scratch.write("f.csv", text);
  for (std::size_t size = 0; size < 300; ++size) {
    io::FrameHead head;
    head.file_bytes = head.plain_bytes = text.size();
    io::look_at_xyz(io::Source{path, {text.data(), size}}, head);
    EXPECT_FALSE(head.counted);
    EXPECT_GT(head.particles, 1000u) << size;
    EXPECT_LT(head.particles, 9000u) << size;
  }
  EXPECT_EQ(io::look_at_frame(scratch.write("small.csv.gz", gzipped("Pos.x [m];Pos.y [m];Pos.z [m]\n1;2;3\n"))).format,
            "xyz");
}

TEST(Positions, OfTextKeepWhatDoublesKnow) {
  const Particles particles = read_text("x,y,z\n5000000.125,2,3\n5000000.25,2.5,3\n");
  EXPECT_NE(particles.origin.x, 0);
  EXPECT_EQ(particles.origin.x + static_cast<double>(particles.x[0]), 5000000.125);
  EXPECT_EQ(particles.origin.x + static_cast<double>(particles.x[1]), 5000000.25);
}

TEST(Positions, OfTextAreTheFloatsNearestToTheirDecimals) {
  // Decimals so near to the middle of two floats that the nearest double is the middle itself.
  const std::vector<std::string> decimals{"1.00000005960464477539062499999", "1.00000005960464477539062500001",
                                          "1.0000000596046447753906250", "16777217.0000000001", "0.1"};
  std::string text;
  for (const std::string& decimal : decimals) text += decimal + " 0 0\n";
  const Particles particles = read_text(text);
  ASSERT_EQ(particles.size(), decimals.size());
  for (std::size_t i = 0; i < decimals.size(); ++i)
    EXPECT_EQ(particles.x[i], std::strtof(decimals[i].c_str(), nullptr));
}

}  // namespace
}  // namespace meniscus
