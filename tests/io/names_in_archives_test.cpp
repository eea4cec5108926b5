// Names in HDF5 and NPZ that are no UTF-8 or have control characters are made readable.
#include <hdf5.h>

#include <array>

#include "damage.h"

namespace meniscus {
namespace {

/// An HDF5 file of x, y, z and an attribute, of one particle.
std::string hdf5_with(const Scratch& scratch, const std::string& group_name, const std::string& name) {
  const std::string path = scratch.path("f.hdf5");
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, group_name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t count = 1;
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  float value = 0;
  for (const std::string& array : {std::string("x"), std::string("y"), std::string("z"), name}) {
    value += 1;
    const hid_t set = H5Dcreate2(group, array.c_str(), H5T_NATIVE_FLOAT, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value);
    H5Dclose(set);
  }
  H5Sclose(space);
  H5Gclose(group);
  H5Fclose(file);
  return path;
}

/// A stored NPZ of positions and an attribute, of one particle.
std::string npz_with(const Scratch& scratch, const std::string& name) {
  const auto npy = [](const std::string& shape, const std::vector<float>& values) {
    const std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': " + shape + ", }\n";
    ByteWriter out(std::endian::little);
    out.text("\x93NUMPY").put<std::uint8_t>(1).put<std::uint8_t>(0).put(static_cast<std::uint16_t>(header.size()));
    out.text(header);
    for (const float value : values) out.put(value);
    return out.bytes();
  };
  const std::vector<std::pair<std::string, std::string>> members{{"positions.npy", npy("(1, 3)", {1, 2, 3})},
                                                                 {name + ".npy", npy("(1,)", {4})},
                                                                 {"t" + name + ".npy", npy("(2, 1)", {5, 6})}};
  ByteWriter zip(std::endian::little), directory(std::endian::little);
  for (const auto& [member, bytes] : members) {
    const auto sum = static_cast<std::uint32_t>(
        ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
    const auto size = static_cast<std::uint32_t>(bytes.size());
    const auto at = static_cast<std::uint32_t>(zip.bytes().size());
    const auto length = static_cast<std::uint16_t>(member.size());
    zip.text("PK\x03\x04").put<std::uint16_t>(20).put<std::uint16_t>(0).put<std::uint16_t>(0).put<std::uint32_t>(0);
    zip.put(sum).put(size).put(size).put(length).put<std::uint16_t>(0).text(member).text(bytes);
    directory.text("PK\x01\x02").put<std::uint16_t>(20).put<std::uint16_t>(20).put<std::uint16_t>(0);
    directory.put<std::uint16_t>(0).put<std::uint32_t>(0).put(sum).put(size).put(size).put(length);
    directory.put<std::uint16_t>(0).put<std::uint16_t>(0).put<std::uint16_t>(0).put<std::uint16_t>(0);
    directory.put<std::uint32_t>(0).put(at).text(member);
  }
  const auto start = static_cast<std::uint32_t>(zip.bytes().size());
  const auto size = static_cast<std::uint32_t>(directory.bytes().size());
  zip.text(directory.bytes()).text("PK\x05\x06").put<std::uint32_t>(0).put<std::uint16_t>(3).put<std::uint16_t>(3);
  zip.put(size).put(start).put<std::uint16_t>(0);
  return scratch.write("f.npz", zip.bytes());
}

/// Names and what they become.
const std::vector<std::pair<std::string, std::string>> kNames{{"caf\xe9", "caf?"},
                                                              {"a\x01\x7f", "a??"},
                                                              {"\xff\xfe", "??"},
                                                              {"b\xe2\x82", "b??"},
                                                              {"gr\xc3\xbc\xc3\x9f", "grüß"}};

TEST(NamesInHdf5, AreMadeReadable) {
  const Scratch scratch;
  for (const auto& [name, readable] : kNames) {
    const Particles particles = read_particles(hdf5_with(scratch, "g" + name, name));
    ASSERT_EQ(particles.size(), 1u) << readable;
    EXPECT_EQ(particles.position(0), vec3(1, 2, 3));
    ASSERT_NE(particles.find(readable), nullptr) << readable;
    EXPECT_EQ(particles.find(readable)->values[0], 4.0f);
    for (const std::string& note : particles.notes)
      EXPECT_EQ(note.find(name == readable ? "?" : name), std::string::npos);
  }
}

TEST(NamesInHdf5, AreReadableInErrors) {
  const Scratch scratch;
  const std::string path = hdf5_with(scratch, "g", "caf\xe9\x01");
  ReadOptions options;
  options.positions = "/g/caf\xe9\x01";
  try {
    read_particles(path, options);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("caf??"), std::string::npos) << error.what();
  }
}

TEST(NamesInNpz, AreMadeReadable) {
  const Scratch scratch;
  for (const auto& [name, readable] : kNames) {
    const Particles particles = read_particles(npz_with(scratch, name));
    ASSERT_EQ(particles.size(), 1u) << readable;
    ASSERT_NE(particles.find(readable), nullptr) << readable;
    EXPECT_EQ(particles.find(readable)->values[0], 4.0f);
    ASSERT_EQ(particles.notes.size(), 1u);
    EXPECT_NE(particles.notes[0].find("'t" + readable + "' has 2 values"), std::string::npos) << particles.notes[0];
  }
}

TEST(NamesInNpz, AreReadableInErrors) {
  const Scratch scratch;
  ReadOptions options;
  options.positions = "none";
  try {
    read_particles(npz_with(scratch, "caf\xe9\x01"), options);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("caf??"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace meniscus
