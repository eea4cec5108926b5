#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>

#include "io/file_bytes.h"
#include "io/frame_head.h"
#include "io/hdf5_layouts.h"
#include "io/join_pieces.h"
#include "io/readers.h"
#include "io/try_apart.h"

namespace meniscus::io {
namespace {

/// The library is not built for several threads everywhere.
std::mutex& hdf5_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// The values of a group's positions and of what else it knows of each particle, an array after the other.
/// @param bytes  of the same file; null: there are none
Particles read_group(Hdf5Particles& chosen, const FileBytes* bytes, const ReadOptions& options) {
  Particles particles;
  std::vector<Bytes> positions;
  for (const std::size_t place : chosen.found.places)
    positions.push_back(chosen.group.load(chosen.arrays[place], bytes));
  set_positions(chosen.arrays, chosen.found, options, particles);
  positions.clear();
  if (chosen.found.guessed)
    particles.notes.push_back(
        fmt::format("took the array '{}' for positions", chosen.arrays[chosen.found.places[0]].name));

  std::string left_out;
  for (std::size_t i = 0; i < chosen.arrays.size(); ++i) {
    NumberArray& array = chosen.arrays[i];
    const std::vector<std::size_t>& places = chosen.found.places;
    if (std::find(places.begin(), places.end(), i) != places.end()) continue;
    // Arrays that were not stored have no values.
    if (array.rows() == std::uint64_t{0} || chosen.found.count == 0) continue;
    const std::string why = why_no_attribute(array, chosen.found.count);
    if (why.empty()) {
      const Bytes values = chosen.group.load(array, bytes);
      particles.attributes.push_back(attribute_of(array));
    } else if (left_out.size() < 200) {
      left_out += fmt::format("{}'{}' {}", left_out.empty() ? "" : ", ", array.name.substr(0, 60), why);
    }
  }
  if (!left_out.empty()) particles.notes.push_back("left out arrays: " + left_out);
  return particles;
}

float median_of(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Edge of the cube of water that one particle stands for, from its mass m and density rho, where all have the
/// same mass and lie in three dimensions.
std::optional<float> spacing_of(const Particles& particles) {
  const Attribute* mass = particles.find("m");
  const Attribute* density = particles.find("rho");
  if (mass == nullptr || density == nullptr || mass->components != 1 || density->components != 1) return std::nullopt;
  const auto finite = [](const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
  };
  if (!finite(mass->values) || !finite(density->values)) return std::nullopt;
  const auto [least, most] = std::minmax_element(mass->values.begin(), mass->values.end());
  if (!(*least > 0 && *most < 1.01f * *least)) return std::nullopt;
  const auto flat = [](const std::vector<float>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *low == *high;
  };
  if (flat(particles.x) || flat(particles.y) || flat(particles.z)) return std::nullopt;
  const float spacing = std::cbrt(*least / median_of(density->values));
  if (!(std::isfinite(spacing) && spacing > 0)) return std::nullopt;
  return spacing;
}

/// s, where PySPH, Gadget and SWIFT, or a plain file write it.
std::optional<double> time_of(const Hdf5Group& file) {
  if (const std::optional<Hdf5Group> solver = file.group("solver_data"))
    if (const std::optional<double> time = solver->number("t")) return time;
  if (const std::optional<Hdf5Group> header = file.group("Header"))
    if (const std::optional<double> time = header->number("Time")) return time;
  for (const char* name : {"time", "Time", "t"})
    if (const std::optional<double> time = file.number(name)) return time;
  return std::nullopt;
}

/// Gadget and SWIFT may write a snapshot into several files.
void note_other_files(const Hdf5Group& file, Particles& particles) {
  const std::optional<Hdf5Group> header = file.group("Header");
  const double files = header ? header->number("NumFilesPerSnapshot").value_or(1) : 1;
  if (files > 1)
    particles.notes.push_back(fmt::format(
        "this file is one of {:.0f} of a snapshot: the others' particles are missing here; join them first", files));
}

/// Groups of a file that are read: the water, with options.boundaries what stands around it, too.
std::vector<std::size_t> chosen_of(const std::vector<Hdf5Particles>& candidates, const ReadOptions& options) {
  std::vector<std::size_t> chosen{0};
  for (std::size_t i = 1; options.boundaries && i < candidates.size(); ++i)
    if (candidates[i].is_boundary) chosen.push_back(i);
  return chosen;
}

/// What a copy of this process is asked to go through: two marks, the arrays of positions that are asked for, a zero,
/// the path.
std::string trial_of(const std::string& path, bool values, const ReadOptions& options) {
  std::string request{values ? 'v' : '-', options.boundaries ? 'b' : '-'};
  std::error_code unknown;  // the copy may stand in another directory
  const std::string whole = std::filesystem::absolute(path, unknown).string();
  return request + options.positions + '\0' + (unknown ? path : whole);
}

void go_through(std::string_view request) {
  const std::size_t zero = request.find('\0');
  const std::string path(request.substr(zero + 1));
  ReadOptions options;
  options.boundaries = request[1] == 'b';
  options.positions = request.substr(2, zero - 2);
  const Hdf5Group file = Hdf5Group::open_file(path);
  static_cast<void>(time_of(file));
  Particles notes;
  note_other_files(file, notes);
  std::vector<Hdf5Particles> candidates = particles_in(file, options, path);
  if (request[0] != 'v') return;
  const FileBytes bytes(path);  // values that stand in it as they are need no library
  for (const std::size_t i : chosen_of(candidates, options))
    for (NumberArray& array : candidates[i].arrays) try {
        static_cast<void>(candidates[i].group.load(array, &bytes));
      } catch (const Error&) {  // of one that holds no numbers, which is left out, or is met again
      }
}

/// Has a copy of this process go through the file first: on some damaged files the library crashes, or does not come to
/// an end, above all on those of its older form, which has no checksums.
/// @throws Error  malformed_file
void try_library(const std::string& path, bool values, const ReadOptions& options) {
  constexpr std::uintmax_t kSeconds = 20, kBytesASecond = 10'000'000, kDay = 86400;
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  const std::uintmax_t seconds = kSeconds + (unknown ? 0 : std::min(size / kBytesASecond, kDay));
  const std::optional<std::string> stopped =
      what_stops(go_through, trial_of(path, values, options), static_cast<int>(seconds));
  if (stopped)
    throw Error(ErrorCode::malformed_file, {"is damaged: the HDF5 library fails on it, " + *stopped,
                                            {},
                                            {},
                                            path,
                                            {},
                                            {},
                                            "write the frame anew, or save with h5dump what can be read"});
}

}  // namespace

void look_at_hdf5(const std::string& path, FrameHead& head) {
  const std::lock_guard lock(hdf5_mutex());
  const QuietHdf5 quiet;
  head.format = "hdf5";
  head.particles = head.file_bytes / (3 * sizeof(float));
  try_library(path, false, {});
  const Hdf5Group file = Hdf5Group::open_file(path);
  try {
    const std::vector<Hdf5Particles> candidates = particles_in(file, {}, path);
    const Hdf5Particles& water = candidates.front();
    double values = 0;
    for (const NumberArray& array : water.arrays)
      if (array.rows() == water.found.count) values += static_cast<double>(array.columns());
    head.particles = water.found.count;
    head.counted = true;
    if (water.found.count > 0) head.values = std::max(3.0, values);
  } catch (const Error& error) {
    // Options may name positions that nothing here tells of.
    if (error.code() != ErrorCode::unsupported) throw;
  }
}

Particles read_hdf5(const Source& start, const ReadOptions& options) {
  const std::string& path = start.path;
  const std::lock_guard lock(hdf5_mutex());
  const QuietHdf5 quiet;
  try_library(path, true, options);
  const Hdf5Group file = Hdf5Group::open_file(path);
  std::vector<Hdf5Particles> candidates = particles_in(file, options, path);
  const std::vector<std::size_t> chosen = chosen_of(candidates, options);
  Particles particles = join_pieces(chosen.size(), options, [&](std::size_t piece, const ReadOptions& reading) {
    return read_group(candidates[chosen[piece]], start.file, reading);
  });
  particles.format = "hdf5";
  particles.time = time_of(file);
  if (chosen.size() == 1) particles.spacing = spacing_of(particles);
  note_other_files(file, particles);
  std::string others;
  for (std::size_t i = 1; i < candidates.size(); ++i)
    if (std::find(chosen.begin(), chosen.end(), i) == chosen.end())
      others += fmt::format("{}'{}' ({})", others.empty() ? "" : ", ", candidates[i].name, candidates[i].found.count);
  if (!others.empty())
    particles.notes.push_back(fmt::format("read the group '{}' ({} particles), left out {}", candidates[0].name,
                                          candidates[0].found.count, others));
  return particles;
}

}  // namespace meniscus::io
