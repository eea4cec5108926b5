#include "io/attributes.h"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>
#include <utility>

#include "io/text.h"

namespace meniscus::io {
namespace {

bool one_of(std::string_view word, std::span<const std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

constexpr std::array<std::string_view, 7> kPositions{"position", "positions", "pos", "p", "point", "points", "coord"};
constexpr std::array<std::string_view, 4> kVelocities{"velocity", "velocities", "vel", "v"};
constexpr std::array<std::string_view, 4> kDensities{"density", "densities", "rho", "rhop"};

std::string common_base(std::string_view base) {
  const std::string plain = lower(base);
  if (one_of(plain, kPositions)) return "position";
  if (one_of(plain, kVelocities)) return "velocity";
  if (plain == "n") return "normal";
  return std::string(base);
}

/// 0, 1, 2 for x, y, z and 0, 1, 2; -1 for anything else.
int index_of(char c) {
  if (c >= 'x' && c <= 'z') return c - 'x';
  if (c >= 'X' && c <= 'Z') return c - 'X';
  return c >= '0' && c <= '2' ? c - '0' : -1;
}

Attribute joined(std::string name, const Attribute& a, const Attribute& b, const Attribute& c) {
  Attribute result{std::move(name), 3, std::vector<float>(3 * a.values.size())};
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    result.values[3 * i] = a.values[i];
    result.values[3 * i + 1] = b.values[i];
    result.values[3 * i + 2] = c.values[i];
  }
  return result;
}

using Places = std::array<std::size_t, 3>;

std::optional<Component> uvw_of(std::string_view name) {
  if (name.size() == 1 && name[0] >= 'u' && name[0] <= 'w') return Component{"velocity", name[0] - 'u'};
  return std::nullopt;
}

/// The places of attributes of one component that belong together: `component` maps their names to one base and 0, 1,
/// 2. Of several of one name the first ones, then the second ones, and so on.
template <class ComponentOf>
std::vector<std::pair<std::string, Places>> triples_of(const std::vector<Attribute>& attributes,
                                                       ComponentOf component) {
  std::map<std::string, std::array<std::vector<std::size_t>, 3>> all;
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    if (attributes[i].components != 1) continue;
    if (const std::optional<Component> found = component(attributes[i].name))
      all[found->base][static_cast<std::size_t>(found->index)].push_back(i);
  }
  std::vector<std::pair<std::string, Places>> triples;
  for (const auto& [base, places] : all) {
    const std::size_t count = std::min({places[0].size(), places[1].size(), places[2].size()});
    for (std::size_t i = 0; i < count; ++i) triples.push_back({base, {places[0][i], places[1][i], places[2][i]}});
  }
  return triples;
}

/// Puts each joined attribute in the place of its first component and takes the other two out.
void join(std::vector<Attribute>& attributes, const std::vector<std::pair<std::string, Places>>& triples) {
  if (triples.empty()) return;
  std::vector<bool> taken(attributes.size());
  for (const auto& [base, at] : triples) {
    attributes[at[0]] = joined(base, attributes[at[0]], attributes[at[1]], attributes[at[2]]);
    for (const std::size_t place : {at[1], at[2]}) {
      taken[place] = true;
      attributes[place] = {};
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    if (taken[i]) continue;
    if (kept != i) attributes[kept] = std::move(attributes[i]);
    ++kept;
  }
  attributes.resize(kept);
}

void join_components(std::vector<Attribute>& attributes) {
  join(attributes, triples_of(attributes, component_of));
  std::vector<std::pair<std::string, Places>> velocities = triples_of(attributes, uvw_of);
  if (velocities.size() > 1) velocities.resize(1);
  join(attributes, velocities);
}

}  // namespace

std::optional<Component> component_of(std::string_view name) {
  if (name.size() == 1) {
    const int index = index_of(name[0]);
    if (index < 0 || name[0] <= '2') return std::nullopt;
    return Component{"position", index};
  }
  // Name[0], then Name:0 Name_0 Name.x "Name x", then vx nx velx.
  if (name.size() >= 4 && name.back() == ']' && name[name.size() - 3] == '[') {
    const int index = index_of(name[name.size() - 2]);
    if (index < 0) return std::nullopt;
    return Component{common_base(name.substr(0, name.size() - 3)), index};
  }
  const int index = name.empty() ? -1 : index_of(name.back());
  if (index < 0) return std::nullopt;
  constexpr std::string_view kJoints = ":_. ";
  if (name.size() >= 3 && kJoints.find(name[name.size() - 2]) != std::string_view::npos) {
    return Component{common_base(name.substr(0, name.size() - 2)), index};
  }
  const std::string base = common_base(name.substr(0, name.size() - 1));
  if (name.back() > '2' && (base == "velocity" || base == "position" || base == "normal")) {
    return Component{base, index};
  }
  return std::nullopt;
}

std::string common_name(std::string_view name, int components) {
  const std::string plain = lower(name);
  if (components == 3 && one_of(plain, kVelocities)) return "velocity";
  if (components == 1 && one_of(plain, kDensities)) return "density";
  return std::string(name);
}

void unify_names(std::vector<Attribute>& attributes) {
  join_components(attributes);
  std::unordered_map<std::string, std::size_t> uses;  // of each name
  for (const Attribute& attribute : attributes) ++uses[attribute.name];
  for (Attribute& attribute : attributes) {
    std::string name = common_name(attribute.name, attribute.components);
    if (name == attribute.name || uses[name] > 0) continue;
    --uses[attribute.name];
    ++uses[name];
    attribute.name = std::move(name);
  }
}

}  // namespace meniscus::io
