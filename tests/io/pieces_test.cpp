// Frames longer than what is read at once: every value where it belongs, and no harm from files that change meanwhile.
#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>

#include "io/file_bytes.h"
#include "io/formats.h"
#include "io/raw.h"
#include "io/readers.h"
#include "small_frames.h"

namespace meniscus {
namespace {

constexpr std::size_t kCount = 100'003;  ///< 1.2 MB of positions: five pieces, and no length divides it

vec3 position_of(std::size_t i) {
  const auto f = static_cast<float>(i);
  return {0.25f * f, 1.0f - f, 3.0f + 0.5f * f};
}
vec3 velocity_of(std::size_t i) {
  const auto f = static_cast<float>(i);
  return {f + 0.125f, -f, 2.0f * f};
}
float density_of(std::size_t i) { return 1000.0f + static_cast<float>(i); }

Particles long_frame() {
  Particles particles;
  Attribute velocity{"velocity", 3, {}}, density{"density", 1, {}};
  for (std::size_t i = 0; i < kCount; ++i) {
    const vec3 p = position_of(i), v = velocity_of(i);
    particles.x.push_back(p.x);
    particles.y.push_back(p.y);
    particles.z.push_back(p.z);
    velocity.values.insert(velocity.values.end(), {v.x, v.y, v.z});
    density.values.push_back(density_of(i));
  }
  particles.attributes = {velocity, density};
  return particles;
}

/// Checks the positions, which were written `far` away, and what there is of velocity and density.
void expect_long(const Particles& particles, glm::dvec3 far = glm::dvec3(0.0)) {
  ASSERT_EQ(particles.size(), kCount);
  const Attribute *velocity = particles.find("velocity"), *density = particles.find("density");
  for (std::size_t i = 0; i < kCount; ++i) {
    ASSERT_EQ(glm::dvec3(particles.position(i)) + particles.origin, glm::dvec3(position_of(i)) + far) << i;
    if (velocity != nullptr) {
      const float* v = &velocity->values[3 * i];
      ASSERT_EQ(vec3(v[0], v[1], v[2]), velocity_of(i)) << i;
    }
    if (density != nullptr) {
      ASSERT_EQ(density->values[i], density_of(i)) << i;
    }
  }
}

/// Rows of position, velocity and density, each behind `before` bytes.
template <class T>
std::string rows(std::endian order, std::size_t before = 0, double far = 0) {
  ByteWriter out(order);
  for (std::size_t i = 0; i < kCount; ++i) {
    out.text(std::string(before, '\x7f'));
    const vec3 p = position_of(i), v = velocity_of(i);
    for (const float value : {p.x, p.y, p.z}) out.put(static_cast<T>(value + far));
    for (const float value : {v.x, v.y, v.z, density_of(i)}) out.put(static_cast<T>(value));
  }
  return out.bytes();
}

/// PLY of rows of an odd length.
template <class T>
std::string long_ply(std::endian order, double far = 0) {
  const std::string type = sizeof(T) == 8 ? "double" : "float";
  std::string text = "ply\nformat binary_";
  text += order == std::endian::big ? "big" : "little";
  text += "_endian 1.0\nelement vertex " + std::to_string(kCount) + "\nproperty uchar kind\n";
  for (const char* name : {"x", "y", "z", "vx", "vy", "vz", "rho"}) text += "property " + type + " " + name + "\n";
  return text + "end_header\n" + rows<T>(order, 1, far);
}

template <class T>
std::string long_vtk(double far = 0) {
  const std::string type = sizeof(T) == 8 ? "double" : "float", count = std::to_string(kCount);
  ByteWriter points, velocities, densities;
  for (std::size_t i = 0; i < kCount; ++i) {
    const vec3 p = position_of(i), v = velocity_of(i);
    for (const float value : {p.x, p.y, p.z}) points.put(static_cast<T>(value + far));
    for (const float value : {v.x, v.y, v.z}) velocities.put(static_cast<T>(value));
    densities.put(static_cast<T>(density_of(i)));
  }
  return "# vtk DataFile Version 4.1\nt\nBINARY\nDATASET POLYDATA\nPOINTS " + count + " " + type + "\n" +
         points.bytes() + "\nPOINT_DATA " + count + "\nVECTORS velocity " + type + "\n" + velocities.bytes() +
         "\nFIELD f 1\ndensity 1 " + count + " " + type + "\n" + densities.bytes() + "\n";
}

/// A structured array of rows.
std::string long_npy() {
  std::string text = "{'descr': [";
  for (const char* name : {"x", "y", "z", "vx", "vy", "vz", "rho"}) text += std::string("('") + name + "', '<f8'),";
  text += "], 'fortran_order': False, 'shape': (" + std::to_string(kCount) + ",)}\n";
  ByteWriter out(std::endian::little);
  out.text("\x93NUMPY").put<std::uint8_t>(1).put<std::uint8_t>(0).put(static_cast<std::uint16_t>(text.size()));
  return out.text(text).bytes() + rows<double>(std::endian::little);
}

/// Column after column, as Fortran stores N x 3.
std::string fortran_npy() {
  std::string text = "{'descr': '>f4', 'fortran_order': True, 'shape': (" + std::to_string(kCount) + ", 3)}\n";
  ByteWriter out;
  out.text("\x93NUMPY").put<std::uint8_t>(1).put<std::uint8_t>(0);
  out.put<std::uint8_t>(static_cast<std::uint8_t>(text.size())).put<std::uint8_t>(0).text(text);
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < kCount; ++i) out.put(position_of(i)[axis]);
  return out.bytes();
}

/// VTK XML of doubles, big-endian, appended raw, with bytes between that belong to nothing.
std::string long_vtu(double far) {
  const std::string count = std::to_string(kCount);
  ByteWriter points, densities;
  points.put(static_cast<std::uint64_t>(24 * kCount));
  densities.put(static_cast<std::uint64_t>(8 * kCount));
  for (std::size_t i = 0; i < kCount; ++i) {
    const vec3 p = position_of(i);
    for (const float value : {p.x, p.y, p.z}) points.put(value + far);
    densities.put(static_cast<double>(density_of(i)));
  }
  const std::string array = "<DataArray type=\"Float64\" format=\"appended\" ";
  return "<VTKFile type=\"UnstructuredGrid\" byte_order=\"BigEndian\" header_type=\"UInt64\"><UnstructuredGrid>"
         "<Piece NumberOfPoints=\"" +
         count + "\"><PointData>" + array + "Name=\"density\" offset=\"" + std::to_string(points.bytes().size() + 5) +
         "\"/></PointData><Points>" + array +
         "NumberOfComponents=\"3\" offset=\"0\"/></Points></Piece></UnstructuredGrid>"
         "<AppendedData encoding=\"raw\">_" +
         points.bytes() + "<none" + densities.bytes() + "</AppendedData></VTKFile>";
}

/// x, y, z and rho, contiguous; rho in chunks where the library has to read it.
void write_hdf5(const std::string& path) {
  const Particles frame = long_frame();
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t count = kCount, chunk = 5000;
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const auto write = [&](const char* name, hid_t type, hid_t plan, const std::vector<float>& values) {
    const hid_t dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, plan, H5P_DEFAULT);
    EXPECT_GE(H5Dwrite(dataset, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    H5Dclose(dataset);
  };
  write("x", H5T_IEEE_F32LE, H5P_DEFAULT, frame.x);
  write("y", H5T_IEEE_F32BE, H5P_DEFAULT, frame.y);
  write("z", H5T_IEEE_F64LE, H5P_DEFAULT, frame.z);
  write("density", H5T_IEEE_F32BE, H5P_DEFAULT, frame.find("density")->values);
  const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(plan, 1, &chunk);
  write("packed", H5T_IEEE_F32LE, plan, frame.x);
  H5Pclose(plan);
  H5Sclose(space);
  H5Fclose(file);
}

struct LongFile {
  std::string name;
  std::function<void(const std::string& path)> write;
  ReadOptions options{};
  glm::dvec3 far{0.0};
};

std::function<void(const std::string&)> writing(std::string bytes) {
  return [bytes](const std::string& path) { std::ofstream(path, std::ios::binary) << bytes; };
}

/// Every way in which the readers go through a file.
const std::vector<LongFile>& long_files() {
  static const std::vector<LongFile> files = [] {
    const auto written = [](const std::string& path) { write_particles(path, long_frame()); };
    constexpr double kAway = 5e6;
    ReadOptions raw;
    raw.raw = "f32bex7";
    ReadOptions none;
    return std::vector<LongFile>{
        {"f.vtp", written},
        {"f.npz", written},
        {"f.ply", written},
        {"f.bgeo", written},
        {"odd.ply", writing(long_ply<float>(std::endian::big))},
        {"double.ply", writing(long_ply<double>(std::endian::little, kAway)), none, glm::dvec3(kAway)},
        {"f.vtk", writing(long_vtk<float>())},
        {"double.vtk", writing(long_vtk<double>(kAway)), none, glm::dvec3(kAway)},
        {"f.npy", writing(long_npy())},
        {"fortran.npy", writing(fortran_npy())},
        {"f.vtu", writing(long_vtu(kAway)), none, glm::dvec3(kAway)},
        {"f.raw", writing(rows<float>(std::endian::big)), raw},
        {"f.hdf5", write_hdf5},
    };
  }();
  return files;
}

/// The error's code; none: it was read.
std::optional<ErrorCode> outcome_of_reading(const std::string& path, const ReadOptions& options) {
  try {
    read_particles(path, options);
    return std::nullopt;
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
    return error.code();
  }
}

TEST(LongFrames, AreReadValueByValue) {
  const Scratch scratch;
  for (const LongFile& file : long_files()) {
    SCOPED_TRACE(file.name);
    const std::string path = scratch.path(file.name);
    file.write(path);
    for (const int threads : {1, 2, 5}) {
      const ThreadLimit limit(threads);
      expect_long(read_particles(path, file.options), file.far);
    }
  }
}

/// As what comes out of gzip is read.
TEST(LongFrames, AreReadFromMemoryAsFromTheFile) {
  const Scratch scratch;
  for (const LongFile& file : long_files()) {
    if (file.name == "f.hdf5") continue;  // the library reads files
    SCOPED_TRACE(file.name);
    const std::string path = scratch.path(file.name);
    file.write(path);
    const std::string bytes = bytes_of_file(path);
    const io::Source source{path, bytes};
    Particles particles = file.options.raw.empty() ? io::format_of(source).read(source, file.options)
                                                   : io::read_raw(source, file.options);
    io::finish(file.options, particles);
    expect_long(particles, file.far);
  }
}

TEST(LongFrames, LoseParticlesThatAreNotFinite) {
  const Scratch scratch;
  Particles frame = long_frame();
  // On both sides of where pieces and blocks of 64 KiB may end, at both ends, and two in one particle.
  const std::vector<std::size_t> lost{0, 5460, 5461, 21844, 21845, 21846, 65535, 65536, kCount - 1};
  for (const std::size_t i : lost) (i % 2 == 0 ? frame.x : frame.z)[i] = i % 3 == 0 ? NAN : -INFINITY;
  frame.y[0] = INFINITY;
  for (const char* name : {"f.vtp", "f.npz", "f.ply", "f.bgeo"}) {
    write_particles(scratch.path(name), frame);
    const Particles kept = read_particles(scratch.path(name));
    ASSERT_EQ(kept.size(), kCount - lost.size()) << name;
    EXPECT_EQ(kept.dropped_non_finite, lost.size()) << name;
    const Attribute* density = kept.find("density");
    ASSERT_NE(density, nullptr);
    for (std::size_t i = 0, at = 0; i < kCount; ++i) {
      if (std::find(lost.begin(), lost.end(), i) != lost.end()) continue;
      ASSERT_EQ(kept.position(at), position_of(i)) << name;
      ASSERT_EQ(density->values[at++], density_of(i)) << name;
    }
  }
}

TEST(LongFrames, ThatEndEarlyAreRefused) {
  const Scratch scratch;
  for (const LongFile& file : long_files()) {
    const std::string path = scratch.path(file.name);
    file.write(path);
    const std::string bytes = bytes_of_file(path);
    for (const std::size_t size : {bytes.size() / 3, bytes.size() / 2, bytes.size() - 70'000}) {
      std::filesystem::resize_file(path, size);
      if (file.name == "f.raw") continue;  // any number of rows is a frame
      EXPECT_EQ(outcome_of_reading(path, file.options), ErrorCode::malformed_file) << file.name << " " << size;
      std::filesystem::remove(path);
      file.write(path);
    }
  }
}

TEST(LongFrames, OfNpzAreCheckedEverywhere) {
  const Scratch scratch;
  write_particles(scratch.path("f.npz"), long_frame());
  const std::string bytes = bytes_of_file(scratch.path("f.npz"));
  std::size_t read = 0;
  for (std::size_t at = 100; at < bytes.size() - 1000; at += 99'991) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    const Error error = refused(scratch.write("g.npz", damaged));
    EXPECT_EQ(error.code(), ErrorCode::malformed_file) << at;
    EXPECT_NE(std::string(error.what()).find("damaged"), std::string::npos) << at << ": " << error.what();
    ++read;
  }
  EXPECT_GT(read, 20u);
}

TEST(FileBytes, FetchesWhatIsAskedFor) {
  const Scratch scratch;
  std::string bytes(300'000, 'a');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7 + i / 251);
  const std::string path = scratch.write("f.bin", bytes);
  io::FileBytes file(path);
  const char* first = file.span().data();
  EXPECT_FALSE(file.has(first + 200'000, 10));
  file.fetch(first + 200'000, 10);
  EXPECT_TRUE(file.has(first + 200'000, 10));
  EXPECT_FALSE(file.has(first, 1));
  EXPECT_FALSE(file.has(first + 200'000 - io::kBlockBytes, 10 + io::kBlockBytes));
  EXPECT_EQ(std::string(first + 200'000, 10), bytes.substr(200'000, 10));
  file.fetch(first, bytes.size());
  EXPECT_EQ(std::string(first, bytes.size()), bytes);
  file.fetch(first + bytes.size(), 0);
}

#ifdef MENISCUS_ADDRESS_SANITIZER
TEST(FileBytesDeathTest, LetNobodyLookAtWhatWasNotFetched) {
  const Scratch scratch;
  io::FileBytes file(scratch.write("f.bin", std::string(10'000, 'a')));
  file.fetch(file.span().data(), 100);
  EXPECT_EQ(file.span()[99], 'a');
  EXPECT_DEATH(std::ofstream("/dev/null").put(file.span()[5000]), "use-after-poison");
}
#endif

TEST(FileBytes, OfAFileLargerThanMemoryAreFetchedInParts) {
#ifdef MENISCUS_ADDRESS_SANITIZER
  GTEST_SKIP() << "which stops the program where memory is refused";
#endif
  const Scratch scratch;
  const std::string path = scratch.write("f.hdf5", bytes_of_file(sample("tiny.hdf5")));
  std::error_code error;
  std::filesystem::resize_file(path, std::uintmax_t{1} << 41, error);
  if (error) GTEST_SKIP() << "no such files here: " << error.message();
  expect_small(read_particles(path), false);
  io::FileBytes bytes(path);
  EXPECT_FALSE(bytes.has(bytes.span().data(), 8));
  bytes.fetch(bytes.span().data(), 8);
  EXPECT_EQ(bytes.span()[1], 'H');
  EXPECT_THROW(bytes.fetch(bytes.span().data(), bytes.span().size()), std::bad_alloc);
}

TEST(FileBytes, KnowsTheSumOfWhatWasReadInPieces) {
  const Scratch scratch;
  std::string bytes(1'000'000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i >> 3);
  io::FileBytes file(scratch.write("f.bin", bytes));
  const char* first = file.span().data();
  file.keep_sums();
  std::string piece(70'000, '\0');
  // With gaps, overlaps, one inside of another, and beyond both ends of what is asked for.
  for (const std::size_t at : {5u, 40'000u, 300'000u, 370'000u, 800'000u})
    file.copy(first + at, {piece.data(), at == 40'000 ? 1000 : piece.size()});
  for (const auto& [begin, size] :
       {std::pair<std::size_t, std::size_t>{0, 1'000'000}, {5, 435'000}, {310'000, 1}, {7, 0}})
    EXPECT_EQ(file.crc32_of(first + begin, size), io::crc32_of(std::span<const char>(bytes).subspan(begin, size)));
}

TEST(FileBytes, ThatBecomeShorterAreAnError) {
  const Scratch scratch;
  const std::string path = scratch.write("f.bin", std::string(1'000'000, 'a'));
  io::FileBytes file(path);
  std::filesystem::resize_file(path, 600'000);
  const io::Source source = file.source();
  source.need(100'000, 1000);
  std::string target(500'000, '\0');
  try {
    file.copy(source.bytes.data() + 200'000, {target.data(), target.size()});
    FAIL() << "it was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::malformed_file);
    EXPECT_EQ(error.detail().path, path);
    EXPECT_EQ(error.detail().byte_offset, 600'000u);
  }
  EXPECT_THROW(source.need_all(), Error);
}

TEST(LongFrames, ThatShrinkAndGrowWhileTheyAreReadDoNoHarm) {
  const Scratch scratch;
  for (const LongFile& file : long_files()) {
    if (file.name == "f.hdf5") continue;  // the library's own business
    const std::string path = scratch.path(file.name);
    file.write(path);
    const auto size = std::filesystem::file_size(path);
    std::atomic<bool> done{false};
    std::thread changer([&] {
      for (std::size_t i = 0; !done; ++i) {
        std::filesystem::resize_file(path, i % 2 == 0 ? size * (i % 7) / 8 : size);
        std::this_thread::sleep_for(std::chrono::microseconds(200));
      }
    });
    for (int i = 0; i < 30; ++i) outcome_of_reading(path, file.options);
    done = true;
    changer.join();
  }
}

}  // namespace
}  // namespace meniscus
