/// Names of what the ground is made of and of how wet it is.
#include "meniscus/sim.h"

namespace meniscus {

GroundMaterial ground_material_of(std::string_view name) {
  if (name == "concrete") return GroundMaterial::concrete;
  if (name == "asphalt") return GroundMaterial::asphalt;
  if (name == "steel") return GroundMaterial::steel;
  throw Error(ErrorCode::invalid_argument,
              {"there is no such ground", "concrete, asphalt or steel", std::string(name), {}, {}, {}, {}});
}

std::string_view name_of(GroundMaterial material) {
  switch (material) {
    case GroundMaterial::concrete:
      return "concrete";
    case GroundMaterial::asphalt:
      return "asphalt";
    case GroundMaterial::steel:
      return "steel";
  }
  return "unknown";
}

std::string_view name_of(Wetness wetness) {
  switch (wetness) {
    case Wetness::dry:
      return "dry";
    case Wetness::wet:
      return "wet";
    case Wetness::puddle_3mm:
      return "puddle_3mm";
    case Wetness::puddle_5mm:
      return "puddle_5mm";
    case Wetness::puddle_10mm:
      return "puddle_10mm";
  }
  return "unknown";
}

}  // namespace meniscus
