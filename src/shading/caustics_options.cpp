#include "shading/caustics_options.h"

#include <fmt/format.h>
#include <cmath>

namespace meniscus {
namespace {

constexpr int kLargestScreen = 1 << 12;

void require(bool valid, const char* name, double value, const char* expected) {
  if (!valid)
    throw Error(ErrorCode::invalid_argument, {fmt::format("caustics cannot be drawn with this {}", name),
                                              expected,
                                              fmt::format("{}", value),
                                              {},
                                              {},
                                              {},
                                              {}});
}

}  // namespace

CausticsMethod caustics_method_of(std::string_view name) {
  if (name == "triangles") return CausticsMethod::triangles;
  if (name == "simple") return CausticsMethod::simple;
  if (name == "light_map") return CausticsMethod::light_map;
  if (name == "combined") return CausticsMethod::combined;
  throw Error(ErrorCode::invalid_argument, {"there is no such method of caustics",
                                            "triangles, simple, light_map or combined",
                                            std::string(name),
                                            {},
                                            {},
                                            {},
                                            {}});
}

void require_caustics(const CausticsOptions& options) {
  require(options.screen_width >= 0 && options.screen_width <= kLargestScreen, "screen width", options.screen_width,
          "0 .. 4096 px");
  require(options.screen_height >= 0 && options.screen_height <= kLargestScreen, "screen height", options.screen_height,
          "0 .. 4096 px");
  require(options.screen_width != 1 && options.screen_height != 1, "screen", 1, "at least 2 px a side");
  require(options.iterations >= 1 && options.iterations <= 256, "number of iterations", options.iterations, "1 .. 256");
  require(options.threshold >= 0 && std::isfinite(options.threshold), "threshold",
          static_cast<double>(options.threshold), "a length >= 0 m");
  require(
      options.map_size >= 0 && options.map_size <= kLargestScreen && (options.map_size == 0 || options.map_size > 15),
      "map size", options.map_size, "0, or 16 .. 4096 texels");
  require(options.most_lights >= 0, "number of lights", options.most_lights, ">= 0");
  for (const float constant : {options.simple_a, options.simple_b, options.simple_c})
    require(std::isfinite(constant), "constant of simple caustics", static_cast<double>(constant), "a finite number");
}

}  // namespace meniscus
