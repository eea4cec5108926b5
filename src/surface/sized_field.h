/// The field of particles that have sizes of their own: levels of like ones.
#pragma once

#include "surface/particle_sizes.h"

namespace meniscus {

/// A field of the particles whose smoothing lengths are at most twice the least, with levels of larger ones, each up to
/// twice the ones before; levels that would hold none are left out. Its step is that of the smallest smoothing length
/// of all. Without sizes this is make_field() of the options.
/// @throws Error  as make_field()
RaycastField make_sized_field(const Particles& particles, const ResolvedSizes& own, std::span<const vec3> colours);

/// Calls visit(level) for the field and its coarser levels.
template <class Field, class Visit>
void for_each_level(Field& field, Visit visit) {
  visit(field);
  for (auto& level : field.coarser) visit(level);
}

}  // namespace meniscus
