#include "io/attributes.h"

#include <algorithm>
#include <array>

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

/// Puts the joined attribute in the first one's place and takes the other two out.
void join(std::vector<Attribute>& attributes, std::string name, const Places& at) {
  attributes[at[0]] = joined(std::move(name), attributes[at[0]], attributes[at[1]], attributes[at[2]]);
  const auto offset = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
  attributes.erase(attributes.begin() + offset(std::max(at[1], at[2])));
  attributes.erase(attributes.begin() + offset(std::min(at[1], at[2])));
}

/// The places of three attributes of one component that `component` maps to `base` and 0, 1, 2.
template <class ComponentOf>
std::optional<Places> places_of(const std::vector<Attribute>& attributes, const std::string& base,
                                ComponentOf component) {
  constexpr std::size_t kNone = ~std::size_t{0};
  Places places{kNone, kNone, kNone};
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    if (attributes[i].components != 1) continue;
    const std::optional<Component> found = component(attributes[i].name);
    if (!found || found->base != base) continue;
    std::size_t& place = places[static_cast<std::size_t>(found->index)];
    if (place == kNone) place = i;
  }
  if (std::find(places.begin(), places.end(), kNone) != places.end()) return std::nullopt;
  return places;
}

std::optional<Component> uvw_of(std::string_view name) {
  if (name.size() == 1 && name[0] >= 'u' && name[0] <= 'w') return Component{"velocity", name[0] - 'u'};
  return std::nullopt;
}

void join_components(std::vector<Attribute>& attributes) {
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    const std::optional<Component> component =
        attributes[i].components == 1 ? component_of(attributes[i].name) : std::nullopt;
    if (!component || component->index != 0) continue;
    if (const auto places = places_of(attributes, component->base, component_of)) {
      // A second and third component that stand before the first move this one forward.
      const auto before = static_cast<std::size_t>(
          std::count_if(places->begin(), places->end(), [i](std::size_t place) { return place < i; }));
      if ((*places)[0] == i) {
        join(attributes, component->base, *places);
        i -= before;
      }
    }
  }
  if (const auto places = places_of(attributes, "velocity", uvw_of)) join(attributes, "velocity", *places);
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
  for (Attribute& attribute : attributes) {
    std::string name = common_name(attribute.name, attribute.components);
    const bool taken = std::any_of(attributes.begin(), attributes.end(),
                                   [&](const Attribute& other) { return &other != &attribute && other.name == name; });
    if (!taken) attribute.name = std::move(name);
  }
}

}  // namespace meniscus::io
