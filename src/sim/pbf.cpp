#include "sim/pbf.h"

namespace meniscus {

void fill_pbf_defaults(FluidOptions& options) {
  if (options.step == 0) options.step = 1.0f / 120.0f;
}
float longest_pbf_step(const FluidOptions&) { return 1.0f / 30.0f; }
std::unique_ptr<FluidSolver> make_pbf_solver(const FluidOptions& options) { return make_sph_solver(options); }

}  // namespace meniscus
