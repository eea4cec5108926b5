#include "commands.h"
#include "freed_memory.h"

namespace meniscus::apps {

void add_bench(CLI::App& program) {
  CLI::App* bench = program.add_subcommand("bench", "Measure stages on made-up scenes");
  bench->require_subcommand(1);
  bench->parse_complete_callback([] { keep_freed_memory(); });
  add_bench_raycast(*bench);
  add_bench_table1(*bench);
  add_bench_temporal(*bench);
  add_bench_caustics(*bench);
  add_bench_density(*bench);
  add_bench_refraction(*bench);
  add_bench_point_sampled(*bench);
  add_bench_simulate(*bench);
  add_bench_tank(*bench);
  add_bench_splash(*bench);
  add_bench_ground(*bench);
  add_bench_read(*bench);
}

}  // namespace meniscus::apps
