#include "particles/chosen.h"

namespace meniscus {

Particles chosen(const Particles& particles, const std::vector<std::uint8_t>& kept) {
  Particles result;
  result.time = particles.time;
  result.up = particles.up;
  result.spacing = particles.spacing;
  result.format = particles.format;
  result.dropped_non_finite = particles.dropped_non_finite;
  result.notes = particles.notes;
  const auto take = [&](const std::vector<float>& from, std::size_t components) {
    std::vector<float> to;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (!kept[i]) continue;
      for (std::size_t c = 0; c < components; ++c) to.push_back(from[i * components + c]);
    }
    return to;
  };
  result.x = take(particles.x, 1);
  result.y = take(particles.y, 1);
  result.z = take(particles.z, 1);
  for (const Attribute& attribute : particles.attributes) {
    result.attributes.push_back(
        {attribute.name, attribute.components, take(attribute.values, static_cast<std::size_t>(attribute.components))});
  }
  return result;
}

}  // namespace meniscus
