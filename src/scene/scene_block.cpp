// Rays in blocks: what they meet, and what light comes along them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>

#include "scene/facing.h"
#include "scene/scene_parts.h"

namespace meniscus {
namespace {

constexpr float kPerPi = 1.0f / std::numbers::pi_v<float>;

/// Fills up to whole vectors with copies of the last point.
void close(BlockPoints& points, int count) {
  for (int k = count; k % 16 != 0; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      points.at[axis][k] = points.at[axis][count - 1];
      points.face_normal[axis][k] = points.face_normal[axis][count - 1];
    }
    points.width[k] = points.width[count - 1];
  }
}

/// Calls body(block, beams, hits, first) for the rays in blocks, on all threads; the hits are to be overwritten.
template <class Body>
void for_each_block(std::span<const Ray> rays, Beam beam, Body body) {
  BlockBeams beams;
  beams.fill(beam);
  parallel_for(rays.size(), 16 * RayBlock::kRays, [&](std::size_t begin, std::size_t end) {
    RayBlock block;
    BlockHits hits;
    for (std::size_t first = begin; first < end; first += RayBlock::kRays) {
      const auto count = static_cast<int>(std::min<std::size_t>(RayBlock::kRays, end - first));
      for (int lane = 0; lane < count; ++lane) block.set(lane, rays[first + static_cast<std::size_t>(lane)]);
      block.close(count);
      body(block, beams, hits, first);
    }
  });
}

void check(bool same_length) {
  if (!same_length) throw Error(ErrorCode::invalid_argument, "a list of results is not as long as the list of rays");
}

}  // namespace

void Scene::Parts::meet(const RayBlock& rays, const BlockBeams& beams, bool distances_only, BlockHits& hits) const {
  const Planes planes{body.get(), ground, u_axis, v_axis};
  static const SolidsBox none;
  plane_hits(planes, solids ? solids->box() : none, rays, beams, distances_only ? 0.0f : kTie, !distances_only, hits);
  if (solids) solids->hits(rays, beams, !distances_only, hits);
  if (cover && !distances_only) cover_hits(rays, beams, hits);
}

void Scene::Parts::cover_hits(const RayBlock& rays, const BlockBeams& beams, BlockHits& hits) const {
  int lanes[RayBlock::kRays];
  vec3 points[RayBlock::kRays], directions[RayBlock::kRays];
  float widths[RayBlock::kRays];
  SolidHit covered[RayBlock::kRays];
  std::size_t count = 0;
  for (int lane = 0; lane < rays.count; ++lane) {
    const int face = hits.face[lane];
    if (face != kGroundFace && !(face == kSolidFace && hits.solids[lane].covered)) continue;
    lanes[count] = lane;
    points[count] = rays.point(lane, hits.distance[lane]);
    directions[count] = rays.direction_of(lane);
    widths[count] = beams.width[lane] + beams.spread[lane] * hits.distance[lane];
    covered[count++] = hit_of(hits, lane);
  }
  if (count == 0) return;
  cover->cover({points, count}, {directions, count}, {widths, count}, {covered, count});
  for (std::size_t k = 0; k < count; ++k) {
    const int lane = lanes[k];
    hits.face[lane] = kSolidFace;
    hits.solids[lane] = covered[k];
    for (int c = 0; c < 3; ++c) hits.albedo[c][lane] = covered[k].albedo[c];
  }
}

vec3 Scene::Parts::normal_of(int face) const {
  if (face == kGroundFace) return ground.up;
  vec3 normal{0.0f};
  if (face >= kTankFace) normal[face / 2] = face % 2 == 0 ? -1.0f : 1.0f;
  return normal;
}

SolidHit Scene::Parts::hit_of(const BlockHits& hits, int lane) const {
  const int face = hits.face[lane];
  if (face == kSolidFace) return hits.solids[lane];
  SolidHit hit;
  if (face == kNothing) return hit;
  hit.distance = hits.distance[lane];
  hit.normal = hit.face_normal = normal_of(face);
  hit.albedo = {hits.albedo[0][lane], hits.albedo[1][lane], hits.albedo[2][lane]};
  hit.presence = hits.presence[lane];
  hit.covered = face == kGroundFace;
  if (face != kGroundFace && body->tank().style == TankStyle::glass) {
    hit.roughness = TankBody::kEdgeRoughness;
    hit.ior = TankBody::kGlass;
  }
  return hit;
}

void Scene::Parts::shade(const RayBlock& rays, const BlockBeams& beams, const BlockHits& hits,
                         BlockVectors& radiance) const {
  // The environment where it is seen.
  std::int32_t open[RayBlock::kRays];
  std::int32_t any_open = 0;
  for (int lane = 0; lane < rays.count; ++lane) {
    open[lane] =
        static_cast<std::int32_t>(hits.face[lane] == kNothing) | static_cast<std::int32_t>(hits.presence[lane] < 1.0f);
    any_open |= open[lane];
  }
  const bool ground_alone = !body && !solids && !cover && !water_light && lamps.empty();
  BlockVectors elsewhere;
  BlockVectors& behind = ground_alone ? radiance : elsewhere;
  if (any_open != 0)
    environment.radiance(rays.direction, beams.roughness, open, rays.count, behind);
  else
    behind = {};
  if (ground_alone) {
    const vec3 light = plane_skies[kGroundFace] + environment.sun_irradiance() * plane_cosines[kGroundFace];
    light_ground(hits, kPerPi * light, rays.count, radiance);
    return;
  }

  const bool bars = body && body->tank().style == TankStyle::glass;
  const vec3 sun = environment.sun_direction(), sun_irradiance = environment.sun_irradiance();
  int lanes[RayBlock::kRays];
  int count = 0;
  BlockPoints points;
  vec3 places[RayBlock::kRays], normals[RayBlock::kRays];
  float cosines[RayBlock::kRays];
  const auto put = [&](int lane, vec3 seen) {
    const float presence = hits.presence[lane];
    radiance.set(lane, presence < 1.0f ? glm::mix(behind.get(lane), seen, presence) : seen);
  };
  for (int lane = 0; lane < rays.count; ++lane) {
    const int face = hits.face[lane];
    if (face == kNothing) {
      radiance.set(lane, behind.get(lane));
      continue;
    }
    // Coats show their surroundings: one by one.
    const bool coated = face == kSolidFace ? hits.solids[lane].roughness < 1.0f : bars && face != kGroundFace;
    if (coated) {
      put(lane, lit(hit_of(hits, lane), rays.ray(lane), beams.of(lane)));
      continue;
    }
    const vec3 place = rays.point(lane, hits.distance[lane]);
    vec3 face_normal = plane_normals[static_cast<std::size_t>(face)];
    vec3 normal = face_normal;
    cosines[count] = plane_cosines[static_cast<std::size_t>(face)];
    if (face == kSolidFace) {
      normal = hits.solids[lane].normal;
      face_normal = hits.solids[lane].face_normal;
      cosines[count] = facing(normal, face_normal, sun);
    }
    for (int axis = 0; axis < 3; ++axis) {
      points.at[axis][count] = place[axis];
      points.face_normal[axis][count] = face_normal[axis];
    }
    points.width[count] = beams.width[lane] + beams.spread[lane] * hits.distance[lane];
    places[count] = place;
    normals[count] = normal;
    lanes[count++] = lane;
  }
  if (count == 0) return;
  close(points, count);

  if (body || solids) {
    static const SolidsBox none;
    sun_past_planes({body.get(), ground, u_axis, v_axis}, solids ? solids->box() : none, sun_path, count, points);
    if (solids) sun_past_solids(cosines, count, points);
  }
  const auto n = static_cast<std::size_t>(count);
  // As without water, or what it does at each point.
  const WaterLight::Light unchanged;
  std::vector<WaterLight::Light> water(water_light ? n : 0);
  if (water_light) water_light->at_each({places, n}, {normals, n}, water);

  for (int k = 0; k < count; ++k) {
    const int lane = lanes[k], face = hits.face[lane];
    const WaterLight::Light& light = water_light ? water[static_cast<std::size_t>(k)] : unchanged;
    const vec3 sky =
        face == kSolidFace ? environment.irradiance(normals[k]) : plane_skies[static_cast<std::size_t>(face)];
    vec3 sum = light.sky * sky + light.refracted;
    vec3 direct = light.sun * sun_irradiance * cosines[k];
    if (body || solids) direct *= vec3{points.light[0][k], points.light[1][k], points.light[2][k]};
    sum += direct;
    if (!lamps.empty()) {
      const vec3 face_normal{points.face_normal[0][k], points.face_normal[1][k], points.face_normal[2][k]};
      sum += lamp_irradiance(places[k], normals[k], face_normal, light.lamps);
    }
    const vec3 albedo{hits.albedo[0][lane], hits.albedo[1][lane], hits.albedo[2][lane]};
    put(lane, albedo * kPerPi * sum);
  }
}

void Scene::Parts::sun_past_solids(const float* cosines, int count, BlockPoints& points) const {
  // Lanes whose cone towards the sun may be cut: four rays each on its edge, four lanes at once.
  constexpr int kAtOnce = 4;
  const auto ray_of = [&](int k, std::size_t number) {
    const vec3 place{points.at[0][k], points.at[1][k], points.at[2][k]};
    const vec3 face_normal{points.face_normal[0][k], points.face_normal[1][k], points.face_normal[2][k]};
    return sun_ray(place + clearance(place) * face_normal, face_normal, points.width[k], number);
  };
  int waiting[kAtOnce];
  int held = 0;
  Ray rays[16];
  const auto trace = [&] {
    const unsigned passed = solids->passing({rays, 4 * static_cast<std::size_t>(held)});
    for (int j = 0; j < held; ++j) {
      const int k = waiting[j];
      auto seen = std::popcount((passed >> (4 * j)) & 15u);
      if (seen == 4) continue;
      float part = 0;
      if (seen != 0) {
        Ray more[12];
        for (std::size_t i = 0; i < 12; ++i) more[i] = ray_of(k, 4 + i);
        seen += std::popcount(solids->passing(more));
        part = static_cast<float>(seen) / 16.0f;
      }
      for (auto& light : points.light) light[k] *= part;
    }
    held = 0;
  };
  for (int k = 0; k < count; ++k) {
    const bool lit_at_all = points.light[0][k] > 0 || points.light[1][k] > 0 || points.light[2][k] > 0;
    if (points.near_solids[k] == 0 || !(cosines[k] > 0) || !lit_at_all) continue;
    for (std::size_t i = 0; i < 4; ++i) rays[4 * static_cast<std::size_t>(held) + i] = ray_of(k, i);
    waiting[held++] = k;
    if (held == kAtOnce) trace();
  }
  if (held > 0) trace();
}

void Scene::hits(std::span<const Ray> rays, Beam beam, std::span<SolidHit> hits) const {
  check(rays.size() == hits.size());
  for_each_block(rays, beam, [&](const RayBlock& block, const BlockBeams& beams, BlockHits& met, std::size_t first) {
    parts_->meet(block, beams, false, met);
    for (int lane = 0; lane < block.count; ++lane)
      hits[first + static_cast<std::size_t>(lane)] = parts_->hit_of(met, lane);
  });
}

void Scene::face_hits(std::span<const Ray> rays, Beam beam, const FaceHits& hits) const {
  check(rays.size() == hits.distance.size() && rays.size() == hits.face.size() && rays.size() == hits.albedo.size() &&
        rays.size() == hits.presence.size() && rays.size() == hits.others.size());
  // By Face: what it is called outside.
  std::int32_t names[8] = {0, 1, 2, 3, 4, 5, FaceHits::kOther, FaceHits::kOther};
  if (parts_->body && parts_->body->tank().style == TankStyle::glass) std::fill_n(names, 6, FaceHits::kOther);
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(parts_->ground.up[axis]) > 0.99999f)
      names[kGroundFace] = 2 * axis + (parts_->ground.up[axis] > 0 ? 1 : 0);
  for_each_block(rays, beam, [&](const RayBlock& block, const BlockBeams& beams, BlockHits& met, std::size_t first) {
    parts_->meet(block, beams, false, met);
    std::copy_n(met.distance, block.count, hits.distance.data() + first);
    std::copy_n(met.presence, block.count, hits.presence.data() + first);
    for (int lane = 0; lane < block.count; ++lane) {
      const std::size_t i = first + static_cast<std::size_t>(lane);
      const std::int32_t face = met.face[lane];
      hits.face[i] = face == meniscus::kNothing ? FaceHits::kNothing : names[face];
      hits.albedo[i] = {met.albedo[0][lane], met.albedo[1][lane], met.albedo[2][lane]};
      if (hits.face[i] == FaceHits::kOther) hits.others[i] = parts_->hit_of(met, lane);
    }
  });
}

void Scene::radiance(std::span<const Ray> rays, Beam beam, std::span<vec3> radiance, std::span<float> distance) const {
  check(rays.size() == radiance.size() && (distance.empty() || rays.size() == distance.size()));
  for_each_block(rays, beam, [&](const RayBlock& block, const BlockBeams& beams, BlockHits& met, std::size_t first) {
    parts_->meet(block, beams, false, met);
    BlockVectors seen;
    parts_->shade(block, beams, met, seen);
    for (int lane = 0; lane < block.count; ++lane) radiance[first + static_cast<std::size_t>(lane)] = seen.get(lane);
    if (!distance.empty()) std::copy_n(met.distance, block.count, distance.data() + first);
  });
}

void Scene::distances(std::span<const Ray> rays, std::span<float> distance) const {
  check(rays.size() == distance.size());
  for_each_block(rays, {}, [&](const RayBlock& block, const BlockBeams& beams, BlockHits& met, std::size_t first) {
    parts_->meet(block, beams, true, met);
    std::copy_n(met.distance, block.count, distance.data() + first);
  });
}

namespace {

/// What a thread keeps for its next block: it is long to make.
BlockHits& own_hits() {
  thread_local BlockHits hits;
  return hits;
}

}  // namespace

void Scene::block_radiance(const RayBlock& rays, const BlockBeams& beams, BlockVectors& radiance,
                           float* distance) const {
  BlockHits& hits = own_hits();
  parts_->meet(rays, beams, false, hits);
  parts_->shade(rays, beams, hits, radiance);
  if (distance) std::copy_n(hits.distance, rays.count, distance);
}

void Scene::block_distances(const RayBlock& rays, float* distance) const {
  BlockHits& hits = own_hits();
  static const BlockBeams none{};
  parts_->meet(rays, none, true, hits);
  std::copy_n(hits.distance, rays.count, distance);
}

void WaterLight::at_each(std::span<const vec3> points, std::span<const vec3> normals, std::span<Light> lights) const {
  for (std::size_t i = 0; i < points.size(); ++i) lights[i] = at(points[i], normals[i]);
}

}  // namespace meniscus
