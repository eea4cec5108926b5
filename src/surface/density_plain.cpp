// Density on a regular grid as its definition says, in double precision: what the fast one is checked against.
#include <cmath>

#include "surface/raycast_field.h"

namespace meniscus {
namespace {

/// W(r, h) in 1/m^3, from the kernels' definitions.
double kernel_in_double(Kernel kernel, double r, double h) {
  constexpr double kPi = 3.14159265358979323846;
  const double q = r / h, volume = h * h * h;
  if (q >= 1) return 0;
  switch (kernel) {
    case Kernel::cubic_spline: {
      const double inner = std::max(0.5 - q, 0.0);
      return 8 / (kPi * volume) * (2 * std::pow(1 - q, 3) - 8 * std::pow(inner, 3));
    }
    case Kernel::poly6:
      return 315 / (64 * kPi * volume) * std::pow(1 - q * q, 3);
    case Kernel::wyvill:
      break;
  }
  const double a2 = q * q;
  return 2835 / (736 * kPi * volume) * (1 + a2 * (-22.0 / 9 + a2 * (17.0 / 9 - 4.0 / 9 * a2)));
}

/// One mass a particle by the rule of raycast_field.h, from plain sums over all pairs that are near.
std::vector<double> masses(const RaycastField& field) {
  const BandGrid& grid = field.grid;
  const RaycastOptions& options = field.options;
  std::vector<double> found(grid.size(), 1.0);
  if (!options.keep_thin) return found;
  const MassRule rule = mass_rule(options);
  const double h = options.smoothing_length, volume = std::pow(static_cast<double>(options.spacing), 3);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    double density = 0;
    const vec3 at = grid.position(i);
    grid.for_each_run(
        at - options.smoothing_length, at + options.smoothing_length, [&](std::size_t begin, std::size_t end) {
          for (std::size_t j = begin; j < end; ++j) {
            const double x = static_cast<double>(at.x) - grid.x()[j], y = static_cast<double>(at.y) - grid.y()[j],
                         z = static_cast<double>(at.z) - grid.z()[j];
            density += volume * kernel_in_double(options.kernel, std::sqrt(x * x + y * y + z * z), h);
          }
        });
    found[i] = mass_at(rule, static_cast<float>(density));
  }
  return found;
}

}  // namespace

std::vector<double> plain_density(const Particles& particles, const DensityOptions& given, const DensityGrid& grid) {
  RaycastOptions options;
  options.spacing = given.spacing;
  options.smoothing_length = given.smoothing_length;
  options.kernel = given.kernel;
  options.iso = given.iso;
  options.keep_thin = given.keep_thin;
  const RaycastField field = make_field(particles, options, {});
  const std::vector<double> mass = masses(field);
  const double h = field.options.smoothing_length, volume = std::pow(static_cast<double>(given.spacing), 3);
  std::vector<double> sums(grid.size(), 0.0);
  const int n[] = {grid.nx, grid.ny, grid.nz};
  for (std::size_t p = 0; p < field.grid.size(); ++p) {
    const vec3 at = field.grid.position(p);
    int first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double place = (static_cast<double>(at[axis]) - grid.low[axis]) / grid.step[axis];
      const double reach = h / grid.step[axis];
      first[axis] = static_cast<int>(std::clamp(std::floor(place - reach), 0.0, static_cast<double>(n[axis])));
      last[axis] = static_cast<int>(std::clamp(std::ceil(place + reach), -1.0, static_cast<double>(n[axis] - 1)));
    }
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j)
        for (int i = first[0]; i <= last[0]; ++i) {
          const double x = grid.low.x + i * static_cast<double>(grid.step.x) - at.x,
                       y = grid.low.y + j * static_cast<double>(grid.step.y) - at.y,
                       z = grid.low.z + k * static_cast<double>(grid.step.z) - at.z;
          const std::size_t point =
              (static_cast<std::size_t>(k) * static_cast<std::size_t>(grid.ny) + static_cast<std::size_t>(j)) *
                  static_cast<std::size_t>(grid.nx) +
              static_cast<std::size_t>(i);
          sums[point] += volume * mass[p] * kernel_in_double(given.kernel, std::sqrt(x * x + y * y + z * z), h);
        }
  }
  return sums;
}

}  // namespace meniscus
