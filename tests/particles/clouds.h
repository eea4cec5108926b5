/// Particle clouds of known spacing. All are made from fixed seeds.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>

#include "meniscus/base.h"

namespace meniscus::clouds {

/// Uniform numbers that are the same on every machine (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t v = state_ += 0x9e3779b97f4a7c15;
    v = (v ^ v >> 30) * 0xbf58476d1ce4e5b9;
    v = (v ^ v >> 27) * 0x94d049bb133111eb;
    return v ^ v >> 31;
  }
  /// In [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  glm::dvec3 in_cube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  /// Normal distribution of standard deviation sigma in each direction.
  glm::dvec3 normal(double sigma) {
    const auto one = [&] {
      return sigma * std::sqrt(-2 * std::log(1 - unit())) * std::cos(2 * std::numbers::pi * unit());
    };
    const double x = one(), y = one();
    return {x, y, one()};
  }

 private:
  std::uint64_t state_;
};

inline void add(Particles& particles, glm::dvec3 p) {
  particles.x.push_back(static_cast<float>(p.x));
  particles.y.push_back(static_cast<float>(p.y));
  particles.z.push_back(static_cast<float>(p.z));
}

inline Particles joined(Particles a, const Particles& b) {
  for (std::size_t i = 0; i < b.size(); ++i) add(a, glm::dvec3(b.position(i)));
  return a;
}

/// Every particle moved by f.
template <class F>
Particles moved(const Particles& particles, F f) {
  Particles result;
  for (std::size_t i = 0; i < particles.size(); ++i) add(result, f(glm::dvec3(particles.position(i))));
  return result;
}

inline Particles shuffled(const Particles& particles, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::size_t> order(particles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.bits() % i]);
  Particles result;
  for (const std::size_t i : order) add(result, glm::dvec3(particles.position(i)));
  return result;
}

/// nx x ny x nz particles of pitch 1 about the origin, each displaced by up to `jitter` along every axis.
inline Particles cubic(int nx, int ny, int nz, double jitter = 0, std::uint64_t seed = 1) {
  Random random(seed);
  Particles result;
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) {
        add(result, glm::dvec3(x - 0.5 * (nx - 1), y - 0.5 * (ny - 1), z - 0.5 * (nz - 1)) + random.in_cube(jitter));
      }
    }
  }
  return result;
}

/// Face-centred cubic, one particle a unit of volume, in a cube of n^3.
inline Particles face_centred(int n) {
  const double a = std::cbrt(4.0);
  Particles result;
  for (int z = 0; z * a < n; ++z) {
    for (int y = 0; y * a < n; ++y) {
      for (int x = 0; x * a < n; ++x) {
        for (const glm::dvec3 o :
             {glm::dvec3(0, 0, 0), glm::dvec3(.5, .5, 0), glm::dvec3(.5, 0, .5), glm::dvec3(0, .5, .5)}) {
          add(result, (glm::dvec3(x, y, z) + o) * a);
        }
      }
    }
  }
  return result;
}

/// Hexagonal close packing, one particle a unit of volume (d^3 / sqrt 2 for spheres of diameter d).
inline Particles hexagonal(int n) {
  const double d = std::cbrt(std::sqrt(2.0));
  Particles result;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        add(result, d * glm::dvec3(i + 0.5 * ((j + k) % 2), std::sqrt(3.0) * 0.5 * (j + (k % 2) / 3.0),
                                   std::sqrt(6.0) / 3 * k));
      }
    }
  }
  return result;
}

/// The seeding of a FLIP solver: eight particles a cell of edge 2, anywhere in it.
inline Particles flip_seeds(int cells_x, int cells_y, int cells_z, std::uint64_t seed = 2) {
  Random random(seed);
  Particles result;
  for (int z = 0; z < cells_z; ++z) {
    for (int y = 0; y < cells_y; ++y) {
      for (int x = 0; x < cells_x; ++x) {
        for (int i = 0; i < 8; ++i) {
          add(result, 2.0 * glm::dvec3(x + random.unit(), y + random.unit(), z + random.unit()));
        }
      }
    }
  }
  return result;
}

/// A jittered lattice drawn together in pairs 0.1 apart.
inline Particles pairs(int n, std::uint64_t seed = 3) {
  Random random(seed);
  const Particles middles = cubic(n, n, n, 0.3, seed + 1);
  Particles result;
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const glm::dvec3 m = glm::dvec3(middles.position(i)) * std::cbrt(2.0);
    const glm::dvec3 o = random.in_cube(0.05);
    add(result, m + o);
    add(result, m - o);
  }
  return result;
}

/// FLIP seeds drawn together into clumps by a flow that converges and diverges over a few spacings.
inline Particles advected(int cells, double strength, std::uint64_t seed = 4) {
  Particles result = flip_seeds(cells, cells, cells, seed);
  Random random(seed + 1);
  for (int wave = 0; wave < 12; ++wave) {
    const glm::dvec3 direction = glm::normalize(random.normal(1));
    const double k = 2 * std::numbers::pi / random.between(4, 16), phase = random.between(0, 6.28);
    result = moved(result, [&](glm::dvec3 p) {
      return p + direction * (strength / k * std::sin(k * glm::dot(direction, p) + phase));
    });
  }
  return result;
}

/// Lattice points within `radius` of `centre`.
inline void add_drop(Particles& particles, glm::dvec3 centre, double radius) {
  const int n = static_cast<int>(radius);
  for (int z = -n; z <= n; ++z) {
    for (int y = -n; y <= n; ++y) {
      for (int x = -n; x <= n; ++x) {
        if (x * x + y * y + z * z <= radius * radius + 1e-9) add(particles, centre + glm::dvec3(x, y, z));
      }
    }
  }
}

/// Particles flying about alone in a box.
inline Particles spray(std::size_t count, glm::dvec3 low, glm::dvec3 high, std::uint64_t seed = 5) {
  Random random(seed);
  Particles result;
  for (std::size_t i = 0; i < count; ++i) {
    add(result, low + (high - low) * glm::dvec3(random.unit(), random.unit(), random.unit()));
  }
  return result;
}

/// A sheet of `layers` layers over n x n, turned out of the axes, each particle displaced by up to `jitter`.
inline Particles tilted_sheet(int n, int layers, double jitter = 0) {
  const glm::dvec3 u = glm::normalize(glm::dvec3(2, 1, 0.5)), w = glm::normalize(glm::cross(u, glm::dvec3(0.3, -1, 2)));
  const glm::dvec3 v = glm::cross(w, u);
  return moved(cubic(n, n, layers, jitter), [&](glm::dvec3 p) { return p.x * u + p.y * v + p.z * w; });
}

/// `layers` layers on a cylinder of `radius` about y, or a bowl of a sphere's middle band.
inline Particles cylinder(double radius, int height, int layers) {
  Particles result;
  const int around = static_cast<int>(2 * std::numbers::pi * radius);
  for (int y = 0; y < height; ++y) {
    for (int i = 0; i < around; ++i) {
      for (int l = 0; l < layers; ++l) {
        const double a = 2 * std::numbers::pi * i / around, r = radius + l;
        add(result, {r * std::cos(a), y, r * std::sin(a)});
      }
    }
  }
  return result;
}

/// A shallow pool, a crown of two layers, drops and spray.
inline Particles splash(std::uint64_t seed = 6) {
  Random random(seed);
  Particles result = moved(cubic(60, 5, 60, 0.2, seed), [](glm::dvec3 p) { return p - glm::dvec3(0, 3.5, 0); });
  result = joined(std::move(result), cylinder(15, 12, 2));
  for (int i = 0; i < 60; ++i) {
    add_drop(result, {random.between(-25, 25), random.between(15, 40), random.between(-25, 25)},
             random.between(1, 2.5));
  }
  return joined(std::move(result), spray(2000, {-30, 3, -30}, {30, 45, 30}, seed + 1));
}

/// Drops of 33 particles, none near another.
inline Particles drops(int n, std::uint64_t seed = 7) {
  Random random(seed);
  Particles result;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      add_drop(result, glm::dvec3(12 * i, 12 * j, 0) + random.in_cube(2), 2);
    }
  }
  return result;
}

}  // namespace meniscus::clouds
