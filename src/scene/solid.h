/// A mesh with its hierarchy and its textures.
#pragma once

#include <map>
#include <mutex>

#include "meniscus/scene.h"
#include "scene/embree.h"
#include "scene/texture.h"

namespace meniscus {

class BuiltSolid final : public Solid {
 public:
  explicit BuiltSolid(Mesh mesh);
  const Mesh& mesh() const override { return mesh_; }
  Bounds bounds() const override { return bounds_; }

  RTCScene scene() const { return scene_.get(); }
  const SolidMaterial& material(std::size_t triangle) const { return mesh_.materials[index(triangle)]; }
  /// Null: none.
  const Texture* texture(std::size_t triangle) const { return textures_[index(triangle)].get(); }
  /// A picture that a placed copy wears; kept for the next time.
  std::shared_ptr<const Texture> texture_of(const std::string& name) const;

 private:
  std::size_t index(std::size_t triangle) const { return mesh_.material_of.empty() ? 0 : mesh_.material_of[triangle]; }

  Mesh mesh_;
  Bounds bounds_;
  EmbreeScene scene_;
  std::vector<std::shared_ptr<const Texture>> textures_;  ///< one a material
  mutable std::mutex mutex_;
  mutable std::map<std::string, std::shared_ptr<const Texture>> worn_;
};

/// @throws Error invalid_argument: colours, roughness or index of refraction outside their range
void check_material(const SolidMaterial& material);

}  // namespace meniscus
