/// Rays through the water of a height field, with what is seen where they cross its surface.
#pragma once

#include "surface/height_field_body.h"

namespace meniscus {

/// The body of a field and how its surface looks.
class HeightFieldRays {
 public:
  HeightFieldRays(HeightField field, bool sides);

  const HeightField& field() const { return field_; }
  const HeightFieldBody& body() const { return body_; }
  bool sides() const { return sides_; }

  /// The first place in [from, limit] where a ray comes into the water through what is surface.
  FieldChange enter(const FieldRay& ray, double from, double limit) const;
  /// The same where `stretch` is what is clipped from the ray already.
  FieldChange enter(const FieldRay& ray, FieldStretch stretch, double limit) const;
  /// The first place where a ray that is in the water at `from` comes out of it through what is surface.
  FieldChange leave(const FieldRay& ray, double from, double limit) const;
  /// As in Surface::crossings().
  Crossing into(const Ray& ray, float from, float limit) const;
  Crossing out_of(const Ray& ray, float from, float limit) const;

  /// Normal of a face where a ray crosses it, unit, out of the water, on the side that the ray comes from or goes to.
  vec3 normal(const Ray& ray, const FieldRay& in_field, const FieldChange& change, bool entering) const;
  /// Colour of the water at a place of the ray.
  vec3 colour(const FieldRay& ray, double t) const;

 private:
  Crossing crossing(const Ray& ray, const FieldRay& in_field, const FieldChange& change, bool entering) const;
  bool is_side(Face face) const { return face == Face::side_a || face == Face::side_b || face == Face::hole; }
  vec3 hole_normal(double a, double b) const;

  HeightField field_;
  HeightFieldBody body_;
  bool sides_;
  double soon_;   ///< m; a ray is let come to its side for so long
  double nudge_;  ///< m; along a ray beyond a crossing, so that it is not found again
};

}  // namespace meniscus
