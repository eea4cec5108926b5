#include "merged_particles.h"

#include <algorithm>
#include <cmath>

namespace meniscus::apps {

MergedParticles merged_particles(const Particles& particles, float spacing, int range) {
  constexpr int kCubesInSlab = 12;
  MergedParticles result;
  const auto put = [&](vec3 at, float s) {
    result.particles.x.push_back(at.x);
    result.particles.y.push_back(at.y);
    result.particles.z.push_back(at.z);
    result.spacing.push_back(s);
  };
  // Cubes by their coordinates, 21 bits each.
  const vec3 low = particles.bounds().low;
  const float per_edge = 1.0f / (static_cast<float>(range) * spacing);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> cubes;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const vec3 cube = (particles.position(i) - low) * per_edge;
    const auto x = static_cast<std::uint64_t>(cube.x), y = static_cast<std::uint64_t>(cube.y),
               z = static_cast<std::uint64_t>(cube.z);
    if (x / kCubesInSlab % 2 == 0)
      put(particles.position(i), spacing);
    else
      cubes.emplace_back((z << 42) + (y << 21) + x, static_cast<std::uint32_t>(i));
  }
  std::sort(cubes.begin(), cubes.end());
  for (std::size_t begin = 0; begin < cubes.size();) {
    std::size_t end = begin;
    vec3 sum{0.0f};
    for (; end < cubes.size() && cubes[end].first == cubes[begin].first; ++end)
      sum += particles.position(cubes[end].second) - low;
    const auto members = static_cast<float>(end - begin);
    put(low + sum / members, spacing * std::min(std::cbrt(members), static_cast<float>(range)));
    begin = end;
  }
  return result;
}

}  // namespace meniscus::apps
