#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>

#include "bench_options.h"
#include "bench_timing.h"
#include "commands.h"
#include "meniscus/sim.h"

namespace meniscus::apps {
namespace {

struct SimulateArguments {
  std::string solver = "sph";
  std::size_t particles = 3'000;
  int warm_up = 50;
  int steps = 100;
  int threads = 0;
  bool json = false;
};

/// A dam break: water in the left half of a tank of 2 : 1 : 1 m.
Simulation dam_break(const SimulateArguments& arguments) {
  SimulationOptions options;
  options.fluid.solver = solver_of(arguments.solver);
  options.tank = {{0, 0, 0}, {2, 1, 1}};
  options.blocks = {{{0, 0, 0}, {1, 0.6f, 1}}};
  options.fluid.spacing = static_cast<float>(std::cbrt(0.6 / static_cast<double>(arguments.particles)));
  options.most_particles = 2 * arguments.particles + 1000;
  return Simulation(options);
}

Json measure(const SimulateArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  Simulation simulation = dam_break(arguments);
  for (int i = 0; i < arguments.warm_up; ++i) simulation.step();
  StageTimes times;
  std::vector<double> steps;
  double neighbours = 0;
  for (int i = 0; i < arguments.steps; ++i) {
    const auto start = Clock::now();
    simulation.step(&times);
    steps.push_back(ms_since(start));
    neighbours += simulation.mean_neighbours();
  }
  double total = 0;
  for (const double ms : steps) total += ms;
  Json json;
  json["solver"] = arguments.solver;
  json["particles"] = simulation.size();
  json["steps"] = arguments.steps;
  json["step_size_s"] = json_of(simulation.step_size());
  json["threads"] = thread_count();
  json["step_ms"] = median(steps);
  Json stages;
  for (const auto& [stage, ms] : times.rows()) stages[stage] = ms / arguments.steps;
  json["stages_ms"] = stages;
  json["neighbours_mean"] = neighbours / arguments.steps;
  json["steps_per_second"] = 1000 * arguments.steps / total;
  return json;
}

void print(const Json& json) {
  std::cout << fmt::format("{}: {} particles, {} threads, steps of {} s\n", json["solver"].get<std::string>(),
                           json["particles"].get<std::size_t>(), json["threads"].get<int>(),
                           json["step_size_s"].dump());
  for (const auto& [stage, ms] : json["stages_ms"].items())
    std::cout << fmt::format("  {:<22}{:>10.3f} ms\n", stage, ms.get<double>());
  std::cout << fmt::format("  {:<22}{:>10.3f} ms, {:.1f} steps a second, {:.1f} neighbours a particle\n", "step",
                           json["step_ms"].get<double>(), json["steps_per_second"].get<double>(),
                           json["neighbours_mean"].get<double>());
}

}  // namespace

void add_bench_simulate(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("simulate", "Steps of a dam break");
  const auto arguments = std::make_shared<SimulateArguments>();
  command->add_option("--solver", arguments->solver, "sph or pbf (default: sph)")->type_name("NAME");
  add_particles(*command, arguments->particles, 100, 10'000'000, "Particles in the tank, about (default: 3000)");
  command->add_option("--steps", arguments->steps, "Steps that are measured (default: 100)")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000).description(""));
  command->add_option("--warm-up", arguments->warm_up, "Steps before them (default: 50)")
      ->type_name("N")
      ->check(CLI::Range(0, 1'000'000).description(""));
  add_threads(*command, arguments->threads);
  add_json(*command, arguments->json);
  command->footer("step_ms is the median of the steps, stages_ms are means, steps_per_second counts all of them.");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
