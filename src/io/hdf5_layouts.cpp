#include "io/hdf5_layouts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr int kMostDepth = 6;             ///< of groups in groups
constexpr std::size_t kMostGroups = 512;  ///< that are looked at

struct Found {
  std::string path;  ///< "/particles/fluid/arrays"; "" for the root
  Hdf5Group group;
  std::vector<NumberArray> arrays;
};

/// An array of several values a particle in one dimension, as PySPH writes it, says so by a stride.
void apply_stride(const Hdf5Group& group, NumberArray& array) {
  if (array.shape.size() != 1) return;
  const double stride = group.number_of(array.name, "stride").value_or(1);
  if (!(stride > 1 && stride <= 4096) || stride != std::floor(stride)) return;
  const auto columns = static_cast<std::uint64_t>(stride);
  if (array.shape[0] % columns == 0) array.shape = {array.shape[0] / columns, columns};
}

/// Looks at a group and those in it, each once.
void walk(Hdf5Group group, const std::string& path, int depth, std::set<std::uint64_t>& seen,
          std::vector<Found>& groups) {
  if (depth > kMostDepth || seen.size() >= kMostGroups || !seen.insert(group.address()).second) return;
  std::vector<NumberArray> arrays;
  std::vector<std::pair<std::string, Hdf5Group>> inner;
  for (const std::string& name : group.names()) {
    if (std::optional<NumberArray> array = group.describe(name)) {
      apply_stride(group, *array);
      arrays.push_back(*std::move(array));
    } else if (std::optional<Hdf5Group> child = group.group(name)) {
      if (inner.size() < kMostGroups) inner.emplace_back(name, *std::move(child));
    }
  }
  if (!arrays.empty()) groups.push_back({path, std::move(group), std::move(arrays)});
  for (auto& [name, child] : inner) walk(std::move(child), path + "/" + name, depth + 1, seen, groups);
}

/// The less, the more a group's name speaks of water.
int rank_of(const std::string& name) {
  const std::string plain = lower(name);
  const auto has = [&](std::string_view word) { return plain.find(word) != std::string::npos; };
  if (plain == "fluid" || plain == "parttype0") return 0;  // Gadget's type 0 is gas, the particles of its SPH
  if (has("bound") || has("obstacle") || has("solid") || has("wall") || has("tank") || has("gate")) return 3;
  return has("fluid") || has("water") || has("liquid") ? 1 : 2;
}

/// "fluid" of "/particles/fluid/arrays".
std::string short_name(const std::string& path) {
  std::string_view name = path;
  if (name.starts_with("/particles/")) name.remove_prefix(11);
  if (name.ends_with("/arrays")) name.remove_suffix(7);
  if (name.starts_with("/")) name.remove_prefix(1);
  return std::string(name);
}

Error nothing_found(ErrorCode code, std::string problem, const std::vector<Found>& groups, const std::string& path) {
  std::vector<NumberArray> all;
  for (const Found& group : groups)
    for (NumberArray array : group.arrays) {
      array.name = group.path + "/" + array.name;
      all.push_back(std::move(array));
    }
  return {code,
          {std::move(problem), "x, y and z, or one of N x 3 called Coordinates, positions or pos", list_of(all), path,
           std::nullopt, std::nullopt, "name them: --positions /GROUP/ARRAY, or /GROUP/X,Y,Z"}};
}

/// The group and the arrays that the user named: "/PartType0/Coordinates", "/a/x,/a/y,/a/z", "/a/x,y,z".
Hdf5Particles asked(std::vector<Found> groups, const std::string& positions, const std::string& path) {
  std::string folder;
  std::vector<std::string> leaves;
  for (const std::string& name : split_names(positions)) {
    const std::size_t slash = name.find_last_of('/');
    if (slash != std::string::npos) {
      std::string before = name.substr(0, slash);
      if (!before.empty() && before[0] != '/') before = "/" + before;
      if (leaves.empty()) folder = before;
      if (before != folder)
        throw Error(ErrorCode::invalid_argument, {"the arrays of positions are in different groups",
                                                  {},
                                                  positions,
                                                  path,
                                                  std::nullopt,
                                                  std::nullopt,
                                                  "name arrays of one group"});
    }
    leaves.push_back(slash == std::string::npos ? name : name.substr(slash + 1));
  }
  for (Found& group : groups) {
    if (group.path != folder) continue;
    std::vector<std::size_t> places;
    for (const std::string& leaf : leaves)
      for (std::size_t i = 0; i < group.arrays.size(); ++i)
        if (group.arrays[i].name == leaf) places.push_back(i);
    if (places.size() != leaves.size()) break;
    PositionArrays found = asked_positions(group.arrays, std::move(places), path);
    return {short_name(group.path), std::move(group.group), std::move(group.arrays), std::move(found), false};
  }
  throw nothing_found(ErrorCode::invalid_argument, fmt::format("has no arrays '{}'", positions), groups, path);
}

}  // namespace

std::vector<Hdf5Particles> particles_in(const Hdf5Group& file, const ReadOptions& options, const std::string& path) {
  std::vector<Found> groups;
  std::set<std::uint64_t> seen;
  std::optional<Hdf5Group> root = file.group("/");
  if (root) walk(*std::move(root), "", 0, seen, groups);
  std::vector<Hdf5Particles> candidates;
  if (!options.positions.empty()) {
    candidates.push_back(asked(std::move(groups), options.positions, path));
    return candidates;
  }
  std::vector<Found*> guessed;
  for (Found& group : groups) {
    std::optional<PositionArrays> found = find_positions(group.arrays);
    if (!found) continue;
    if (found->guessed) {
      guessed.push_back(&group);
      continue;
    }
    const std::string name = short_name(group.path);
    candidates.push_back({name, std::move(group.group), group.arrays, *std::move(found), rank_of(name) == 3});
  }
  // An array of three columns under any name counts where it is the only one in the file.
  if (candidates.empty() && guessed.size() == 1) {
    Found& group = *guessed.front();
    PositionArrays found = *find_positions(group.arrays);
    candidates.push_back({short_name(group.path), std::move(group.group), group.arrays, std::move(found), false});
  }
  if (candidates.empty())
    throw nothing_found(ErrorCode::unsupported, "none of its arrays looks like positions", groups, path);
  std::stable_sort(candidates.begin(), candidates.end(), [](const Hdf5Particles& a, const Hdf5Particles& b) {
    const int rank_a = rank_of(a.name), rank_b = rank_of(b.name);
    return rank_a != rank_b ? rank_a < rank_b : a.found.count > b.found.count;
  });
  return candidates;
}

}  // namespace meniscus::io
