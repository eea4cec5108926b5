#include "scene/solid.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace meniscus {
namespace {

bool finite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

[[noreturn]] void fail(std::string problem) { throw Error(ErrorCode::invalid_argument, std::move(problem)); }

void check(const Mesh& mesh) {
  const std::size_t points = mesh.positions.size(), triangles = mesh.corners.size() / 3;
  if (mesh.corners.size() % 3 != 0) fail("the corners of a mesh are not three a triangle");
  if (triangles > 0xFFFFFFFEu || points > 0xFFFFFFFEu)
    throw Error(ErrorCode::limit_exceeded, "a mesh has more than 2^32 triangles or points");
  if (!mesh.normals.empty() && mesh.normals.size() != points) fail("a mesh has another number of normals than points");
  if (!mesh.texture_points.empty() && mesh.texture_points.size() != points)
    fail("a mesh has another number of texture points than points");
  for (const std::uint32_t corner : mesh.corners)
    if (corner >= points) fail(fmt::format("a triangle's corner is point {} of {}", corner, points));
  for (const vec3& position : mesh.positions)
    if (!finite(position) || std::abs(position.x) > 1e15f || std::abs(position.y) > 1e15f ||
        std::abs(position.z) > 1e15f)
      fail("a point of a mesh is not finite");
  if (!mesh.material_of.empty() && mesh.material_of.size() != triangles)
    fail("a mesh has another number of material indices than triangles");
  for (const std::uint32_t material : mesh.material_of)
    if (material >= std::max<std::size_t>(1, mesh.materials.size()))
      fail(fmt::format("a triangle has material {} of {}", material, mesh.materials.size()));
  for (const SolidMaterial& material : mesh.materials) check_material(material);
}

/// "*3" names the mesh's own picture 3, anything else a file.
std::shared_ptr<const Texture> load(const Mesh& mesh, const std::string& name) {
  if (name.empty()) return nullptr;
  if (name.front() != '*') return read_texture(name);
  std::size_t number = 0;
  for (const char digit : name.substr(1)) {
    if (digit < '0' || digit > '9' || number > mesh.pictures.size()) fail("a mesh has no picture " + name);
    number = number * 10 + static_cast<std::size_t>(digit - '0');
  }
  if (number >= mesh.pictures.size()) fail("a mesh has no picture " + name);
  return decode_texture(mesh.pictures[number], name);
}

}  // namespace

void check_material(const SolidMaterial& material) {
  const vec3 albedo = material.albedo;
  if (!finite(albedo) || albedo.x < 0 || albedo.y < 0 || albedo.z < 0)
    fail("a solid's albedo is negative or not finite");
  if (!(material.roughness >= 0 && material.roughness <= 1)) fail("a solid's roughness is not in [0, 1]");
  if (!(material.ior > 1) || !std::isfinite(material.ior))
    fail("the index of refraction of a solid's coat is not above 1");
}

BuiltSolid::BuiltSolid(Mesh mesh) : mesh_(std::move(mesh)) {
  check(mesh_);
  if (mesh_.materials.empty()) mesh_.materials.emplace_back();
  for (const SolidMaterial& material : mesh_.materials) textures_.push_back(load(mesh_, material.texture));
  for (const std::uint32_t corner : mesh_.corners) bounds_.add(mesh_.positions[corner]);

  scene_ = make_embree_scene();
  if (!mesh_.corners.empty()) {
    // Embree reads 16 bytes of the last point as well.
    mesh_.positions.reserve(mesh_.positions.size() + 2);
    const EmbreeGeometry geometry(rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_TRIANGLE));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh_.positions.data(), 0,
                               sizeof(vec3), mesh_.positions.size());
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh_.corners.data(), 0,
                               3 * sizeof(std::uint32_t), mesh_.corners.size() / 3);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometry(scene_.get(), geometry.get());
  }
  rtcCommitScene(scene_.get());
  check_embree();
}

std::shared_ptr<const Texture> BuiltSolid::texture_of(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  auto& texture = worn_[name];
  if (!texture) texture = load(mesh_, name);
  return texture;
}

std::shared_ptr<const Solid> make_solid(Mesh mesh) { return std::make_shared<BuiltSolid>(std::move(mesh)); }

}  // namespace meniscus
