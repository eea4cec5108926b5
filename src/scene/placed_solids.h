/// Solids where they stand, as one thing for rays.
#pragma once

#include <glm/mat3x3.hpp>

#include "scene/planes.h"
#include "scene/solid.h"

namespace meniscus {

class PlacedSolids {
 public:
  /// @throws Error invalid_argument: no solid, a transform that is not affine or not invertible, a bad material
  explicit PlacedSolids(std::vector<PlacedSolid> placed);
  Bounds bounds() const { return bounds_; }
  /// The first triangle between `from` and `limit` m along the ray.
  SolidHit hit(const Ray& ray, Beam beam, float from, float limit) const;
  /// Distance to it alone; infinity if there is none.
  float distance(const Ray& ray, float from, float limit) const;
  /// Whether there is any.
  bool blocks(const Ray& ray, float from, float limit) const;
  /// Bits of four rays that meet none, the first ray's the lowest; the rays have no end.
  int passing(const Ray (&rays)[4]) const;
  /// The same for up to sixteen rays.
  unsigned passing(std::span<const Ray> rays) const;
  /// The first triangles along the rays that are said to be near, where they come before what is met so far.
  /// @param described_too  false: distance and face only
  void hits(const RayBlock& rays, const BlockBeams& beams, bool described_too, BlockHits& hits) const;
  /// Whether rays beside this one, as far as width + spread * their length, may meet any.
  bool near(const Ray& ray, float width, float spread) const;
  /// Grown by more than rounding.
  const SolidsBox& box() const { return box_; }

 private:
  struct Place {
    std::shared_ptr<const BuiltSolid> solid;
    glm::mat3 linear;   ///< of world_from_solid
    glm::mat3 normals;  ///< its inverse transpose
    std::optional<SolidMaterial> material;
    std::shared_ptr<const Texture> texture;  ///< of `material`
    bool covered;
  };
  SolidHit described(const Ray& ray, Beam beam, float distance, std::size_t place, std::size_t triangle, float u,
                     float v) const;

  std::vector<Place> places_;
  EmbreeScene scene_;
  Bounds bounds_;
  SolidsBox box_;  ///< grown by more than rounding
};

}  // namespace meniscus
