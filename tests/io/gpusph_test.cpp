// Frames as GPUSPH's VTKWriter writes them: PolyData whose arrays are appended raw behind lengths of 32 bits, of which
// those of split vectors are four times too large, and a list that also names planes.
#include <fmt/format.h>

#include "damage.h"

namespace meniscus {
namespace {

/// Arrays that are described first and written behind all descriptions.
class Appender {
 public:
  explicit Appender(std::uint32_t claims) : claims_(claims), data_(std::endian::little) {}
  template <class T>
  void add(const std::string& type, const std::string& name, int components, const std::vector<T>& values,
           bool split = false) {
    head_ +=
        fmt::format("\t<DataArray type='{}' Name='{}'{} format='appended' offset='{}'/>\n", type, name,
                    components > 1 ? fmt::format(" NumberOfComponents='{}'", components) : "", data_.bytes().size());
    data_.put(static_cast<std::uint32_t>(values.size() * sizeof(T)) * (split ? claims_ : 1));
    for (const T value : values) data_.put(value);
  }
  std::string take_head() { return std::exchange(head_, {}); }
  const std::string& data() const { return data_.bytes(); }

 private:
  std::uint32_t claims_;  ///< how often the length of a part of a vector of four is what it should be
  std::string head_;
  ByteWriter data_;
};

/// The small frame, every third particle a boundary.
std::string gpusph_frame(std::uint32_t claims = 4) {
  constexpr int kCount = 3 * kSmallCount;
  std::vector<double> positions;
  std::vector<float> velocities, densities;
  std::vector<std::uint8_t> types;
  std::vector<std::uint16_t> flags;
  std::vector<std::uint32_t> ids;
  for (int i = 0; i < kCount; ++i) {
    for (int c = 0; c < 3; ++c)
      positions.push_back(static_cast<double>(small_position(i / 3)[c]) + (i % 3 == 1 ? 0 : 50));
    for (int c = 0; c < 3; ++c) velocities.push_back(small_velocity(i / 3)[c]);
    densities.push_back(1000.0f + static_cast<float>(i / 3));
    types.push_back(static_cast<std::uint8_t>(i % 3 == 1 ? 0 : i % 3 + 1));
    flags.push_back(0);
    ids.push_back(static_cast<std::uint32_t>(i));
  }
  Appender arrays(claims);
  std::string text =
      "<?xml version='1.0'?>\n<VTKFile type='PolyData'  version='0.1'  byte_order='LittleEndian'>\n <PolyData>\n" +
      fmt::format("  <Piece NumberOfPoints='{0}' NumberOfVerts='{0}'>\n   <Points>\n", kCount);
  arrays.add("Float64", "Position", 3, positions, true);
  text += arrays.take_head() + "   </Points>\n   <PointData Scalars='Pressure' Vectors='Velocity'>\n";
  arrays.add("Float32", "Pressure", 1, densities);
  arrays.add("Float32", "Velocity", 3, velocities, true);
  arrays.add("Float32", "Density", 1, densities);
  arrays.add("Float32", "Gamma", 1, densities, true);
  arrays.add("UInt8", "Part type", 1, types);
  arrays.add("UInt16", "Part flags", 1, flags);
  arrays.add("UInt32", "Part id", 1, ids);
  text += arrays.take_head() + "   </PointData>\n   <Verts>\n";
  arrays.add("UInt32", "connectivity", 1, ids);
  arrays.add("UInt32", "offsets", 1, ids);
  text += arrays.take_head() + "   </Verts>\n  </Piece>\n </PolyData>\n <AppendedData encoding='raw'>\n_";
  return text + arrays.data() + " </AppendedData>\n</VTKFile>\n";
}

const std::string kPlanes =
    "<?xml version='1.0'?>\n<VTKFile type='UnstructuredGrid'  version='0.1'  byte_order='LittleEndian'>\n "
    "<UnstructuredGrid>\n  <Piece NumberOfPoints='1' NumberOfCells='1 '>\n   <Points>\n<DataArray type='Float64' "
    "NumberOfComponents='3'>\n0 0 0\n</DataArray>\n   </Points>\n  </Piece>\n </UnstructuredGrid>\n</VTKFile>\n" +
    std::string(5000, '\n');

TEST(Gpusph, FluidIsKeptAndTheRestIsNoted) {
  const Scratch scratch;
  for (const std::uint32_t claims : {1u, 4u}) {
    const std::string path = scratch.write("PART_00000.vtp", gpusph_frame(claims));
    const Particles particles = read_particles(path);
    expect_small(particles);
    EXPECT_TRUE(std::any_of(particles.notes.begin(), particles.notes.end(), [](const std::string& note) {
      return note.find("14 of 21 particles were left out: their Part type") != std::string::npos;
    }));
    ReadOptions all;
    all.boundaries = true;
    EXPECT_EQ(read_particles(path, all).size(), 21u);
    ReadOptions boundary;
    boundary.where = "'Part type'==1";
    EXPECT_EQ(read_particles(path, boundary).size(), 7u);
  }
  EXPECT_EQ(refused(scratch.write("f.vtp", gpusph_frame(3))).code(), ErrorCode::malformed_file);
}

TEST(Gpusph, FourfoldLengthsCountOnlyWhereTheNextArrayBegins) {
  const auto frame_of = [](int count) {
    return fmt::format(
               "<VTKFile type='PolyData' byte_order='LittleEndian'><PolyData><Piece NumberOfPoints='{}'><Points>"
               "<DataArray type='Float32' NumberOfComponents='3' format='appended' offset='0'/></Points></Piece>"
               "</PolyData><AppendedData encoding='raw'>_",
               count) +
           ByteWriter(std::endian::little).put<std::uint32_t>(240).bytes() + std::string(240, '\0') +
           "</AppendedData></VTKFile>";
  };
  const Scratch scratch;
  EXPECT_EQ(read_particles(scratch.write("f.vtp", frame_of(20))).size(), 20u);
  for (const int count : {0, 3, 5})
    EXPECT_EQ(refused(scratch.write("f.vtp", frame_of(count))).code(), ErrorCode::malformed_file) << count;
}

TEST(Gpusph, TakesTheParticlesAmongTheBlocksOfAList) {
  const Scratch scratch;
  scratch.write("PLANES.vtu", kPlanes);
  std::string list = "<?xml version='1.0'?>\n<VTKFile type='Collection' version='0.1'>\n <Collection>\n";
  for (const int i : {0, 1}) {
    scratch.write(fmt::format("PART_0000{}.vtp", i), gpusph_frame());
    list += fmt::format(
        "  <DataSet timestep='{0}.25' group='0' name='Planes' file='PLANES.vtu'/>\n"
        "  <DataSet timestep='{0}.25' group='1' name='Particles' file='PART_0000{0}.vtp'/>\n",
        i);
  }
  const std::string path = scratch.write("VTUinp.pvd", list + " </Collection>\n</VTKFile>\n");
  for (const std::string& argument : {path, scratch.path("")}) {
    const FrameSequence sequence = find_frames(std::vector<std::string>{argument});
    ASSERT_EQ(sequence.frames.size(), 2u) << argument;
    EXPECT_TRUE(sequence.frames[1].path.ends_with("PART_00001.vtp"));
    EXPECT_TRUE(sequence.frames[1].further.empty());
    const Particles particles = read_frame(sequence, sequence.frames[1]);
    expect_small(particles);
    EXPECT_EQ(particles.time, 1.25);
  }
}

TEST(Gpusph, DamagedIsReadOrRefused) {
  const std::string bytes = gpusph_frame();
  check_prefixes("f.vtp", bytes, bytes.find("_") + 100, 13);
  check_changed_bytes("f.vtp", bytes, 7);
}

}  // namespace
}  // namespace meniscus
