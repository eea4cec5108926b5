#include <fmt/format.h>

#include "sim/pbf.h"
#include "sim/sph.h"

namespace meniscus {
namespace {

void require(bool fine, const char* option, const char* expected, double found) {
  if (!fine)
    throw Error(
        ErrorCode::invalid_argument,
        {fmt::format("the fluid's {} is out of range", option), expected, fmt::format("{:g}", found), {}, {}, {}, {}});
}

void check(const FluidOptions& options) {
  const auto positive = [](float v) { return v > 0.0f && std::isfinite(v); };
  require(positive(options.spacing) && options.spacing >= 1e-5f && options.spacing <= 1e5f, "spacing",
          "0.00001 .. 100,000 m", options.spacing);
  const float support_rel = options.smoothing_length / options.spacing;
  require(options.smoothing_length == 0.0f || (support_rel >= 1.5f && support_rel <= 4.0f),
          "smoothing length in spacings", "1.5 .. 4 spacings", support_rel);
  require(options.step == 0.0f || positive(options.step), "step", "above 0 s", options.step);
  require(positive(options.rest_density), "rest density", "above 0 kg/m^3", options.rest_density);
  require(options.stiffness == 0.0f || positive(options.stiffness), "stiffness", "above 0 m^2/s^2", options.stiffness);
  require(std::isfinite(options.viscosity), "viscosity", "a finite number", options.viscosity);
  require(options.solver == Solver::sph || options.viscosity <= 1.0f, "viscosity", "0 .. 1 with pbf",
          options.viscosity);
  require(std::isfinite(options.surface_tension), "surface tension", "a finite number", options.surface_tension);
  require(options.iterations >= 1 && options.iterations <= 64, "number of iterations", "1 .. 64", options.iterations);
  require(std::isfinite(options.vorticity) && options.vorticity <= 100.0f, "vorticity confinement", "at most 100",
          options.vorticity);
  require(std::isfinite(length(options.gravity)), "gravity", "finite numbers", length(options.gravity));
}

/// Water of which a second would take for ever.
/// @param options  without gaps
/// @param given    the step that was asked for, s; 0: none
void check_pace(const FluidOptions& options, float given, float longest) {
  constexpr float kShortest = 1e-6f;  ///< s
  const float shortest = std::min(options.step, longest);
  if (shortest >= kShortest) return;
  std::string advice = "set a longer step, or none";
  if (!(given > 0 && given < kShortest))
    advice = options.solver == Solver::sph ? "take less stiffness, viscosity or surface tension, or a larger spacing"
                                           : "take less gravity or a larger spacing";
  throw Error(ErrorCode::invalid_argument, {"the fluid's steps are too short",
                                            fmt::format("at least {:g} s", kShortest),
                                            fmt::format("{:.3g} s", shortest),
                                            {},
                                            {},
                                            {},
                                            std::move(advice)});
}

}  // namespace

Solver solver_of(std::string_view name) {
  if (name == "sph") return Solver::sph;
  if (name == "pbf") return Solver::pbf;
  throw Error(ErrorCode::invalid_argument,
              {"there is no such solver", "sph or pbf", std::string(name), {}, {}, {}, {}});
}

FluidOptions with_defaults(FluidOptions options) {
  check(options);
  const float given = options.step;
  if (options.smoothing_length == 0.0f) options.smoothing_length = 2.0f * options.spacing;
  if (options.solver == Solver::sph)
    fill_sph_defaults(options);
  else
    fill_pbf_defaults(options);
  constexpr float kMostParts = 100.0f;
  const float longest = longest_stable_step(options);
  check_pace(options, given, longest);
  if (!(options.step <= kMostParts * longest))
    throw Error(ErrorCode::invalid_argument,
                {"the fluid's step is too long for its stiffness, viscosity and surface tension",
                 fmt::format("at most {:.3g} s, {:g} stable steps", kMostParts * longest, kMostParts),
                 fmt::format("{:g} s", options.step),
                 {},
                 {},
                 {},
                 "leave the step at 0, or set a smaller one"});
  return options;
}

float longest_stable_step(const FluidOptions& options) {
  check(options);
  FluidOptions filled = options;
  if (filled.smoothing_length == 0.0f) filled.smoothing_length = 2.0f * filled.spacing;
  if (filled.solver == Solver::pbf) return longest_pbf_step(filled);
  fill_sph_defaults(filled);
  return longest_sph_step(filled);
}

void Fluid::add(vec3 position, vec3 velocity) {
  x.push_back(position.x);
  y.push_back(position.y);
  z.push_back(position.z);
  vx.push_back(velocity.x);
  vy.push_back(velocity.y);
  vz.push_back(velocity.z);
}

}  // namespace meniscus
