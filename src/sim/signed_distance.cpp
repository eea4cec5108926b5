#include "sim/signed_distance.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <limits>

namespace meniscus {
namespace {

/// Never released: shapes may outlive every static object. A number of threads given here would limit all loops of the
/// process for as long as the device lives.
RTCDevice device() {
  static const RTCDevice device = rtcNewDevice("threads=0");
  if (!device) throw Error(ErrorCode::unsupported, "Embree cannot be started on this machine");
  return device;
}

void check_device() {
  const RTCError error = rtcGetDeviceError(device());
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    throw Error(ErrorCode::limit_exceeded, "there is not enough memory for an obstacle's hierarchy");
  throw Error(ErrorCode::unsupported, "Embree cannot hold an obstacle's triangles");
}

struct Search {
  const ClosedMesh& mesh;
  vec3 point;
  float distance;  ///< of the nearest so far
  std::uint32_t triangle = 0;
  TrianglePoint found{};
};

bool look_at(RTCPointQueryFunctionArguments* arguments) {
  Search& search = *static_cast<Search*>(arguments->userPtr);
  const auto& corners = search.mesh.triangles[arguments->primID].corners;
  const auto& p = search.mesh.positions;
  const TrianglePoint on = nearest_on_triangle(search.point, p[corners[0]], p[corners[1]], p[corners[2]]);
  const float distance = glm::distance(search.point, on.point);
  if (!(distance < search.distance)) return false;
  search.distance = distance;
  search.triangle = arguments->primID;
  search.found = on;
  arguments->query->radius = distance;
  return true;
}

}  // namespace

TrianglePoint nearest_on_triangle(vec3 point, vec3 a, vec3 b, vec3 c) {
  const vec3 ab = b - a, ac = c - a, ap = point - a;
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {a, 4};
  const vec3 bp = point - b;
  const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {b, 5};
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + ab * (d1 / (d1 - d3)), 1};
  const vec3 cp = point - c;
  const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {c, 6};
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + ac * (d2 / (d2 - d6)), 3};
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), 2};
  const float scale = 1 / (va + vb + vc);
  return {a + ab * (vb * scale) + ac * (vc * scale), 0};
}

MeshDistance::MeshDistance(ClosedMesh mesh) : mesh_(std::move(mesh)), scene_(rtcNewScene(device())) {
  check_device();
  const RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  void* positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec3),
                                            mesh_.positions.size());
  void* corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(std::uint32_t), mesh_.triangles.size());
  if (positions && corners) {
    std::memcpy(positions, mesh_.positions.data(), mesh_.positions.size() * sizeof(vec3));
    auto* out = static_cast<std::uint32_t*>(corners);
    for (const ClosedMesh::Triangle& triangle : mesh_.triangles) out = std::copy_n(triangle.corners.begin(), 3, out);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
  }
  rtcReleaseGeometry(geometry);
  check_device();
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  rtcCommitScene(scene_.get());
  check_device();
}

bool MeshDistance::nearest(vec3 point, float limit, NearestSurface& nearest) const {
  Search search{mesh_, point, limit};
  RTCPointQuery query{point.x, point.y, point.z, 0, limit};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  if (!rtcPointQuery(scene_.get(), &query, &context, look_at, &search)) return false;
  const ClosedMesh::Triangle& triangle = mesh_.triangles[search.triangle];
  const int part = search.found.part;
  vec3 side = triangle.normal;
  if (part >= 4) {
    side = mesh_.corner_normals[triangle.corners[static_cast<std::size_t>(part - 4)]];
  } else if (part >= 1 || side == vec3(0.0f)) {
    side = mesh_.edge_normals[triangle.edges[static_cast<std::size_t>(std::max(part - 1, 0))]];
  }
  const vec3 away = point - search.found.point;
  const bool inside = glm::dot(away, side) < 0;
  nearest.distance = inside ? -search.distance : search.distance;
  // So near to the surface the way there is made of rounding errors.
  const float blurred = 1e-6f * (glm::length(point) + search.distance);
  if (search.distance > 4 * blurred) {
    nearest.normal = away / nearest.distance;
  } else {
    const float length = glm::length(side);
    nearest.normal = length > 0 ? side / length : vec3(0, 1, 0);
  }
  return true;
}

}  // namespace meniscus
