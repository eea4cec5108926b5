#include <fmt/format.h>
#include <fmt/ranges.h>

#include "meniscus/shading.h"

namespace meniscus {
namespace {

/// A preset: extinction and scattering in units of 1 / scale.
struct Preset {
  const char* name;
  bool transparent;
  float ior;
  vec3 extinction;
  vec3 scattering;
  vec3 body;
  float roughness;
  float specular;
};

// Water takes red away first: pure water absorbs 0.28, 0.057 and 0.009 per metre at 620, 550 and 450 nm
// [PopeFry1997]. Natural water absorbs more blue than that; a little scattering keeps deep water from being black.
const Preset kPresets[] = {
    {"water", true, 1.333f, {0.75f, 0.26f, 0.16f}, {0.012f, 0.035f, 0.050f}, {0.06f, 0.42f, 0.70f}, 0.0f, 1.0f},
    {"sea", true, 1.34f, {2.60f, 0.80f, 0.75f}, {0.20f, 0.55f, 0.50f}, {0.08f, 0.50f, 0.48f}, 0.05f, 1.0f},
    {"milk", true, 1.35f, {0.02f, 0.04f, 0.10f}, {26.0f, 28.0f, 31.0f}, {0.93f, 0.91f, 0.86f}, 0.10f, 1.0f},
    {"oil", true, 1.47f, {0.14f, 0.55f, 3.20f}, {0.10f, 0.10f, 0.05f}, {0.85f, 0.55f, 0.08f}, 0.0f, 1.0f},
    {"ink", true, 1.34f, {16.0f, 12.0f, 5.5f}, {0.6f, 0.6f, 1.2f}, {0.02f, 0.03f, 0.22f}, 0.0f, 1.0f},
    {"wine", true, 1.345f, {0.90f, 7.5f, 6.5f}, {0.10f, 0.05f, 0.05f}, {0.45f, 0.02f, 0.05f}, 0.0f, 1.0f},
    {"clay", false, 1.5f, {0, 0, 0}, {0, 0, 0}, {0.62f, 0.57f, 0.52f}, 0.6f, 0.0f},
    {"plastic", false, 1.5f, {0, 0, 0}, {0, 0, 0}, {0.08f, 0.30f, 0.62f}, 0.22f, 1.0f},
};

// Of water in air at 20 C at 650, 550 and 450 nm: 1.3313, 1.3343 and 1.3392, less 1.3330 [Harvey1998].
constexpr vec3 kWaterDispersion{-0.0017f, 0.0013f, 0.0062f};

}  // namespace

std::vector<std::string> material_names() {
  std::vector<std::string> names;
  for (const Preset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

Material material_preset(std::string_view name, float scale) {
  if (!(scale > 0) || scale > 1e30f)
    throw Error(ErrorCode::invalid_argument, fmt::format("a material cannot have a depth scale of {} m", scale));
  for (const Preset& preset : kPresets) {
    if (name != preset.name) continue;
    Material material;
    material.name = preset.name;
    material.transparent = preset.transparent;
    material.ior = preset.ior;
    material.extinction = preset.extinction / scale;
    material.scattering = preset.scattering / scale;
    material.body = preset.body;
    material.roughness = preset.roughness;
    material.specular = preset.specular;
    if (material.name == "water" || material.name == "sea") material.dispersion = kWaterDispersion;
    return material;
  }
  throw Error(ErrorCode::invalid_argument, {"there is no such material",
                                            fmt::format("one of {}", fmt::join(material_names(), ", ")),
                                            std::string(name),
                                            {},
                                            {},
                                            {},
                                            {}});
}

}  // namespace meniscus
