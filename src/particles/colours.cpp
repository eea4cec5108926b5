#include <algorithm>
#include <array>
#include <cmath>

#include "meniscus/particles.h"

namespace meniscus {
namespace {

constexpr std::size_t kGrain = 65536;
constexpr std::size_t kTable = 1024;  // colours of the map that are worked out once

bool is_colour(const Attribute& attribute) {
  return attribute.components == 3 &&
         (attribute.name == "color" || attribute.name == "colour" || attribute.name == "Cd");
}

[[noreturn]] void throw_unknown(const Particles& particles, const std::string& name) {
  std::string known;
  for (const Attribute& attribute : particles.attributes) known += (known.empty() ? "" : ", ") + attribute.name;
  ErrorDetail detail;
  detail.problem = "the particles have no such attribute";
  detail.expected = known.empty() ? "none at all, as the particles have only positions" : known;
  detail.found = "\"" + name + "\"";
  throw Error(ErrorCode::not_found, detail);
}

/// One number a particle: the value itself, or the length of a vector.
std::vector<float> magnitudes(const Attribute& attribute, std::size_t count) {
  const auto components = static_cast<std::size_t>(attribute.components);
  if (components == 1) return attribute.values;
  std::vector<float> result(count);
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0;
    for (std::size_t c = 0; c < components; ++c) sum += std::pow(double{attribute.values[i * components + c]}, 2);
    result[i] = static_cast<float>(std::sqrt(sum));
  }
  return result;
}

}  // namespace

std::vector<vec3> particle_colours(const Particles& particles, const ColourBy& by,
                                   std::pair<float, float>& range_used) {
  const Attribute* attribute = particles.find(by.attribute);
  if (!attribute) throw_unknown(particles, by.attribute);
  if (attribute->components < 1 ||
      attribute->values.size() != particles.size() * static_cast<std::size_t>(attribute->components)) {
    ErrorDetail detail;
    detail.problem = "attribute \"" + by.attribute + "\" does not have its values for every particle";
    detail.expected = std::to_string(particles.size()) + " x " + std::to_string(attribute->components);
    detail.found = std::to_string(attribute->values.size());
    throw Error(ErrorCode::invalid_argument, detail);
  }
  std::vector<vec3> colours(particles.size());
  if (is_colour(*attribute)) {
    range_used = {0.0f, 1.0f};
    for (std::size_t i = 0; i < colours.size(); ++i) {
      const float* c = &attribute->values[3 * i];
      for (int k = 0; k < 3; ++k) colours[i][k] = c[k] > 0 && std::isfinite(c[k]) ? c[k] : 0.0f;
    }
    return colours;
  }

  const std::vector<float> values = magnitudes(*attribute, particles.size());
  range_used = {0.0f, 1.0f};
  if (by.range) {
    range_used = *by.range;
  } else {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const float v : values) {
      if (!std::isfinite(v)) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
    if (low <= high) range_used = {low, high};
  }
  std::array<vec3, kTable + 1> table;
  for (std::size_t i = 0; i <= kTable; ++i) table[i] = colormap_at(by.colormap, static_cast<float>(i) / kTable);
  const double low = range_used.first, width = double{range_used.second} - low;
  parallel_for(colours.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      // One value for all is the middle of the map; NaN is its lower end.
      const double t = width != 0 ? (values[i] - low) / width : 0.5;
      colours[i] = table[static_cast<std::size_t>((t > 0 ? std::min(t, 1.0) : 0.0) * kTable + 0.5)];
    }
  });
  return colours;
}

}  // namespace meniscus
