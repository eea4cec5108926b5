#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "bench_options.h"
#include "bench_timing.h"
#include "commands.h"
#include "json.h"
#include "meniscus/formulas/kernels.h"
#include "meniscus/render.h"

namespace meniscus::apps {
namespace {

struct DensityArguments {
  std::size_t particles = 150'000;
  int grid = 256;
  std::uint64_t seed = 1;
  int repeats = 7;
  int threads = 0;
  bool json = false;
};

/// The plain way in float: every particle adds its kernel to all points of its own box, one thread, unit masses.
std::vector<float> direct_density(const Particles& particles, const DensityOptions& options, const DensityGrid& grid) {
  const float h = 2.0f * options.spacing, volume = options.spacing * options.spacing * options.spacing;
  std::vector<float> density(grid.size(), 0.0f);
  const int n[] = {grid.nx, grid.ny, grid.nz};
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const vec3 centre = particles.position(p), place = (centre - grid.low) / grid.step, reach = h / grid.step;
    int first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = std::max(static_cast<int>(std::ceil(place[axis] - reach[axis])), 0);
      last[axis] = std::min(static_cast<int>(std::floor(place[axis] + reach[axis])), n[axis] - 1);
    }
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j) {
        float* row = density.data() +
                     (static_cast<std::size_t>(k) * static_cast<std::size_t>(grid.ny) + static_cast<std::size_t>(j)) *
                         static_cast<std::size_t>(grid.nx);
        for (int i = first[0]; i <= last[0]; ++i) {
          const float x = grid.low.x + static_cast<float>(i) * grid.step.x - centre.x,
                      y = grid.low.y + static_cast<float>(j) * grid.step.y - centre.y,
                      z = grid.low.z + static_cast<float>(k) * grid.step.z - centre.z;
          const float r2 = x * x + y * y + z * z;
          if (r2 < h * h) row[i] += volume * formulas::wyvill(std::sqrt(r2), h);
        }
      }
  }
  return density;
}

Json measure(const DensityArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  const Particles particles = synthetic_tank(arguments.particles, arguments.seed);
  DensityOptions options;
  options.spacing = *particles.spacing;
  options.keep_thin = false;  // unit masses, as in the paper and in the direct loop
  const Bounds box = particles.bounds().grown(2.0f * options.spacing);
  const DensityGrid grid{box.low, box.extent() / static_cast<float>(arguments.grid - 1), arguments.grid, arguments.grid,
                         arguments.grid};
  std::vector<double> splat_ms;
  std::size_t bytes = 0;
  for (int i = 0; i <= arguments.repeats; ++i) {  // the first one warms up
    const auto start = Clock::now();
    splat_density(
        particles, options, grid, [](int, int, std::span<const float>) {}, nullptr, &bytes);
    if (i > 0) splat_ms.push_back(ms_since(start));
  }
  std::sort(splat_ms.begin(), splat_ms.end());
  double direct_ms = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2; ++i) {
    const auto start = Clock::now();
    const std::vector<float> direct = direct_density(particles, options, grid);
    direct_ms = std::min(direct_ms, ms_since(start) + 0.0 * static_cast<double>(direct.back()));
  }
  const std::vector<float> fast = splat_density(particles, options, grid);
  const std::vector<double> plain = plain_density(particles, options, grid);
  double error = 0, size = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    error += (fast[i] - plain[i]) * (fast[i] - plain[i]);
    size += plain[i] * plain[i];
  }
  const double median = splat_ms[splat_ms.size() / 2];
  Json json;
  json["particles"] = particles.size();
  json["grid"] = arguments.grid;
  json["threads"] = thread_count();
  json["repeats"] = arguments.repeats;
  json["splat_ms"] = median;
  json["splat_best_ms"] = splat_ms.front();
  json["direct_ms"] = direct_ms;
  json["ratio"] = direct_ms / median;
  json["relative_difference"] = size > 0 ? std::sqrt(error / size) : 0.0;
  json["memory_bytes"] = bytes;
  return json;
}

void print(const Json& json) {
  std::cout << fmt::format("{} particles on {}^3 points, {} threads\n", json["particles"].get<std::size_t>(),
                           json["grid"].get<int>(), json["threads"].get<int>());
  std::cout << fmt::format("  splatted {:>10.1f} ms, the median of {}; {:.1f} ms at best\n",
                           json["splat_ms"].get<double>(), json["repeats"].get<int>(),
                           json["splat_best_ms"].get<double>());
  std::cout << fmt::format("  directly {:>10.1f} ms on one thread: {:.1f} times\n", json["direct_ms"].get<double>(),
                           json["ratio"].get<double>());
  std::cout << fmt::format("  relative difference {:.2g}; {:.2f} MB for slab, strips and clusters\n",
                           json["relative_difference"].get<double>(), json["memory_bytes"].get<double>() / 1e6);
}

}  // namespace

void add_bench_density(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("density", "The density of a wavy tank on a grid, by splatted discs");
  const auto arguments = std::make_shared<DensityArguments>();
  add_particles(*command, arguments->particles, 1, 100'000'000, "Particles in the tank (default: 150000)");
  command->add_option("--grid", arguments->grid, "Points along each axis of the grid (default: 256)")
      ->type_name("N")
      ->check(CLI::Range(2, 1024).description(""));
  add_seed(*command, arguments->seed);
  add_repeat(*command, arguments->repeats, "Runs that the median is taken of (default: 7)");
  add_threads(*command, arguments->threads);
  add_json(*command, arguments->json);
  command->footer(
      "splat_ms is the median time of the whole: sorting the particles and splatting all slabs. direct_ms is the "
      "better\n"
      "of two runs of a plain loop over each particle's own box, in float on one thread. relative_difference is the "
      "RMS\n"
      "of the difference to sums in double precision over the RMS of the density.");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
