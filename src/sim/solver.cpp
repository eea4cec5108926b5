#include "meniscus/sim.h"

namespace meniscus {

Solver solver_of(std::string_view name) {
  if (name == "sph") return Solver::sph;
  if (name == "pbf") return Solver::pbf;
  throw Error(ErrorCode::invalid_argument, {"there is no such solver", "sph or pbf", std::string(name), {}, {}, {}, {}});
}

}  // namespace meniscus
