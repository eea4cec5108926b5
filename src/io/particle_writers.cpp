#include "io/particle_writers.h"

namespace meniscus::io {

void check_lengths(const std::string& path, const Particles& particles) {
  const std::size_t count = particles.size();
  bool good = particles.y.size() == count && particles.z.size() == count;
  for (const Attribute& attribute : particles.attributes)
    good = good && attribute.components > 0 &&
           attribute.values.size() == count * static_cast<std::size_t>(attribute.components);
  if (!good)
    throw Error(ErrorCode::invalid_argument,
                {"the particles' arrays have different lengths", {}, {}, path, {}, {}, {}});
}

bool has_origin(const Particles& particles) { return particles.origin != glm::dvec3(0.0); }

}  // namespace meniscus::io
