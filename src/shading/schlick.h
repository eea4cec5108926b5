/// The reflectance of an interface by the formula that is asked for.
#pragma once

#include <cmath>

#include "meniscus/formulas/optics.h"
#include "meniscus/shading.h"

namespace meniscus {

/// formulas::fresnel(), its unpolarised reflectance by Schlick's formula if that is wanted.
inline formulas::Interface interface_of(float cos_i, float eta, FresnelFormula formula) {
  if (formula == FresnelFormula::exact) return formulas::fresnel(cos_i, eta);
  const float c = cos_i < 0 ? 0.0f : cos_i > 1 ? 1.0f : cos_i;
  const float cos_t_squared = 1.0f - (1.0f - c * c) / (eta * eta);
  if (!(cos_t_squared > 0)) return {1.0f, 1.0f, 1.0f, 0.0f};
  const float reflectance = formulas::schlick_reflectance(c, eta);
  return {reflectance, reflectance, reflectance, std::sqrt(cos_t_squared)};
}

}  // namespace meniscus
