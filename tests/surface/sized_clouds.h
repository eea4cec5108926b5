/// Clouds of particles of different sizes.
#pragma once

#include "surface/fixtures.h"

namespace meniscus::surface_tests {

/// Particles and their sizes.
struct Cloud {
  Particles particles;
  std::vector<float> spacing, smoothing_length;

  ParticleSizes sizes() const { return {spacing, smoothing_length}; }
  void put(vec3 at, float s) {
    add(particles, at);
    spacing.push_back(s);
  }
  /// A box of a lattice of spacing s, its points displaced by up to `jitter` spacings.
  void fill(vec3 low, vec3 high, float s, float jitter, Random& random) {
    for (float z = low.z + 0.5f * s; z < high.z; z += s)
      for (float y = low.y + 0.5f * s; y < high.y; y += s)
        for (float x = low.x + 0.5f * s; x < high.x; x += s) put(vec3{x, y, z} + s * random.in_cube(jitter), s);
  }
};

/// Two bodies of different resolution that touch: 1 to 3.
inline Cloud two_bodies() {
  Cloud cloud;
  Random random(3);
  cloud.fill({-0.6f, -0.3f, 0}, {0, 0.3f, 0.3f}, 0.05f, 0.1f, random);
  cloud.fill({0, -0.3f, 0}, {0.6f, 0.3f, 0.36f}, 0.15f, 0.1f, random);
  return cloud;
}

/// A drop of large particles over a pool of small ones.
inline Cloud drop_over_pool() {
  Cloud cloud;
  Random random(4);
  cloud.fill({-0.5f, -0.5f, 0}, {0.5f, 0.5f, 0.2f}, 0.05f, 0.15f, random);
  for (int i = 0; i < 40; ++i) cloud.put(vec3{0, 0, 0.55f} + random.in_cube(0.2f), 0.14f);
  return cloud;
}

/// Sizes of 1 to 3 thrown together, as many as fill a box by volume.
inline Cloud random_sizes(bool own_lengths = false) {
  Cloud cloud;
  Random random(5);
  float volume = 0;
  while (volume < 1.2f * 0.6f * 0.6f * 0.4f) {
    const float s = random.between(0.04f, 0.12f);
    cloud.put(random.in_cube(0.3f) * vec3{1, 1, 0.667f}, s);
    if (own_lengths) cloud.smoothing_length.push_back(s * random.between(1.7f, 2.6f));
    volume += s * s * s;
  }
  return cloud;
}

inline const Cloud& cloud_of(int which) {
  static const Cloud clouds[] = {two_bodies(), drop_over_pool(), random_sizes(), random_sizes(true)};
  return clouds[which];
}

}  // namespace meniscus::surface_tests
