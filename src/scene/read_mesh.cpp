// Meshes from files, by the importers of Assimp whose formats are asked for; their results are checked like a file.
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "meniscus/scene.h"
#include "scene/mesh_guard.h"
#include "scene/smooth_normals.h"
#include "scene/triangulate.h"

namespace meniscus {
namespace {

/// Edges sharper than this stay sharp where a file has no normals.
constexpr float kCreaseDegrees = 40.0f;
/// What nodes make of a file's meshes by placing them many times.
constexpr std::size_t kMostCorners = std::size_t{3} << 27;

[[noreturn]] void fail(ErrorCode code, const std::string& path, std::string problem, std::string found = {},
                       std::string advice = {}) {
  throw Error(code, {std::move(problem), {}, std::move(found), path, {}, {}, std::move(advice)});
}

std::vector<char> bytes_of(const std::string& path) {
  std::error_code status;
  if (!std::filesystem::exists(path, status)) fail(ErrorCode::not_found, path, "there is no such mesh file");
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file || std::filesystem::is_directory(path, status))
    fail(ErrorCode::io_failed, path, "the mesh file cannot be read", std::strerror(errno));
  std::vector<char> bytes(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) fail(ErrorCode::io_failed, path, "reading the mesh file failed");
  return bytes;
}

float clamped(float value, float low, float high, float otherwise) {
  return std::isfinite(value) ? std::clamp(value, low, high) : otherwise;
}

SolidMaterial material_of(const aiMaterial& from, const std::filesystem::path& folder) {
  SolidMaterial material;
  aiColor4D colour(material.albedo.x, material.albedo.y, material.albedo.z, 1.0f);
  if (from.Get(AI_MATKEY_BASE_COLOR, colour) == AI_SUCCESS || from.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == AI_SUCCESS)
    material.albedo = {clamped(colour.r, 0, 1, 0), clamped(colour.g, 0, 1, 0), clamped(colour.b, 0, 1, 0)};
  aiString name;
  if (from.GetTexture(aiTextureType_BASE_COLOR, 0, &name) == AI_SUCCESS ||
      from.GetTexture(aiTextureType_DIFFUSE, 0, &name) == AI_SUCCESS) {
    std::string file = name.C_Str();
    std::replace(file.begin(), file.end(), '\\', '/');
    const bool inside = !file.empty() && file.front() == '*';
    if (!file.empty()) material.texture = inside ? file : (folder / file).lexically_normal().string();
  }
  float value = 0;
  if (from.Get(AI_MATKEY_ROUGHNESS_FACTOR, value) == AI_SUCCESS) material.roughness = clamped(value, 0, 1, 1);
  if (material.roughness < 1 && from.Get(AI_MATKEY_REFRACTI, value) == AI_SUCCESS && value > 1.01f && value < 5.0f)
    material.ior = value;
  return material;
}

glm::mat4 matrix_of(const aiMatrix4x4& m) {
  return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

vec3 vector_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// Puts one mesh of the file where a node has it.
void append(Mesh& mesh, const aiMesh& part, const glm::mat4& world, bool any_texture, const std::string& path) {
  if (!part.mVertices || part.mNumVertices == 0) return;
  const std::size_t first = mesh.positions.size();
  if (first + part.mNumVertices > 0xFFFFFFFEu) fail(ErrorCode::limit_exceeded, path, "the mesh has too many points");
  const glm::mat3 linear(world);
  const bool invertible = std::abs(glm::determinant(linear)) > 0;
  const glm::mat3 normals = invertible ? glm::transpose(glm::inverse(linear)) : linear;
  const bool mirrored = glm::determinant(linear) < 0;
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    mesh.positions.push_back(vec3(world * glm::vec4(vector_of(part.mVertices[i]), 1.0f)));
    const vec3 normal = part.mNormals ? normals * vector_of(part.mNormals[i]) : vec3{0.0f};
    const float length = glm::length(normal);
    mesh.normals.push_back(length > 0 && std::isfinite(length) ? normal / length : vec3{0.0f});
    if (any_texture) {
      const aiVector3D at = part.mTextureCoords[0] ? part.mTextureCoords[0][i] : aiVector3D();
      mesh.texture_points.push_back({clamped(at.x, -1e6f, 1e6f, 0), clamped(at.y, -1e6f, 1e6f, 0)});
    }
  }
  std::vector<std::uint32_t> polygon, triangles;
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices < 3) continue;  // a point or a line
    polygon.clear();
    triangles.clear();
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      if (face.mIndices[k] >= part.mNumVertices)
        fail(ErrorCode::malformed_file, path, "a triangle has a corner that is not there");
      polygon.push_back(static_cast<std::uint32_t>(first) + face.mIndices[k]);
      const vec3 p = mesh.positions[polygon.back()];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        fail(ErrorCode::malformed_file, path, "a triangle has a corner that is not finite");
    }
    if (mirrored) std::reverse(polygon.begin(), polygon.end());
    triangulate(mesh.positions, polygon, triangles);
    if (mesh.corners.size() + triangles.size() > kMostCorners)
      fail(ErrorCode::limit_exceeded, path, "the mesh has too many triangles");
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
      const vec3 a = mesh.positions[triangles[t]], b = mesh.positions[triangles[t + 1]],
                 c = mesh.positions[triangles[t + 2]];
      if (!(glm::length(glm::cross(b - a, c - a)) > 0)) continue;  // without area
      mesh.corners.insert(mesh.corners.end(), triangles.data() + t, triangles.data() + t + 3);
      mesh.material_of.push_back(part.mMaterialIndex);
    }
  }
}

struct Placed {
  const aiNode* node;
  glm::mat4 world;
};

Mesh gathered(const aiScene& scene, const std::string& path) {
  Mesh mesh;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (unsigned i = 0; i < scene.mNumMaterials; ++i)
    mesh.materials.push_back(material_of(*scene.mMaterials[i], folder));
  for (unsigned i = 0; i < scene.mNumTextures; ++i) {
    // Without a height the texels are an encoded picture of mWidth bytes.
    const aiTexture& picture = *scene.mTextures[i];
    const auto* bytes = reinterpret_cast<const unsigned char*>(picture.pcData);
    mesh.pictures.emplace_back();
    if (picture.mHeight == 0 && bytes) mesh.pictures.back().assign(bytes, bytes + picture.mWidth);
  }
  bool any_texture = false;
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    any_texture = any_texture || scene.mMeshes[i]->mTextureCoords[0];
    if (scene.mMeshes[i]->mMaterialIndex >= std::max(1u, scene.mNumMaterials))
      fail(ErrorCode::malformed_file, path, "a part of the mesh has a material that is not there");
  }
  std::vector<Placed> open;
  if (scene.mRootNode) open.push_back({scene.mRootNode, glm::mat4(1.0f)});
  while (!open.empty()) {
    const Placed placed = open.back();
    open.pop_back();
    const glm::mat4 world = placed.world * matrix_of(placed.node->mTransformation);
    for (unsigned i = 0; i < placed.node->mNumMeshes; ++i) {
      const aiMesh& part = *scene.mMeshes[placed.node->mMeshes[i]];
      append(mesh, part, world, any_texture, path);
    }
    for (unsigned i = placed.node->mNumChildren; i > 0; --i) open.push_back({placed.node->mChildren[i - 1], world});
  }
  if (mesh.corners.empty()) fail(ErrorCode::malformed_file, path, "the mesh file holds no triangle");
  smooth_normals(mesh, std::cos(glm::radians(kCreaseDegrees)));
  return mesh;
}

}  // namespace

Mesh read_mesh(const std::string& path) {
  const MeshKind kind = mesh_kind_of(path);
  {
    const std::vector<char> bytes = bytes_of(path);
    check_promises(kind, bytes, path);
  }
  Assimp::Importer importer;
  // No further steps: Assimp's own stop the program at some damaged meshes, before anything can be checked.
  const aiScene* scene = importer.ReadFile(path, 0);
  if (!scene)
    fail(ErrorCode::malformed_file, path, "the mesh file cannot be understood", importer.GetErrorString(),
         "write the mesh again");
  return gathered(*scene, path);
}

}  // namespace meniscus
