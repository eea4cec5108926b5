#include "render/synthetic_waves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/synthetic_random.h"

namespace meniscus {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kWaves = 14;
constexpr float kJitter = 0.05f;           ///< spacings; more would be seen as ripples of the surface
constexpr double kMostCompression = 0.25;  ///< root mean square of how much waves squeeze the lattice sideways

[[noreturn]] void refuse(std::string problem, std::string expected, std::string found) {
  throw Error(ErrorCode::invalid_argument, {std::move(problem), std::move(expected), std::move(found), {}, {}, {}, {}});
}

double shortest_of(const WavesOptions& options) {
  return options.shortest > 0 ? options.shortest : std::max(options.size.x, options.size.z) / 8;
}

/// The lattice that the still water fills.
struct Lattice {
  std::size_t nx, ny, nz;
  double dx, dy, dz;  ///< m
};

Lattice lattice_of(const WavesOptions& options) {
  const vec3 size = options.size;
  const double spacing =
      std::cbrt(static_cast<double>(size.x) * size.y * size.z / static_cast<double>(options.particles));
  const auto along = [&](float side) { return static_cast<std::size_t>(std::max(1.0, std::round(side / spacing))); };
  Lattice lattice{along(size.x), along(size.y), along(size.z), 0, 0, 0};
  lattice.dx = size.x / static_cast<double>(lattice.nx);
  lattice.dy = size.y / static_cast<double>(lattice.ny);
  lattice.dz = size.z / static_cast<double>(lattice.nz);
  return lattice;
}

struct Moved {
  double x, y, z;     ///< m
  double vx, vy, vz;  ///< m/s
};

/// cosh(k y) / sinh(k h) and sinh(k y) / sinh(k h), also where k h is large.
struct Depth {
  double cosh_part, sinh_part;
};
Depth depth_of(double k, double y, double h) {
  const double rise = std::exp(k * (y - h)), fall = std::exp(-k * (y + h));
  const double divisor = 1 - std::exp(-2 * k * h);
  return {(rise + fall) / divisor, (rise - fall) / divisor};
}

/// Where the water of a still place is. Sideways it moves as the potential flow of the waves moves it, to first order
/// in their height; upwards the same at the place that it has moved to, so that what was the still surface is exactly
/// the surface of waves_height(), and the water below it keeps its volume exactly.
Moved moved(const std::vector<StandingWave>& waves, double depth, double x, double y, double z, double time) {
  Moved to{x, y, z, 0, 0, 0};
  for (const StandingWave& w : waves) {
    const double along = w.amplitude * depth_of(w.k, y, depth).cosh_part / w.k;
    const double swing = std::cos(w.omega * time + w.phase);
    const double swing_rate = -w.omega * std::sin(w.omega * time + w.phase);
    const double sx = -w.kx * std::sin(w.kx * x) * std::cos(w.kz * z) * along;
    const double sz = -w.kz * std::cos(w.kx * x) * std::sin(w.kz * z) * along;
    to.x += sx * swing;
    to.z += sz * swing;
    to.vx += sx * swing_rate;
    to.vz += sz * swing_rate;
  }
  for (const StandingWave& w : waves) {
    const double up = w.amplitude * depth_of(w.k, y, depth).sinh_part;
    const double swing = std::cos(w.omega * time + w.phase);
    const double swing_rate = -w.omega * std::sin(w.omega * time + w.phase);
    const double cx = std::cos(w.kx * to.x), cz = std::cos(w.kz * to.z);
    to.y += up * cx * cz * swing;
    to.vy += up * (cx * cz * swing_rate -
                   (w.kx * std::sin(w.kx * to.x) * cz * to.vx + w.kz * cx * std::sin(w.kz * to.z) * to.vz) * swing);
  }
  return to;
}

}  // namespace

void check_waves(const WavesOptions& options) {
  if (options.particles < 1) refuse("waves need one particle at least", "1 or more", "0");
  const vec3 size = options.size;
  if (!(std::min({size.x, size.y, size.z}) > 0 && std::max({size.x, size.y, size.z}) < 1e6f))
    refuse("the tank of waves has no size", "three lengths above 0 m",
           fmt::format("{}, {}, {}", size.x, size.y, size.z));
  if (!(options.height >= 0 && options.height <= 0.8f * size.y))
    refuse("waves of this height do not fit their water", fmt::format("0 to {:.3g} m, 0.8 of the depth", 0.8f * size.y),
           fmt::format("{} m", options.height));
  if (!(shortest_of(options) >= 1e-4 * std::max(size.x, size.z) && std::isfinite(options.shortest)))
    refuse("the shortest wave is too short", "a ten-thousandth of the longer side",
           fmt::format("{} m", options.shortest));
  double compression = 0;
  for (const StandingWave& w : standing_waves(options)) {
    const double squeeze = w.amplitude * w.k / std::tanh(w.k * size.y);
    compression += squeeze * squeeze / 8;  // the mean of each cos^2 is 1/2
  }
  compression = std::sqrt(compression);
  if (compression > kMostCompression)
    refuse("waves of this height would break",
           fmt::format("up to {:.3g} m", options.height * kMostCompression / compression),
           fmt::format("{} m", options.height));
}

std::vector<StandingWave> standing_waves(const WavesOptions& options) {
  const double lx = options.size.x, lz = options.size.z, longer = std::max(lx, lz);
  const double longest = 2 * longer, shortest = std::min(shortest_of(options), longest);
  std::vector<StandingWave> waves;
  double sum = 0;
  for (int i = 0; i < kWaves; ++i) {
    // Wavelengths fall evenly on a logarithmic scale; directions are spread by the golden ratio.
    const double part = i / (kWaves - 1.0);
    const double k = 2 * kPi / (longest * std::pow(shortest / longest, part));
    const double golden = std::fmod(0.5 + 0.61803398875 * i, 1.0);
    const double angle = 0.5 * kPi * golden;
    double m = std::round(k * std::cos(angle) * lx / kPi), n = std::round(k * std::sin(angle) * lz / kPi);
    if (m == 0 && n == 0) (lx >= lz ? m : n) = 1;
    StandingWave wave;
    wave.kx = m * kPi / lx;
    wave.kz = n * kPi / lz;
    wave.k = std::hypot(wave.kx, wave.kz);
    wave.omega = std::sqrt(kGravity * wave.k * std::tanh(wave.k * options.size.y));
    wave.phase = 2 * kPi * std::fmod(0.3 + 0.754877666 * i, 1.0);
    wave.amplitude = 1 / std::sqrt(wave.k);
    sum += wave.amplitude;
    waves.push_back(wave);
  }
  for (StandingWave& wave : waves) wave.amplitude *= options.height / sum;
  return waves;
}

double waves_height(const std::vector<StandingWave>& waves, double x, double z, double time) {
  double height = 0;
  for (const StandingWave& w : waves)
    height += w.amplitude * std::cos(w.kx * x) * std::cos(w.kz * z) * std::cos(w.omega * time + w.phase);
  return height;
}

Particles synthetic_waves(const WavesOptions& options, double time) {
  check_waves(options);
  if (!std::isfinite(time)) refuse("waves at no time", "s", fmt::format("{}", time));
  const std::vector<StandingWave> waves = standing_waves(options);
  const Lattice lattice = lattice_of(options);
  const std::size_t layer = lattice.nx * lattice.nz, count = layer * lattice.ny;
  Particles particles;
  particles.format = "synthetic";
  particles.spacing = static_cast<float>(std::cbrt(lattice.dx * lattice.dy * lattice.dz));
  particles.up = Axis::y;
  particles.time = time;
  for (auto* axis : {&particles.x, &particles.y, &particles.z}) axis->resize(count);
  particles.attributes.push_back({"velocity", 3, std::vector<float>(3 * count)});
  std::vector<float>& velocity = particles.attributes.front().values;
  parallel_for(count, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Random random(0x9e3779b97f4a7c15u * (i + 1));
      const auto place = [&](std::size_t cell, double step) {
        return (static_cast<double>(cell) + 0.5 + random.between(-kJitter, kJitter)) * step;
      };
      const double x = place(i % lattice.nx, lattice.dx);
      const double z = place(i / lattice.nx % lattice.nz, lattice.dz);
      const double y = place(i / layer, lattice.dy);
      const Moved to = moved(waves, options.size.y, x, y, z, time);
      particles.x[i] = static_cast<float>(to.x);
      particles.y[i] = static_cast<float>(to.y);
      particles.z[i] = static_cast<float>(to.z);
      velocity[3 * i] = static_cast<float>(to.vx);
      velocity[3 * i + 1] = static_cast<float>(to.vy);
      velocity[3 * i + 2] = static_cast<float>(to.vz);
    }
  });
  return particles;
}

}  // namespace meniscus
