/// What holds of a frame whatever the bytes were that it was read from.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "meniscus/base.h"

namespace meniscus {

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

inline void check(const Particles& particles) {
  require(particles.y.size() == particles.size() && particles.z.size() == particles.size(), "as many y and z as x");
  for (std::size_t i = 0; i < particles.size(); ++i)
    require(std::isfinite(particles.x[i]) && std::isfinite(particles.y[i]) && std::isfinite(particles.z[i]),
            "finite positions");
  for (const Attribute& attribute : particles.attributes)
    require(attribute.components > 0 &&
                attribute.values.size() == particles.size() * static_cast<std::size_t>(attribute.components),
            "as many values as particles");
}

}  // namespace meniscus
