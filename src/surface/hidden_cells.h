/// What a ray has to enter before it can meet the surface, and what makes leaving particles out safe.
#pragma once

#include "surface/raycast_field.h"

namespace meniscus {

/// A set of spheres, by arrays.
struct SphereSet {
  std::vector<float> x, y, z, radius;
  std::size_t size() const { return x.size(); }
  void add(vec3 centre, float r);
  void add(const SphereSet& others);
};

/// A ray has to enter one of these spheres before it can meet the surface: those of the particles with a radius, as
/// they stand in the field, and one around each hidden cell that touches one that is not hidden. A ray that slips
/// between the particles in front has to run through a cell of the second kind before it can meet a particle that was
/// left out, so that no pixel is lost, whatever the particles look like.

/// Takes the radius of the particles that are amidst hidden cells, which no sphere is needed for.
void forget_amidst(RaycastField& field);
/// The spheres of hidden cells.
SphereSet hidden_cell_spheres(const RaycastField& field);

}  // namespace meniscus
