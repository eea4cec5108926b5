#include "bench_read_files.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <bit>
#include <cstring>
#include <vector>

#include "base/temporary_file.h"
#include "io/npy_arrays.h"
#include "meniscus/io.h"

namespace meniscus::apps {
namespace {

std::vector<float> interleaved(const Particles& particles) {
  std::vector<float> values(3 * particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    values[3 * i] = particles.x[i];
    values[3 * i + 1] = particles.y[i];
    values[3 * i + 2] = particles.z[i];
  }
  return values;
}

std::span<const char> bytes_of(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), sizeof(float) * values.size()};
}

/// Big-endian, interleaved.
void write_legacy_vtk(const std::string& path, const Particles& particles) {
  TemporaryStream file(path);
  const auto text = [&](const std::string& words) { file.write({words.data(), words.size()}); };
  const auto vectors = [&](std::vector<float> values) {
    for (float& value : values) value = std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
    file.write(bytes_of(values));
  };
  text(fmt::format("# vtk DataFile Version 4.1\nwater\nBINARY\nDATASET POLYDATA\nPOINTS {} float\n", particles.size()));
  vectors(interleaved(particles));
  text(fmt::format("\nPOINT_DATA {}\nVECTORS velocity float\n", particles.size()));
  vectors(particles.find("velocity")->values);
  text("\n");
  file.commit();
}

/// The numbers of the positions, behind a header.
void write_plain(const std::string& path, const std::string& header, const Particles& particles) {
  TemporaryStream file(path);
  file.write({header.data(), header.size()});
  file.write(bytes_of(interleaved(particles)));
  file.commit();
}

/// Two arrays of N x 3, each in one piece.
void write_hdf5(const std::string& path, const Particles& particles) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t shape[2] = {particles.size(), 3};
  const hid_t space = H5Screate_simple(2, shape, nullptr);
  bool whole = file >= 0;
  const auto write = [&](const char* name, const std::vector<float>& values) {
    const hid_t array = H5Dcreate2(file, name, H5T_IEEE_F32LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    whole = whole && H5Dwrite(array, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0;
    H5Dclose(array);
  };
  write("positions", interleaved(particles));
  write("velocity", particles.find("velocity")->values);
  H5Sclose(space);
  if (H5Fclose(file) < 0 || !whole)
    throw Error(ErrorCode::io_failed, {"cannot write the file", {}, {}, path, {}, {}, {}});
}

}  // namespace

void write_for_bench(const std::string& format, const std::string& path, const Particles& particles) {
  if (format == "vtk") {
    write_legacy_vtk(path, particles);
  } else if (format == "hdf5") {
    write_hdf5(path, particles);
  } else if (format == "npy") {
    write_plain(path, io::npy_header("<f4", std::vector<std::uint64_t>{particles.size(), 3}), particles);
  } else if (format == "raw") {
    write_plain(path, {}, particles);
  } else {
    write_particles(path, particles);
  }
}

}  // namespace meniscus::apps
