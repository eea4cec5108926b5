/// Clouds of particles, views and measures that the tests of this stage share. Everything comes from fixed seeds.
#pragma once

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>

#include "base/random.h"
#include "meniscus/surface.h"

namespace meniscus::surface_tests {

constexpr float kSpacing = 0.05f;  ///< m
constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Radius of a sphere of one particle's volume, in spacings.
constexpr double kDropRadius = 0.6203504908994;

/// Uniform numbers that are the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : draws_(seed) {}
  std::uint64_t bits() { return draws_.bits(); }
  float between(float low, float high) { return low + (high - low) * (static_cast<float>(bits() >> 40) * 0x1p-24f); }
  vec3 in_cube(float half) {
    const float x = between(-half, half), y = between(-half, half);
    return {x, y, between(-half, half)};
  }
  vec3 direction() {
    for (;;) {
      const vec3 v = in_cube(1.0f);
      const float size = glm::length(v);
      if (size > 0.1f && size < 1.0f) return v / size;
    }
  }

 private:
  Draws draws_;
};

inline void add(Particles& particles, vec3 p) {
  particles.x.push_back(p.x);
  particles.y.push_back(p.y);
  particles.z.push_back(p.z);
}

template <class F>
Particles moved(const Particles& particles, F f) {
  Particles result;
  for (std::size_t i = 0; i < particles.size(); ++i) add(result, f(particles.position(i)));
  return result;
}

/// nx x ny x nz particles of pitch kSpacing about the origin, each displaced by up to `jitter` spacings.
inline Particles lattice_box(int nx, int ny, int nz, float jitter = 0, std::uint64_t seed = 1) {
  Random random(seed);
  Particles result;
  const vec3 middle = 0.5f * vec3{nx - 1, ny - 1, nz - 1};
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) add(result, kSpacing * (vec3{x, y, z} - middle + random.in_cube(jitter)));
  return result;
}

/// Lattice points within `radius` spacings of a centre that is not a lattice point.
inline Particles lattice_ball(float radius, float jitter = 0) {
  Random random(2);
  Particles result;
  const vec3 centre{0.31f, 0.17f, 0.43f};
  const int reach = static_cast<int>(radius) + 2;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const vec3 p = vec3{x, y, z} - centre;
        if (glm::length(p) <= radius) add(result, kSpacing * (p + random.in_cube(jitter)));
      }
  return result;
}

/// Radius of the sphere of the particles' volume, m.
inline float radius_of_volume(std::size_t count) {
  return kSpacing * static_cast<float>(std::cbrt(static_cast<double>(count) * 3 / (4 * std::numbers::pi)));
}

/// A jittered tank with waves (z up), about 20 x 20 x 8 spacings, and drops of 1 to 30 particles above.
inline Particles wavy_tank(std::uint64_t seed = 3) {
  Random random(seed);
  Particles result;
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 20; ++y) {
      const int layers = 7 + static_cast<int>(std::lround(1.6f * std::sin(0.5f * static_cast<float>(x)) +
                                                          1.3f * std::cos(0.37f * static_cast<float>(y))));
      for (int z = 0; z < layers; ++z) add(result, kSpacing * (vec3{x - 10, y - 10, z - 5} + random.in_cube(0.2f)));
    }
  for (const int count : {1, 1, 1, 2, 2, 3, 5, 8, 13, 30}) {
    const vec3 centre{random.between(-8, 8), random.between(-8, 8), random.between(7, 13)};
    const float radius = 0.55f * std::cbrt(static_cast<float>(count));
    for (int i = 0; i < count; ++i) add(result, kSpacing * (centre + radius * random.in_cube(1.0f)));
  }
  return result;
}

/// Particles thrown at random into a cube of side * kSpacing.
inline Particles random_cloud(int count, float side, std::uint64_t seed) {
  Random random(seed);
  Particles result;
  for (int i = 0; i < count; ++i) add(result, kSpacing * random.in_cube(0.5f * side));
  return result;
}

/// Random blobs of random size and density: what breaks a rule that trusts cell counts.
inline Particles clumped_cloud(int count, float side, std::uint64_t seed) {
  Random random(seed);
  Particles result;
  while (static_cast<int>(result.size()) < count) {
    const vec3 centre = random.in_cube(0.5f * side);
    const float size = random.between(0.3f, 3.0f);
    const int members = 1 + static_cast<int>(random.bits() % 120);
    for (int i = 0; i < members; ++i) add(result, kSpacing * (centre + random.in_cube(size)));
  }
  return result;
}

inline RaycastOptions options(float spacing = kSpacing) {
  RaycastOptions result;
  result.spacing = spacing;
  return result;
}

/// The middle of the box from `direction` away, all of it in the picture.
inline View looking_at(const Bounds& box, vec3 direction, Projection projection, int width, int height) {
  const float radius = 0.5f * glm::length(box.extent()) + 1e-3f;
  const vec3 away = glm::normalize(direction), up{0.1f, 0.2f, 1.0f};
  const float wide = std::max(1.0f, static_cast<float>(height) / static_cast<float>(width));
  if (projection == Projection::orthographic)
    return orthographic_view(box.centre() + 2.0f * radius * away, box.centre(), up, 2.1f * radius * wide, width,
                             height);
  const float half_angle = 0.35f;
  return perspective_view(box.centre() + 1.05f * radius / std::sin(half_angle) * wide * away, box.centre(), up,
                          2.0f * half_angle, width, height);
}

inline Ray pixel_ray(const View& view, int x, int y) {
  return view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
}

inline double degrees_between(vec3 a, vec3 b) {
  const glm::dvec3 p(a), q(b);
  return std::atan2(glm::length(glm::cross(p, q)), glm::dot(p, q)) * 180 / std::numbers::pi;
}

/// Calls visit(x, y, ray, point) for the pixels where water was seen.
template <class Visit>
void for_each_hit(const View& view, const SurfaceBuffers& seen, Visit visit) {
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      if (!(seen.depth(x, y) < kInfinity)) continue;
      const Ray ray = pixel_ray(view, x, y);
      visit(x, y, ray, ray.origin + seen.depth(x, y) * ray.direction);
    }
}

inline std::size_t hits(const SurfaceBuffers& seen) {
  return static_cast<std::size_t>(
      std::count_if(seen.depth.begin(), seen.depth.end(), [](float d) { return d < kInfinity; }));
}

/// How two pictures of one surface differ.
struct Difference {
  std::size_t hits = 0;                  ///< of the first
  double mismatch = 0;                   ///< pixels where only one sees water, of all
  double depth_p99 = 0, depth_most = 0;  ///< spacings, over the pixels where both do
  double depth_p999 = 0;
  double normal_mean = 0, normal_p99 = 0;  ///< degrees
};

inline double quantile(std::vector<double>& values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

inline Difference difference(const SurfaceBuffers& a, const SurfaceBuffers& b, float spacing = kSpacing) {
  Difference result;
  std::vector<double> depths, normals;
  std::size_t mismatches = 0;
  EXPECT_EQ(a.depth.size(), b.depth.size());
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    const bool in_a = a.depth[i] < kInfinity, in_b = b.depth[i] < kInfinity;
    result.hits += in_a;
    mismatches += in_a != in_b;
    if (!in_a || !in_b) continue;
    depths.push_back(std::abs(static_cast<double>(a.depth[i]) - b.depth[i]) / spacing);
    if (!a.normal.empty() && !b.normal.empty()) {
      normals.push_back(degrees_between(a.normal[i], b.normal[i]));
      result.normal_mean += normals.back();
    }
  }
  if (!normals.empty()) result.normal_mean /= static_cast<double>(normals.size());
  result.mismatch = static_cast<double>(mismatches) / static_cast<double>(std::max<std::size_t>(a.depth.size(), 1));
  result.depth_p99 = quantile(depths, 0.99);
  result.depth_p999 = quantile(depths, 0.999);
  result.depth_most = quantile(depths, 1.0);
  result.normal_p99 = quantile(normals, 0.99);
  return result;
}

inline std::ostream& operator<<(std::ostream& out, const Difference& d) {
  return out << d.hits << " hits, mismatch " << d.mismatch << ", depth p99 " << d.depth_p99 << " p99.9 " << d.depth_p999
             << " most " << d.depth_most << " spacings, normals mean " << d.normal_mean << " p99 " << d.normal_p99
             << " degrees";
}

/// What holds for any buffers: unit normals and coverage 1 exactly where the depth is finite, thickness >= 0.
inline void expect_consistent(const SurfaceBuffers& seen) {
  std::size_t faults = 0;
  for (std::size_t i = 0; i < seen.depth.size(); ++i) {
    const float depth = seen.depth[i];
    const bool hit = depth < kInfinity;
    bool good = hit ? depth >= 0.0f : depth == kInfinity;
    good = good && seen.coverage[i] == (hit ? 1.0f : 0.0f);
    if (!seen.normal.empty()) {
      const float size = glm::length(seen.normal[i]);
      good = good && (hit ? std::abs(size - 1.0f) < 1e-4f : size == 0.0f);
    }
    if (!seen.thickness.empty()) good = good && seen.thickness[i] >= 0.0f && seen.thickness[i] < kInfinity;
    if (!seen.colour.empty() && hit)
      good = good && std::isfinite(seen.colour[i].x + seen.colour[i].y + seen.colour[i].z);
    faults += !good;
  }
  EXPECT_EQ(faults, 0u);
}

template <class T>
bool same_bits(const Image<T>& a, const Image<T>& b) {
  return a.width() == b.width() && a.height() == b.height() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline bool same_bits(const SurfaceBuffers& a, const SurfaceBuffers& b) {
  return same_bits(a.depth, b.depth) && same_bits(a.normal, b.normal) && same_bits(a.thickness, b.thickness) &&
         same_bits(a.colour, b.colour) && same_bits(a.coverage, b.coverage) && same_bits(a.entry, b.entry) &&
         same_bits(a.exit, b.exit) && a.eye_in_water == b.eye_in_water;
}

constexpr Kernel kKernels[] = {Kernel::cubic_spline, Kernel::poly6, Kernel::wyvill};
inline const char* name_of(Kernel kernel) {
  return kernel == Kernel::cubic_spline ? "cubic_spline" : kernel == Kernel::poly6 ? "poly6" : "wyvill";
}
constexpr Projection kProjections[] = {Projection::perspective, Projection::orthographic};

}  // namespace meniscus::surface_tests
