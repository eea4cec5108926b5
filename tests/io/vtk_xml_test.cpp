#include <fmt/format.h>

#include "io/frame_head.h"
#include "small_frames.h"

namespace meniscus {
namespace {

class VtkXmlByItsOwnWriter : public testing::TestWithParam<const char*> {};

TEST_P(VtkXmlByItsOwnWriter, IsReadWithAllItsNumbers) {
  const Particles particles = read_particles(sample(GetParam()));
  EXPECT_EQ(particles.format, "vtkxml");
  expect_small(particles);
  EXPECT_EQ(particles.time, 0.375);
  for (const char* name : {"id", "u8", "i16", "u16", "i32", "u32", "u64", "i8"}) {
    ASSERT_NE(particles.find(name), nullptr) << name;
    EXPECT_EQ(particles.find(name)->values[6], 60.0f) << name;
  }
  EXPECT_EQ(particles.find("text"), nullptr);
  EXPECT_EQ(particles.find("of_cells"), nullptr);
  EXPECT_EQ(particles.notes, std::vector<std::string>{"array 'text' holds no numbers and was left out"});
}

INSTANTIATE_TEST_SUITE_P(Samples, VtkXmlByItsOwnWriter,
                         testing::Values("ascii.vtp", "inline_64.vtp", "inline_zlib.vtu", "raw_big.vtu",
                                         "raw_zlib_64.vtu", "base64_zlib_big.vtu", "base64_64.vtp", "two_pieces.vtu",
                                         "parallel.pvtu"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

Particles read_text(const std::string& text, const ReadOptions& options = {}, const std::string& name = "f.vtu") {
  const Scratch scratch;
  return read_particles(scratch.write(name, text), options);
}

/// A grid of one piece: what stands in its <Piece>, and what behind the grid.
std::string grid(const std::string& points, const std::string& inside, const std::string& behind = {},
                 const std::string& attributes = {}) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" {}>\n<UnstructuredGrid>\n<Piece "
      "NumberOfPoints=\"{}\" NumberOfCells=\"0\">\n{}\n</Piece>\n</UnstructuredGrid>\n{}</VTKFile>\n",
      attributes, points, inside, behind);
}

const std::string kTwoPoints =
    "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">1 2 3 4 5 6</DataArray></Points>";

std::string array_of(const std::string& attributes, const std::string& text) {
  return "<PointData><DataArray Name=\"a\" " + attributes + ">" + text + "</DataArray></PointData>";
}

TEST(VtkXml, TakesAByteOrderMarkAndLineEndsOfAnySystem) {
  std::string text = "\xef\xbb\xbf" + grid("2", kTwoPoints);
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 2)) text.insert(at, "\r");
  EXPECT_EQ(read_text(text).position(1), vec3(4, 5, 6));
}

TEST(VtkXml, ReadsBase64WithItsHeaderApartOrTogetherInLinesOrNot) {
  // Eight bytes 1 .. 8 behind a length of four bytes.
  for (const char* text :
       {"CAAAAAECAwQFBgcI", "CAAAAA==AQIDBAUGBwg=", "CAAA\n  AAEC\r\nAwQF\tBgcI\n", "CAAAAA==\nAQIDBAUGBwg="}) {
    const Particles particles =
        read_text(grid("2", kTwoPoints + array_of("type=\"UInt8\" NumberOfComponents=\"4\" format=\"binary\"", text)));
    EXPECT_EQ(particles.find("a")->values, (std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8})) << text;
  }
}

TEST(VtkXml, OfDamagedBase64IsMalformed) {
  const Scratch scratch;
  for (const char* text : {"CAAAAAECAwQFBgc", "CAAAAAECAwQFBg==", "CAAA*AECAwQFBgcI", "CAAAAAEC=AwQFBgcI", "", "C",
                           "====", "CQAAAAECAwQFBgcI", "BwAAAAECAwQFBgcI", "/////wECAwQFBgcI"}) {
    const std::string bytes =
        grid("2", kTwoPoints + array_of("type=\"UInt8\" NumberOfComponents=\"4\" format=\"binary\"", text));
    EXPECT_EQ(refused(scratch.write("f.vtu", bytes)).code(), ErrorCode::malformed_file) << text;
  }
}

TEST(VtkXml, CountsDoublesFarAwayFromAnOriginNearThemForAllPieces) {
  const auto piece = [](const std::string& points) {
    return "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" + points +
           "</DataArray></Points>";
  };
  std::string text = grid("2", piece("500000.001 0 0 500001 0 0"));
  text.insert(text.find("</UnstructuredGrid>"), "<Piece NumberOfPoints=\"1\">" + piece("500000.002 0 0") + "</Piece>");
  text.insert(text.find("</UnstructuredGrid>"), "<Piece NumberOfPoints=\"0\"/>");
  const Particles particles = read_text(text);
  ASSERT_EQ(particles.size(), 3u);
  EXPECT_NEAR(particles.origin.x, 500000, 10);
  for (const auto& [i, x] : {std::pair(0, 500000.001), std::pair(2, 500000.002)})
    EXPECT_NEAR(particles.origin.x + static_cast<double>(particles.x[static_cast<std::size_t>(i)]), x, 1e-6);
}

TEST(VtkXml, LeavesOutGhostsAndArraysThatNotAllPiecesHave) {
  std::string text = grid("2", kTwoPoints +
                                   "<PointData><DataArray type=\"UInt8\" Name=\"vtkGhostType\" "
                                   "format=\"ascii\">1 0</DataArray><DataArray type=\"Int8\" Name=\"a\" "
                                   "format=\"ascii\">7 -8</DataArray></PointData>");
  EXPECT_EQ(read_text(text).position(0), vec3(4, 5, 6));
  EXPECT_EQ(read_text(text).find("a")->values, std::vector<float>{-8});
  EXPECT_EQ(read_text(text).find("vtkGhostType"), nullptr);
  text.insert(text.find("</UnstructuredGrid>"), "<Piece NumberOfPoints=\"2\">" + kTwoPoints + "</Piece>");
  const Particles particles = read_text(text);
  EXPECT_EQ(particles.size(), 3u);
  EXPECT_TRUE(particles.attributes.empty());
  EXPECT_EQ(particles.notes.size(), 2u);
}

TEST(VtkXml, NamesThePlaceOfAFaultBehindLongTexts) {
  const Scratch scratch;
  std::string values;
  for (int i = 0; i < 9000; ++i) values += fmt::format(" {}", i % 10);
  const auto array = [&](const char* name, const char* type) {
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"3\">{}</DataArray>", type, name,
                       values);
  };
  const std::string text = grid("3000", "<Points>" + array("p", "Float32") + "</Points><PointData>" +
                                            array("a>b", "Int8") + array("b", "Int8") + "</PointData>");
  const Particles particles = read_text(text);
  EXPECT_EQ(particles.position(2999), vec3(7, 8, 9));
  EXPECT_EQ(particles.find("a>b")->values[8999], 9.0f);
  std::string damaged = text;
  damaged[damaged.rfind(" 7 8 9") + 1] = 'x';
  EXPECT_EQ(refused(scratch.write("f.vtu", damaged)).detail().byte_offset, damaged.find('x', damaged.find("\"b\"")));
  std::string mismatched = text;
  mismatched.replace(mismatched.rfind("</DataArray"), 3, "</E");
  EXPECT_GT(refused(scratch.write("f.vtu", mismatched)).detail().byte_offset, mismatched.find("</E") - 10);
  // Comments may hold what looks like a tag.
  std::string commented = text;
  commented.insert(commented.find("<PointData>"), "<!-- > " + std::string(5000, '-' + 1) + " -->");
  EXPECT_EQ(read_text(commented).find("b")->values[8999], 9.0f);
}

TEST(VtkXml, OfNoPointsIsAnEmptyFrame) {
  EXPECT_TRUE(read_text(grid("0", "")).empty());
  EXPECT_TRUE(read_text(grid(" 0 ", "<Points><DataArray type=\"Float32\"/></Points>")).empty());
}

TEST(VtkXml, OfOtherCompressorsAndDataSetsIsUnsupported) {
  const Error lz4 = refused(sample("lz4.vtp"));
  EXPECT_EQ(lz4.code(), ErrorCode::unsupported);
  EXPECT_NE(std::string(lz4.what()).find("vtkLZ4DataCompressor"), std::string::npos);
  const Scratch scratch;
  for (const char* kind : {"ImageData", "RectilinearGrid", "StructuredGrid", "vtkMultiBlockDataSet", "Collection", ""})
    EXPECT_EQ(refused(scratch.write("f.vtu", fmt::format("<VTKFile type=\"{0}\"><{0}/></VTKFile>", kind))).code(),
              *kind != '\0' ? ErrorCode::unsupported : ErrorCode::malformed_file);
  EXPECT_EQ(refused(scratch.write("g.vtu", "<?xml version=\"1.0\"?>\n<html/>\n")).code(), ErrorCode::unsupported);
}

TEST(VtkXml, OfDamagedElementsIsMalformed) {
  const Scratch scratch;
  const auto refuse = [&](const std::string& text) {
    EXPECT_EQ(refused(scratch.write("f.vtu", text)).code(), ErrorCode::malformed_file) << text;
  };
  for (const char* count :
       {"-1", "1", "3", "", "x", "2147483648", "9223372036854775808", "18446744073709551615", "nan"})
    refuse(grid(count, kTwoPoints));
  for (const char* components : {"0", "-1", "3", "2147483648", "9223372036854775808", "65536", "nan"})
    refuse(grid("2", kTwoPoints + array_of(fmt::format("type=\"Int8\" NumberOfComponents=\"{}\"", components), "1 2")));
  for (const char* offset : {"0", "-1", "2147483648", "9223372036854775808", "18446744073709551615"})
    refuse(
        grid("2", kTwoPoints + array_of(fmt::format("type=\"Int8\" format=\"appended\" offset=\"{}\"", offset), "")));
  refuse(grid("2", ""));
  refuse(grid("2", kTwoPoints + array_of("type=\"Int8\" format=\"other\"", "1 2")));
  refuse(grid("2", kTwoPoints + array_of("type=\"Int8\"", "1 2 3")));
  refuse(grid("2", kTwoPoints + array_of("type=\"Int8\"", "1 two")));
  refuse(grid("2", kTwoPoints, {}, "header_type=\"Int12\""));
  refuse(grid("2", kTwoPoints + "<Verts>"));
  refuse(grid("2", kTwoPoints, "<AppendedData encoding=\"raw\">_"));
  refuse(grid("2", kTwoPoints, "<AppendedData encoding=\"raw\">abc</AppendedData>"));
}

TEST(VtkXml, NestedTooDeepOrOfTooManyTagsIsMalformed) {
  const Scratch scratch;
  std::string deep = "<VTKFile type=\"PolyData\">", many = deep + "<PolyData>";
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  for (int i = 0; i < 100000; ++i) deep += "</a>";
  for (int i = 0; i < 500000; ++i) many += "<a/>";
  EXPECT_EQ(refused(scratch.write("a.vtp", deep + "</VTKFile>")).code(), ErrorCode::malformed_file);
  EXPECT_EQ(refused(scratch.write("b.vtp", many + "</PolyData></VTKFile>")).code(), ErrorCode::malformed_file);
}

/// A parallel file with these pieces.
std::string parallel(const std::vector<std::string>& names) {
  std::string text = "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>";
  for (const std::string& name : names) text += fmt::format("<Piece Source=\"{}\"/>", name);
  return text + "</PUnstructuredGrid></VTKFile>";
}

ErrorCode code_of(const std::string& path, const ReadOptions& options = {}) {
  try {
    read_particles(path, options);
  } catch (const Error& error) {
    return error.code();
  }
  ADD_FAILURE() << path << " was read";
  return ErrorCode::io_failed;
}

TEST(ParallelVtkXml, NamesNoFileOutsideOfItsDirectoryUnlessThatIsAllowed) {
  const Scratch scratch;
  const std::string piece = scratch.write("piece.vtu", grid("2", kTwoPoints));
  scratch.write("d/piece.vtu", grid("2", kTwoPoints));
  ReadOptions allowed;
  allowed.allow_outside = true;
  for (const std::string& name : {std::string("../piece.vtu"), piece, std::string("x/../../piece.vtu")}) {
    EXPECT_EQ(code_of(scratch.write("d/f.pvtu", parallel({name}))), ErrorCode::invalid_argument) << name;
  }
  std::filesystem::create_directories(scratch.path("d/x"));
  for (const std::string& name : {std::string("../piece.vtu"), piece, std::string("x/../../piece.vtu")})
    EXPECT_EQ(read_particles(scratch.write("d/f.pvtu", parallel({name})), allowed).size(), 2u) << name;
  for (const std::string& name :
       {std::string("./piece.vtu"), std::string("x/../piece.vtu"), scratch.path("d/piece.vtu")})
    EXPECT_EQ(read_particles(scratch.write("d/f.pvtu", parallel({name}))).size(), 2u) << name;
}

TEST(ParallelVtkXml, NamesNeitherItselfNorOthersOfItsKindNorAPieceTwice) {
  const Scratch scratch;
  scratch.write("piece.vtu", grid("2", kTwoPoints));
  scratch.write("b.pvtu", parallel({"a.pvtu"}));
  for (const auto& names : std::vector<std::vector<std::string>>{
           {"a.pvtu"}, {"b.pvtu"}, {"piece.vtu", "piece.vtu"}, {"piece.vtu", "./piece.vtu"}, {""}, {}})
    EXPECT_EQ(code_of(scratch.write("a.pvtu", parallel(names))), ErrorCode::malformed_file);
  EXPECT_EQ(code_of(scratch.write("a.pvtu", parallel({"absent.vtu"}))), ErrorCode::not_found);
  EXPECT_EQ(code_of(scratch.write("a.pvtu", parallel({"."}))), ErrorCode::invalid_argument);
  scratch.write("other.vtp", "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"0\"/></PolyData></VTKFile>");
  EXPECT_EQ(code_of(scratch.write("a.pvtu", parallel({"other.vtp"}))), ErrorCode::malformed_file);
}

TEST(VtkXmlHead, TellsThePointsOfAllPieces) {
  for (const char* name : {"ascii.vtp", "inline_64.vtp", "raw_zlib_64.vtu", "two_pieces.vtu", "parallel.pvtu"}) {
    const io::FrameHead head = io::look_at_frame(sample(name));
    EXPECT_TRUE(head.counted) << name;
    EXPECT_EQ(head.particles, 7u) << name;
    EXPECT_EQ(head.format, "vtkxml") << name;
  }
}

TEST(VtkXmlHead, OfAFileThatNamesItselfEnds) {
  const Scratch scratch;
  EXPECT_EQ(io::look_at_frame(scratch.write("a.pvtu", parallel({"a.pvtu"}))).particles, 0u);
}

}  // namespace
}  // namespace meniscus
