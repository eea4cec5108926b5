#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "io/frame_head.h"
#include "io/hdf5_handles.h"
#include "io/readers.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

/// The library is not built for several threads everywhere.
std::mutex& hdf5_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// The less, the more a group's name speaks of water.
int rank_of(const std::string& name) {
  const std::string plain = lower(name);
  const auto has = [&](std::string_view word) { return plain.find(word) != std::string::npos; };
  if (plain == "fluid") return 0;
  if (has("bound") || has("obstacle") || has("solid") || has("wall") || has("tank") || has("gate")) return 3;
  return has("fluid") || has("water") || has("liquid") ? 1 : 2;
}

struct Candidate {
  std::string name;
  Hdf5Group arrays;
  std::uint64_t count = 0;
};

/// The groups below /particles that have positions, the water first.
std::vector<Candidate> candidates_of(const Hdf5Group& particles) {
  std::vector<Candidate> candidates;
  for (const std::string& name : particles.names()) {
    const std::optional<Hdf5Group> group = particles.group(name);
    if (!group) continue;
    std::optional<Hdf5Group> arrays = group->group("arrays");
    if (!arrays) arrays = particles.group(name);
    const auto x = arrays->length_of("x"), y = arrays->length_of("y"), z = arrays->length_of("z");
    if (!x || !y || !z || *x != *y || *x != *z) continue;
    candidates.push_back({name, std::move(*arrays), *x});
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    const int rank_a = rank_of(a.name), rank_b = rank_of(b.name);
    return rank_a != rank_b ? rank_a < rank_b : a.count > b.count;
  });
  return candidates;
}

void read_attributes(const Hdf5Group& arrays, std::uint64_t count, Particles& particles) {
  for (const std::string& name : arrays.names()) {
    if (name == "x" || name == "y" || name == "z") continue;
    // Arrays that were not stored have no values; those of several values a particle say so by a stride.
    const std::optional<std::uint64_t> length = arrays.length_of(name);
    if (!length || *length == 0 || count == 0) continue;
    const double stride = arrays.number_of(name, "stride").value_or(1);
    if (!(stride >= 1 && stride <= 4096) || *length % static_cast<std::uint64_t>(stride) != 0 ||
        *length / static_cast<std::uint64_t>(stride) != count) {
      particles.notes.push_back(
          fmt::format("array '{}' has {} values for {} particles and was left out", name, *length, count));
      continue;
    }
    particles.attributes.push_back({name, static_cast<int>(stride), arrays.read(name)});
  }
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

/// The groups of a file that may be the water, at least one.
std::vector<Candidate> candidates_in(const Hdf5Group& file, const std::string& path) {
  const std::optional<Hdf5Group> groups = file.group("particles");
  std::vector<Candidate> candidates;
  if (groups) candidates = candidates_of(*groups);
  if (candidates.empty()) {
    throw Error(ErrorCode::unsupported, {"is HDF5, but not as PySPH writes it",
                                         "groups /particles/NAME/arrays with x, y, z",
                                         {},
                                         path,
                                         {},
                                         {},
                                         "export the particles as VTK, PLY or text"});
  }
  return candidates;
}

}  // namespace

void look_at_hdf5(const std::string& path, FrameHead& head) {
  const std::lock_guard lock(hdf5_mutex());
  const QuietHdf5 quiet;
  const std::vector<Candidate> candidates = candidates_in(Hdf5Group::open_file(path), path);
  const Candidate& water = candidates.front();
  std::uint64_t values = 0;
  for (const std::string& name : water.arrays.names()) values += water.arrays.length_of(name).value_or(0);
  head.format = "hdf5";
  head.particles = water.count;
  head.counted = true;
  if (water.count > 0) head.values = static_cast<double>(values) / static_cast<double>(water.count);
}

Particles read_hdf5(const Source& start, const ReadOptions& /*options*/) {
  const std::string& path = start.path;
  const std::lock_guard lock(hdf5_mutex());
  const QuietHdf5 quiet;
  const Hdf5Group file = Hdf5Group::open_file(path);
  const std::vector<Candidate> candidates = candidates_in(file, path);
  const Candidate& chosen = candidates.front();
  Particles particles;
  particles.format = "hdf5";
  particles.x = chosen.arrays.read("x");
  particles.y = chosen.arrays.read("y");
  particles.z = chosen.arrays.read("z");
  read_attributes(chosen.arrays, chosen.count, particles);
  if (const std::optional<Hdf5Group> solver = file.group("solver_data")) particles.time = solver->number("t");
  particles.spacing = spacing_of(particles);
  if (candidates.size() > 1) {
    std::string others;
    for (std::size_t i = 1; i < candidates.size(); ++i) {
      others += fmt::format("{}'{}' ({})", i > 1 ? ", " : "", candidates[i].name, candidates[i].count);
    }
    particles.notes.push_back(
        fmt::format("read the group '{}' ({} particles), left out {}", chosen.name, chosen.count, others));
  }
  return particles;
}

}  // namespace meniscus::io
