#include "small_frames.h"

namespace meniscus {
namespace {

class VtkByItsOwnWriter : public testing::TestWithParam<const char*> {};

TEST_P(VtkByItsOwnWriter, IsReadWithAllItsNumbers) {
  const Particles particles = read_particles(sample(GetParam()));
  EXPECT_EQ(particles.format, "vtk");
  expect_small(particles);
  EXPECT_EQ(particles.time, 0.375);
  ASSERT_NE(particles.find("Normals"), nullptr);
  EXPECT_EQ(particles.find("Normals")->values[20], 1.0f);
  ASSERT_NE(particles.find("stress"), nullptr);
  EXPECT_EQ(particles.find("stress")->components, 9);
  ASSERT_NE(particles.find("pair of numbers"), nullptr);
  EXPECT_EQ(particles.find("pair of numbers")->values[13], -60.0f);
  for (const char* name : {"id", "small", "GlobalIds"}) {
    ASSERT_NE(particles.find(name), nullptr) << name;
    EXPECT_EQ(particles.find(name)->values[6], 60.0f) << name;
  }
  EXPECT_EQ(particles.find("text"), nullptr);
  EXPECT_EQ(particles.find("bits"), nullptr);
  EXPECT_EQ(particles.find("of_cells"), nullptr);
}

INSTANTIATE_TEST_SUITE_P(Samples, VtkByItsOwnWriter,
                         testing::Values("polydata_42_ascii.vtk", "polydata_42_binary.vtk", "polydata_51_ascii.vtk",
                                         "polydata_51_binary.vtk", "grid_42_ascii.vtk", "grid_42_binary.vtk",
                                         "grid_51_ascii.vtk", "grid_51_binary.vtk"),
                         [](const auto& info) {
                           return std::string(info.param).substr(0, std::string(info.param).size() - 4);
                         });

Particles read_text(const std::string& text) {
  const Scratch scratch;
  return read_particles(scratch.write("f.vtk", text));
}

/// As SPlisHSPlasH writes it: ids with a table that is not defined, then a field.
TEST(Vtk, ReadsIdsBeforeAFieldInBinary) {
  ByteWriter out;
  out.text("# vtk DataFile Version 4.1\nparticle data\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 7 float\n");
  for (int i = 0; i < kSmallCount; ++i) {
    const vec3 p = small_position(i);
    out.put(p.x).put(p.y).put(p.z);
  }
  out.text("\nCELLS 7 14\n");
  for (int i = 0; i < kSmallCount; ++i) out.put<std::int32_t>(1).put<std::int32_t>(i);
  out.text("\nCELL_TYPES 7\n");
  for (int i = 0; i < kSmallCount; ++i) out.put<std::int32_t>(1);
  out.text("\nPOINT_DATA 7\nSCALARS id unsigned_int 1\nLOOKUP_TABLE id_table\n");
  for (int i = 0; i < kSmallCount; ++i) out.put<std::uint32_t>(static_cast<std::uint32_t>(10 * i));
  out.text("\nFIELD FieldData 2\nvelocity 3 7 float\n");
  for (int i = 0; i < kSmallCount; ++i) {
    const vec3 v = small_velocity(i);
    out.put(v.x).put(v.y).put(v.z);
  }
  out.text("\ndensity 1 7 float\n");
  for (int i = 0; i < kSmallCount; ++i) out.put(1000.0f + static_cast<float>(i));
  const Particles particles = read_text(out.bytes());
  expect_small(particles);
  EXPECT_EQ(particles.find("id")->values[6], 60.0f);
}

TEST(Vtk, ReadsBinaryPointsBehindABlankLine) {
  ByteWriter out;
  out.text("# vtk DataFile Version 4.1\nparticles\nBINARY\n\nDATASET POLYDATA\nPOINTS 1 double\n");
  out.put(1.0).put(2.0).put(3.0);
  EXPECT_EQ(read_text(out.bytes()).position(0), vec3(1, 2, 3));
}

TEST(Vtk, ReadsOldVersionsWithTablesAndScalarsOfSeveralComponents) {
  const Particles particles = read_text(
      "# vtk DataFile Version 2.0\r\nt\r\nASCII\r\nDATASET POLYDATA\r\nPOINTS 2 float\r\n1 2 3 4\r\n5 6\r\n"
      "POINT_DATA 2\r\nSCALARS a float\r\nLOOKUP_TABLE mine\r\n7 8\r\nLOOKUP_TABLE mine 2\r\n0 0 0 1 1 1 1 1\r\n"
      "SCALARS b int 2\r\nLOOKUP_TABLE default\r\n1 2 3 4\r\nCOLOR_SCALARS c 3\r\n0 0.5 1 1 0.5 0\r\n"
      "SCALARS d float\r\n9 10\r\nVECTORS Vel double\r\n1 2 3 4 5 6\r\n");
  ASSERT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.position(1), vec3(4, 5, 6));
  EXPECT_EQ(particles.find("a")->values, (std::vector<float>{7, 8}));
  EXPECT_EQ(particles.find("b")->values, (std::vector<float>{1, 2, 3, 4}));
  EXPECT_EQ(particles.find("c")->components, 3);
  EXPECT_EQ(particles.find("d")->values, (std::vector<float>{9, 10}));
  EXPECT_EQ(particles.find("velocity")->values, (std::vector<float>{1, 2, 3, 4, 5, 6}));
}

TEST(Vtk, ReadsFieldsBeforeAndAfterScalarsAndMovesOverMetadataAnywhere) {
  const std::string metadata = "METADATA\nINFORMATION 1\nNAME UNITS_LABEL LOCATION vtkDataArray\nDATA POINTS%201\n\n";
  const Particles particles = read_text(
      "\xef\xbb\xbf# vtk DataFile Version 5.1\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 1 1\n"
      "FIELD FieldData 2\nTIME 1 1 double\n0.25\nempty 1 0 float\n\nPOINTS 2 float\n1 2 3 4 5 6\n" +
      metadata + "CELL_DATA 1\nSCALARS of_cells vtkIdType\nLOOKUP_TABLE default\n7\n" + metadata +
      "POINT_DATA 2\nFIELD f 2\na 1 2 vtkIdType\n8 9\n" + metadata + "b 2 2 vtktypeint64\n1 2 3 4\n" + metadata +
      "SCALARS c float\nLOOKUP_TABLE default\n5 6\n" + metadata + "FIELD g 1\nd 1 2 unsigned_char\n10 11\n");
  ASSERT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.position(1), vec3(4, 5, 6));
  EXPECT_EQ(particles.time, 0.25);
  EXPECT_EQ(particles.find("a")->values, (std::vector<float>{8, 9}));
  EXPECT_EQ(particles.find("b")->values, (std::vector<float>{1, 2, 3, 4}));
  EXPECT_EQ(particles.find("c")->values, (std::vector<float>{5, 6}));
  EXPECT_EQ(particles.find("d")->values, (std::vector<float>{10, 11}));
  EXPECT_EQ(particles.find("of_cells"), nullptr);
}

TEST(Vtk, ReadsBinaryLookupTables) {
  ByteWriter out;
  out.text("# vtk DataFile Version 3.0\nt\nBINARY\nDATASET POLYDATA\nPOINTS 1 float\n").put(1.f).put(2.f).put(3.f);
  out.text("\nPOINT_DATA 1\nSCALARS a float 1\nLOOKUP_TABLE t\n")
      .put(4.f)
      .text("\nLOOKUP_TABLE t 2\n")
      .text("\n\n\n\n\n\n\n\n");
  out.text("\nCOLOR_SCALARS c 4\n").text("\x01\x02\x03\x04").text("\nSCALARS b float 1\nLOOKUP_TABLE t\n").put(5.f);
  const Particles particles = read_text(out.bytes());
  EXPECT_EQ(particles.find("a")->values, (std::vector<float>{4}));
  EXPECT_EQ(particles.find("c")->values, (std::vector<float>{1, 2, 3, 4}));
  EXPECT_EQ(particles.find("b")->values, (std::vector<float>{5}));
}

TEST(Vtk, OfNoPointsIsAnEmptyFrame) {
  EXPECT_TRUE(read_text("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 0 float\n").empty());
}

TEST(Vtk, StopsWithANoteAtUnknownWordsBehindThePoints) {
  const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n";
  const Particles particles = read_text(head + "POINTS 1 float\n1 2 3\nNOVELTY 7\n");
  EXPECT_EQ(particles.size(), 1u);
  EXPECT_EQ(particles.notes.size(), 1u);
  const Scratch scratch;
  EXPECT_EQ(refused(scratch.write("f.vtk", head + "NOVELTY 7\n")).code(), ErrorCode::malformed_file);
}

TEST(Vtk, OfFewerPointsThanThereAreIsMalformed) {
  const Scratch scratch;
  for (const char* count : {"0", "1"}) {
    const std::string points = std::string("\nDATASET POLYDATA\nPOINTS ") + count + " float\n";
    const std::string head = "# vtk DataFile Version 3.0\nt\n";
    ByteWriter out;
    for (const float value : {1.f, 2.f, 3.f, 4.f, 5.f, 6.f}) out.put(value);
    for (const std::string& bytes :
         {head + "ASCII" + points + "1 2 3\n4 5 6\n", head + "BINARY" + points + out.bytes()})
      EXPECT_EQ(refused(scratch.write("f.vtk", bytes)).code(), ErrorCode::malformed_file) << count;
  }
}

TEST(Vtk, OfOtherDataSetsAndXmlIsUnsupported) {
  const Scratch scratch;
  const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET ";
  EXPECT_EQ(refused(scratch.write("a.vtk", head + "RECTILINEAR_GRID\n")).code(), ErrorCode::unsupported);
  EXPECT_EQ(refused(scratch.write("b.vtk", head + "STRUCTURED_POINTS\n")).code(), ErrorCode::unsupported);
  EXPECT_EQ(refused(scratch.write("c.vtu", "<?xml version=\"1.0\"?>\n<VTKFile/>\n")).code(), ErrorCode::unsupported);
}

TEST(Vtk, WithDataForAnotherNumberOfPointsIsMalformed) {
  const Scratch scratch;
  const Error error = refused(scratch.write("f.vtk",
                                            "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n"
                                            "1 2 3\nPOINT_DATA 2\nSCALARS a float\nLOOKUP_TABLE default\n1 2\n"));
  EXPECT_EQ(error.code(), ErrorCode::malformed_file);
  EXPECT_EQ(error.detail().expected, "1");
  EXPECT_EQ(error.detail().found, "2");
}

TEST(Vtk, LeavesOutPointsThatAreNotFinite) {
  const Particles particles = read_text(
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n1 2 3 nan 0 0 4 1e300 5\n"
      "POINT_DATA 3\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3\n");
  EXPECT_EQ(particles.size(), 1u);
  EXPECT_EQ(particles.dropped_non_finite, 2u);
  EXPECT_EQ(particles.find("a")->values, (std::vector<float>{1}));
}

}  // namespace
}  // namespace meniscus
