#include "scene/placed_solids.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

bool usable(const glm::mat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) return false;
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1) return false;
  // Flat means flat relative to the matrix's own scale.
  const glm::dmat3 linear(m);
  const double scale = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  return scale > 0 && std::abs(glm::determinant(linear)) > 1e-9 * scale;
}

RTCRay embree_ray(const Ray& ray, float from, float limit) {
  RTCRay r;
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tnear = from;
  r.tfar = limit;
  r.time = 0;
  r.mask = 0xFFFFFFFFu;
  r.id = 0;
  r.flags = 0;
  return r;
}

RTCRayHit traced(RTCScene scene, const Ray& ray, float from, float limit) {
  RTCRayHit r;
  r.ray = embree_ray(ray, from, limit);
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &r);
  return r;
}

/// Whether a ray meets a box between two distances.
bool meets(const Bounds& box, const Ray& ray, float from, float limit) {
  float enter = from, leave = limit;
  for (int axis = 0; axis < 3; ++axis) {
    // A ray along a face gives infinities that leave enter and leave as they are, or none of both on the outside.
    const float inverse = 1.0f / ray.direction[axis];
    const float a = (box.low[axis] - ray.origin[axis]) * inverse, b = (box.high[axis] - ray.origin[axis]) * inverse;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave;
}

/// The normal, turned no farther than needed to face the ray's origin.
vec3 facing(vec3 normal, vec3 direction) {
  constexpr float kLeast = 1e-3f;
  const float along = glm::dot(normal, direction);
  return along < -kLeast ? normal : glm::normalize(normal - (along + kLeast) * direction);
}

}  // namespace

PlacedSolids::PlacedSolids(std::vector<PlacedSolid> placed) : scene_(make_embree_scene()) {
  for (PlacedSolid& p : placed) {
    auto solid = std::dynamic_pointer_cast<const BuiltSolid>(p.solid);
    if (!solid) throw Error(ErrorCode::invalid_argument, "a placed solid is not one of make_solid()");
    if (!usable(p.world_from_solid))
      throw Error(ErrorCode::invalid_argument, "the transform of a solid is not affine or cannot be inverted");
    if (p.material) check_material(*p.material);
    const EmbreeGeometry instance(rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(instance.get(), solid->scene());
    rtcSetGeometryTransform(instance.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &p.world_from_solid[0][0]);
    rtcCommitGeometry(instance.get());
    rtcAttachGeometryByID(scene_.get(), instance.get(), static_cast<unsigned>(places_.size()));

    const Bounds box = solid->bounds();
    Bounds part;
    for (int corner = 0; corner < 8 && !box.empty(); ++corner) {
      const vec3 at{corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                    corner & 4 ? box.high.z : box.low.z};
      part.add(vec3(p.world_from_solid * glm::vec4(at, 1.0f)));
    }
    bounds_.add(part);
    box_.parts.push_back(part);
    const glm::mat3 linear(p.world_from_solid);
    auto texture = p.material ? solid->texture_of(p.material->texture) : nullptr;
    places_.push_back({std::move(solid), linear, glm::transpose(glm::inverse(linear)), std::move(p.material),
                       std::move(texture), p.covered});
  }
  rtcCommitScene(scene_.get());
  check_embree();
  const vec3 size = glm::max(glm::abs(bounds_.low), glm::abs(bounds_.high));
  const float margin = 1e-5f * std::max({size.x, size.y, size.z});
  box_.box = bounds_.grown(margin);
  if (box_.parts.size() > SolidsBox::kMostParts) box_.parts.clear();
  for (Bounds& part : box_.parts) part = part.grown(margin);
  box_.centre = box_.box.centre();
  box_.half_diagonal = 0.5f * glm::length(box_.box.extent());
}

SolidHit PlacedSolids::hit(const Ray& ray, Beam beam, float from, float limit) const {
  if (!meets(box_.box, ray, from, limit)) return {};
  const RTCRayHit found = traced(scene_.get(), ray, from, limit);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return described(ray, beam, found.ray.tfar, found.hit.instID[0], found.hit.primID, found.hit.u, found.hit.v);
}

float PlacedSolids::distance(const Ray& ray, float from, float limit) const {
  if (!meets(box_.box, ray, from, limit)) return kInfinity;
  const RTCRayHit found = traced(scene_.get(), ray, from, limit);
  return found.hit.geomID == RTC_INVALID_GEOMETRY_ID ? kInfinity : found.ray.tfar;
}

bool PlacedSolids::blocks(const Ray& ray, float from, float limit) const {
  if (!meets(box_.box, ray, from, limit)) return false;
  RTCRay r = embree_ray(ray, from, limit);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_.get(), &context, &r);
  return r.tfar < 0;
}

int PlacedSolids::passing(const Ray (&rays)[4]) const {
  RTCRay4 r;
  alignas(16) const int valid[4] = {-1, -1, -1, -1};
  for (int k = 0; k < 4; ++k) {
    r.org_x[k] = rays[k].origin.x;
    r.org_y[k] = rays[k].origin.y;
    r.org_z[k] = rays[k].origin.z;
    r.dir_x[k] = rays[k].direction.x;
    r.dir_y[k] = rays[k].direction.y;
    r.dir_z[k] = rays[k].direction.z;
    r.tnear[k] = 0;
    r.tfar[k] = kInfinity;
    r.time[k] = 0;
    r.mask[k] = 0xFFFFFFFFu;
    r.id[k] = 0;
    r.flags[k] = 0;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded4(valid, scene_.get(), &context, &r);
  int bits = 0;
  for (int k = 0; k < 4; ++k) bits |= r.tfar[k] < 0 ? 0 : 1 << k;
  return bits;
}

bool PlacedSolids::near(const Ray& ray, float width, float spread) const {
  // Nothing of the box is farther than its centre and half of its diagonal.
  const float farthest = glm::length(box_.centre - ray.origin) + box_.half_diagonal;
  return meets(box_.box.grown(width + spread * farthest), ray, 0, kInfinity);
}

SolidHit PlacedSolids::described(const Ray& ray, Beam beam, float distance, std::size_t place, std::size_t triangle,
                                 float u, float v) const {
  const Place& placed = places_[place];
  const Mesh& mesh = placed.solid->mesh();
  const std::uint32_t* corner = mesh.corners.data() + 3 * triangle;
  const float w = 1.0f - u - v;
  const vec3 a = mesh.positions[corner[0]];
  const vec3 side_u = placed.linear * (mesh.positions[corner[1]] - a);
  const vec3 side_v = placed.linear * (mesh.positions[corner[2]] - a);

  SolidHit hit;
  hit.distance = distance;
  hit.covered = placed.covered;
  vec3 across = glm::cross(side_u, side_v);
  const float twice_area = glm::length(across);
  hit.face_normal = twice_area > 0 ? across / twice_area : -ray.direction;
  if (glm::dot(hit.face_normal, ray.direction) > 0) hit.face_normal = -hit.face_normal;
  hit.normal = hit.face_normal;
  if (!mesh.normals.empty()) {
    const vec3 mixed =
        placed.normals * (w * mesh.normals[corner[0]] + u * mesh.normals[corner[1]] + v * mesh.normals[corner[2]]);
    const float length = glm::length(mixed);
    if (length > 0) {
      // Whatever side the file's normals are on, the seen one counts.
      const vec3 unit = mixed / length;
      hit.normal = facing(glm::dot(unit, hit.face_normal) < 0 ? -unit : unit, ray.direction);
    }
  }

  const SolidMaterial& material = placed.material ? *placed.material : placed.solid->material(triangle);
  const Texture* texture = placed.material ? placed.texture.get() : placed.solid->texture(triangle);
  hit.albedo = material.albedo;
  hit.roughness = material.roughness;
  hit.ior = material.ior;
  if (texture && !mesh.texture_points.empty() && twice_area > 0) {
    const vec2 at = mesh.texture_points[corner[0]];
    const vec2 step_u = mesh.texture_points[corner[1]] - at, step_v = mesh.texture_points[corner[2]] - at;
    const vec2 point = at + u * step_u + v * step_v;
    // The beam's long axis on the face, as a combination of the face's sides.
    const float width = beam.width + beam.spread * distance;
    const float cos_in = std::max(1e-3f, -glm::dot(hit.face_normal, ray.direction));
    const vec3 flat = ray.direction - glm::dot(ray.direction, hit.face_normal) * hit.face_normal;
    const float flat_length = glm::length(flat);
    const vec3 axis = flat_length > 1e-6f ? flat * (0.5f * width / (cos_in * flat_length)) : vec3{0.0f};
    const vec3 unit = across / twice_area;
    const float along_u = glm::dot(glm::cross(axis, side_v), unit) / twice_area;
    const float along_v = glm::dot(glm::cross(side_u, axis), unit) / twice_area;
    const float texture_area = std::abs(step_u.x * step_v.y - step_u.y * step_v.x);
    hit.albedo *= texture->at(point, along_u * step_u + along_v * step_v, width * std::sqrt(texture_area / twice_area));
  }
  return hit;
}

}  // namespace meniscus
