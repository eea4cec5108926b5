#include "render/frame_sizes.h"

#include <fmt/format.h>

#include <algorithm>

namespace meniscus {
namespace {

const Attribute& number_named(const Particles& particles, const std::string& name, std::string_view what) {
  std::string known;
  for (const Attribute& attribute : particles.attributes)
    if (attribute.components == 1) known += (known.empty() ? "" : ", ") + attribute.name;
  if (known.empty()) known = "none at all, as the particles have no numbers";
  const Attribute* found = particles.find(name);
  if (!found)
    throw Error(ErrorCode::not_found, {fmt::format("the particles have no such attribute for their {}", what),
                                       known,
                                       '"' + name + '"',
                                       {},
                                       {},
                                       {},
                                       {}});
  if (found->components != 1 || found->values.size() != particles.size())
    throw Error(ErrorCode::invalid_argument, {fmt::format("an attribute for {} has to be a number a particle", what),
                                              known,
                                              fmt::format("\"{}\" of {}", name, found->components),
                                              {},
                                              {},
                                              {},
                                              {}});
  return *found;
}

}  // namespace

FrameSizes frame_sizes(const Particles& particles, const SizesBy& by) {
  FrameSizes result;
  if (particles.empty()) return result;
  if (!by.radius.empty()) {
    result.spacing = number_named(particles, by.radius, "radii").values;
    for (float& length : result.spacing) length *= 2.0f;
  }
  if (!by.smoothing_length.empty())
    result.smoothing_length = number_named(particles, by.smoothing_length, "smoothing lengths").values;
  return result;
}

std::optional<std::string> note_on_radii(const Particles& particles) {
  for (const char* name : {"radius", "pscale"}) {
    const Attribute* radii = particles.find(name);
    if (!radii || radii->components != 1 || radii->values.empty()) continue;
    const auto [least, largest] = std::minmax_element(radii->values.begin(), radii->values.end());
    if (*least > 0 && *largest > 1.01f * *least && *largest < 1e30f)
      return fmt::format(
          "the particles have an attribute {} of {:.3g} to {:.3g}: --radius-attribute {} draws each at its own size",
          name, *least, *largest, name);
  }
  return std::nullopt;
}

}  // namespace meniscus
