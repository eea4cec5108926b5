/// The subcommands, one file each.
#pragma once

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>

namespace meniscus::apps {

/// Exit codes of the program.
constexpr int kSuccess = 0;
constexpr int kFailed = 1;      ///< a run that failed
constexpr int kWrongUsage = 2;  ///< arguments that cannot be meant

/// Arguments that CLI11 takes and that cannot be meant all the same.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Parses the arguments, runs what they ask for, and turns every exception into one line on stderr.
int run(int argc, char** argv);

// Each adds its subcommand, which runs when the arguments have been parsed.
void add_info(CLI::App& program);
void add_render(CLI::App& program);
void add_simulate(CLI::App& program);
void add_bench(CLI::App& program);
void add_bench_raycast(CLI::App& bench);
void add_bench_table1(CLI::App& bench);
void add_bench_temporal(CLI::App& bench);
void add_bench_caustics(CLI::App& bench);
void add_bench_density(CLI::App& bench);
void add_bench_refraction(CLI::App& bench);
void add_bench_point_sampled(CLI::App& bench);
void add_bench_simulate(CLI::App& bench);
void add_bench_tank(CLI::App& bench);
void add_bench_splash(CLI::App& bench);
void add_bench_ground(CLI::App& bench);
void add_bench_read(CLI::App& bench);
void add_compare(CLI::App& program);
void add_convert(CLI::App& program);

}  // namespace meniscus::apps
