// Headers as editors, mailers and other languages leave them: line ends, marks, huge lines, names that are no UTF-8.
#include <nlohmann/json.hpp>

#include "damage.h"

namespace meniscus {
namespace {

/// Whether a JSON library takes text for UTF-8.
bool is_utf8(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

std::string with_crlf(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return result;
}

TEST(LineEnds, OfDosInFilesThatAreTextChangeNothing) {
  const Scratch scratch;
  for (const char* name : {"mesh_ascii.ply", "polydata_42_ascii.vtk", "grid_51_ascii.vtk", "ascii.vtp"}) {
    const Particles as_it_was = read_particles(sample(name));
    const Particles particles = read_particles(scratch.write(name, with_crlf(bytes_of_file(sample(name)))));
    expect_small(particles, false);
    ASSERT_EQ(particles.attributes.size(), as_it_was.attributes.size()) << name;
    for (std::size_t i = 0; i < particles.attributes.size(); ++i)
      EXPECT_EQ(particles.attributes[i].values, as_it_was.attributes[i].values) << name;
  }
}

TEST(LineEnds, OfDosInHeadersBeforeBinaryNumbersChangeNothing) {
  const Scratch scratch;
  const std::string ply = small_ply(std::endian::little, false);
  const std::size_t end = ply.find("end_header\n") + 11;
  expect_small(read_particles(scratch.write("f.ply", with_crlf(ply.substr(0, end)) + ply.substr(end))));
  const std::string vtk = bytes_of_file(sample("polydata_42_binary.vtk"));
  const std::size_t form = vtk.find("BINARY\n") + 7;
  expect_small(read_particles(scratch.write("f.vtk", with_crlf(vtk.substr(0, form)) + vtk.substr(form))), false);
}

TEST(LineEnds, OfOldMacintoshesAreReadOrRefused) {
  const Scratch scratch;
  for (const char* name : {"mesh_ascii.ply", "polydata_42_ascii.vtk", "ascii.vtp"}) {
    std::string bytes = bytes_of_file(sample(name));
    std::replace(bytes.begin(), bytes.end(), '\n', '\r');
    outcome_of(scratch.write(name, bytes));
  }
}

TEST(ByteOrderMark, BeforeAnyTextIsReadOrRefused) {
  const Scratch scratch;
  for (const char* name : {"mesh_ascii.ply", "polydata_42_ascii.vtk", "ascii.vtp"})
    outcome_of(scratch.write(name, "\xef\xbb\xbf" + bytes_of_file(sample(name))));
  expect_small(read_particles(scratch.write("f.vtk", "\xef\xbb\xbf" + bytes_of_file(sample("polydata_42_ascii.vtk")))),
               false);
}

TEST(HugeLines, TakeNoMoreThanAFewTimesTheirBytes) {
  const Scratch scratch;
  constexpr std::size_t kLength = std::size_t{4} << 20;
  std::string words;
  while (words.size() < kLength) words += "a ";
  const std::string ply = bytes_of_file(sample("mesh_ascii.ply"));
  const std::string vtk = bytes_of_file(sample("polydata_42_ascii.vtk"));
  const std::string xml = bytes_of_file(sample("ascii.vtp"));
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.ply", replaced(ply, "comment ", "comment " + words)},
      {"b.ply", replaced(ply, "property float x", "property float x" + words)},
      {"c.ply", replaced(ply, "element vertex", "element " + words)},
      {"d.ply", replaced(ply, "property float x", "property float " + std::string(kLength, 'x'))},
      {"a.vtk", replaced(vtk, "vtk output", words)},
      {"b.vtk", replaced(vtk, "SCALARS rho double", "SCALARS rho double " + words)},
      {"c.vtk", replaced(vtk, "SCALARS rho", "SCALARS " + std::string(kLength, '%'))},
      {"d.vtk", replaced(vtk, "POINTS", "METADATA\n" + words)},
      {"a.vtp", replaced(xml, "Name=\"", "Name=\"" + words)},
      {"b.vtp", replaced(xml, "type=\"PolyData\"", "type=\"" + words + "\"")},
      {"a.csv", words + "\n1,2,3\n"},
      {"b.csv", "x,y,z\n1,2," + std::string(kLength, '3') + "\n"},
      {"c.csv", "x,y,z\n" + words},
      {"d.xyz", std::string(kLength, ' ')},
      {"e.npy", "\x93NUMPY\x02" + std::string("\0\0\0\x40\0", 5) + words}};
  for (const auto& [name, bytes] : files) {
    const std::string path = scratch.write(name, bytes);
    const std::uint64_t before = peak_rss_bytes();
    outcome_of(path);
#ifndef MENISCUS_SANITIZED
    EXPECT_LT(peak_rss_bytes() - before, std::uint64_t{64} << 20) << name;
#endif
    EXPECT_GT(before, 0u);
  }
}

/// One file of each format whose names hold bytes that are no UTF-8.
std::vector<std::pair<std::string, std::string>> files_with(const std::string& name) {
  ByteWriter bgeo;
  bgeo.text("BgeoV").put<std::int32_t>(5).put<std::int32_t>(1);
  for (const std::int32_t number : {0, 0, 0, 2, 0, 0, 0}) bgeo.put(number);
  bgeo.counted(name).put<std::uint16_t>(1).put<std::int32_t>(0).put(0.0f);
  bgeo.counted("kind").put<std::uint16_t>(1).put<std::int32_t>(4).put<std::int32_t>(1).counted(name);
  for (const float number : {1.0f, 2.0f, 3.0f, 1.0f, 7.0f}) bgeo.put(number);
  bgeo.put<std::int32_t>(0).text(std::string("\0\xff", 2));
  const std::string header = "{'descr': [('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('" + name + "', '<f4'), ('t" +
                             name + "', '|S4')], 'fortran_order': False, 'shape': (1,), }\n";
  ByteWriter npy(std::endian::little);
  npy.text("\x93NUMPY").put<std::uint8_t>(1).put<std::uint8_t>(0).put(static_cast<std::uint16_t>(header.size()));
  npy.text(header).put(1.0f).put(2.0f).put(3.0f).put(7.0f).text("abcd");
  std::string escaped;  // as VTK writes what is no letter
  for (const char c : name) {
    constexpr const char* kDigits = "0123456789ABCDEF";
    const auto byte = static_cast<unsigned char>(c);
    escaped += byte < 0x80 ? std::string(1, c) : std::string{'%', kDigits[byte >> 4], kDigits[byte & 15]};
  }
  const std::string vtk =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n1 2 3\nPOINT_DATA 1\n";
  const std::string xml =
      "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"1\"><Points><DataArray type=\"Float32\" "
      "NumberOfComponents=\"3\" format=\"ascii\">1 2 3</DataArray></Points><PointData><DataArray type=\"Float32\" "
      "format=\"ascii\" Name=\"";
  const std::string lines =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nproperty float ";
  return {{"f.bgeo", bgeo.bytes()},
          {"f.npy", npy.bytes()},
          {"f.vtk", vtk + "SCALARS " + name + " float\nLOOKUP_TABLE default\n7\n" + name + "\n"},
          {"g.vtk", vtk + "SCALARS " + escaped + " float\nLOOKUP_TABLE default\n7\n"},
          {"h.vtk", vtk + "FIELD f 2\n" + escaped + " 1 1 float\n7\nu" + name + " 1 2 int\n7 8\n"},
          {"f.vtp", xml + name + "\">7</DataArray></PointData></Piece></PolyData></VTKFile>"},
          {"f.ply", lines + name + "\nproperty list int int l" + name + "\nend_header\n1 2 3 7 0\n"},
          {"f.csv", "x,y,z," + name + "\n1,2,3,7\n"},
          {"f.xyz", "1\n" + name + "\n1 2 3 7\n"}};
}

TEST(NamesThatAreNoUtf8, AreMadeReadable) {
  const Scratch scratch;
  for (const char* name : {"caf\xe9", "\xff\xfe", "a\xc0\xaf", "\xed\xa0\x80z", "\xf5\x80\x80\x80", "b\xe2\x82"}) {
    ASSERT_FALSE(is_utf8(name));
    for (const auto& [file, bytes] : files_with(name)) {
      const Particles particles = read_particles(scratch.write(file, bytes));
      ASSERT_EQ(particles.size(), 1u) << file;
      EXPECT_EQ(particles.position(0), vec3(1, 2, 3)) << file;
      if (file != "f.xyz") EXPECT_GE(particles.attributes.size(), 1u) << file;
      for (const Attribute& attribute : particles.attributes) {
        EXPECT_TRUE(is_utf8(attribute.name)) << file;
        EXPECT_FALSE(attribute.name.empty()) << file;
      }
      for (const std::string& note : particles.notes) EXPECT_TRUE(is_utf8(note)) << file << ": " << note;
    }
  }
}

TEST(NamesThatAreNoUtf8, AreReadableInErrors) {
  const Scratch scratch;
  const std::string name = "caf\xe9\x01";
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 1\n";
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.ply", ply + "property " + name + " x\nend_header\n1\n"},
      {"b.ply", ply + name + "\nend_header\n"},
      {"c.ply", "ply\nformat ascii 1.0\nelement " + name + " 99999999\nproperty int a\nelement vertex 1\nend_header\n"},
      {"a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET " + name + "\n"},
      {"b.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 1 " + name + "\n"},
      {"a.vtp", "<VTKFile type=\"" + name + "\"></VTKFile>"},
      {"b.vtp", "<VTKFile type=\"PolyData\" header_type=\"" + name + "\"></VTKFile>"},
      {"a.npy", "\x93NUMPY\x01" + std::string(1, '\0') + "\x10" + std::string(1, '\0') + "{'descr': '" + name},
      {"a.csv", "x,y," + name + "\n1,2,3\n"},
      {"a.bgeo", std::string("BgeoV\0\0\0\5\0\0\0\1", 13) + std::string(15, '\0') + "\1" + std::string(12, '\0') +
                     std::string("\0\6", 2) + name + "\xe9\0\1\0\0\0\7"}};
  for (const auto& [file, bytes] : files) {
    const Error error = refused(scratch.write(file, bytes));
    EXPECT_TRUE(is_utf8(error.what())) << file;
  }
}

TEST(NamesThatAreNoUtf8, AreReadableInListsOfFrames) {
  const Scratch scratch;
  const std::string frame = "f_\xe9.xyz";
  scratch.write(frame, "1 2 3\n");
  const std::string list =
      scratch.write("f.pvd", "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"" + frame +
                                 "\"/><DataSet timestep=\"1\" file=\"gone_\xe9.xyz\"/></Collection></VTKFile>");
  const FrameSequence sequence = find_frames(std::vector<std::string>{list});
  ASSERT_EQ(sequence.frames.size(), 1u);
  EXPECT_EQ(read_frame(sequence, sequence.frames[0]).size(), 1u) << "the name of the file itself is kept as it is";
  ASSERT_EQ(sequence.notes.size(), 1u);
  EXPECT_TRUE(is_utf8(sequence.notes[0])) << sequence.notes[0];
}

}  // namespace
}  // namespace meniscus
