// Pieces that are wider than a pixel: balls, pyramids and disks with what each pixel shows in them.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "meniscus/formulas/optics.h"
#include "shading/draw_rain_tile.h"

namespace meniscus {
namespace {

/// Part of a pile's light that its bumps scatter from everywhere instead of refracting it.
constexpr float kScattered = 0.2f;
/// Least variance of highlights, rad^2: narrower ones fall between pixels.
constexpr float kLeastVariance = 3e-4f;
/// Part of the faces' slope that piles are lit with: jets in the mean are round, and small ones are drawn as such.
constexpr float kLean = 0.3f;
/// Points along the edge of a pixel where small pieces are drawn whole.
constexpr int kFine = 16;

struct Pixels {
  int x0, y0, x1, y1;
  Pixels(const Tile& tile, vec2 low, vec2 high)
      : x0(std::max(tile.x0, static_cast<int>(std::floor(std::max(low.x, -1.0f))))),
        y0(std::max(tile.y0, static_cast<int>(std::floor(std::max(low.y, -1.0f))))),
        x1(std::min(tile.x1, static_cast<int>(std::ceil(std::min(high.x, 1e6f))))),
        y1(std::min(tile.y1, static_cast<int>(std::ceil(std::min(high.y, 1e6f))))) {}
};

/// The picture between pixel centres; its edge goes on outside.
vec3 sampled(const Image<vec3>& picture, float x, float y) {
  x = std::clamp(x - 0.5f, 0.0f, static_cast<float>(picture.width() - 1));
  y = std::clamp(y - 0.5f, 0.0f, static_cast<float>(picture.height() - 1));
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const int right = std::min(i + 1, picture.width() - 1), low = std::min(j + 1, picture.height() - 1);
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  return (1.0f - t) * ((1.0f - s) * picture(i, j) + s * picture(right, j)) +
         t * ((1.0f - s) * picture(i, low) + s * picture(right, low));
}

/// What the refracted ray shows: the picture behind where it goes on nearly as the ray of a pixel, else what is around.
/// @param straight  cosine between it and the viewing ray
/// @param t         m from the eye to the point
/// @param behind    m from the eye to what is seen behind the point
vec3 refracted_light(const RainPicture& picture, vec3 point, vec3 exit, float straight, float t, float behind,
                     float cone) {
  const vec3 around = picture.light.parts().radiance(exit, cone);
  float in_picture = glm::smoothstep(0.7f, 0.95f, straight);
  if (!(in_picture > 0)) return around;
  const float beyond = std::isfinite(behind) ? std::max(behind - t, 0.0f) : 1e5f;
  const vec3 place = picture.view.project(point + beyond * exit);
  if (!(place.z > 0)) return around;
  const auto width = static_cast<float>(picture.view.width), height = static_cast<float>(picture.view.height);
  // Fades towards the picture's edge, beyond which nothing is known.
  const float inside = std::min(std::min(place.x, width - place.x), std::min(place.y, height - place.y));
  in_picture *= std::clamp(inside / (0.03f * height), 0.0f, 1.0f);
  if (!(in_picture > 0)) return around;
  const int x = std::min(static_cast<int>(place.x), picture.view.width - 1);
  const int y = std::min(static_cast<int>(place.y), picture.view.height - 1);
  if (!(picture.depth(x, y) >= t)) return around;  // something stands before the water
  return around + in_picture * (sampled(picture.behind, place.x, place.y) - around);
}

// --- Balls -----------------------------------------------------------------------------------------------------

/// Where a ray passes a ball: beside its centre in radii, and the outward normal there.
struct Passage {
  float beside = 0;
  vec3 normal{0.0f};
  float t = 0;  ///< m along the ray to the point next to the centre
};

Passage passage(const Ray& ray, const WaterPiece& ball) {
  Passage p;
  const vec3 towards = ball.from - ray.origin;
  p.t = glm::dot(towards, ray.direction);
  const vec3 offset = (p.t * ray.direction - towards) / ball.radius;
  p.beside = glm::length(offset);
  // Pixels at the edge see its outermost ring.
  const float within = std::min(p.beside, 0.998f);
  const vec3 outwards = p.beside > 1e-6f ? offset * (within / p.beside) : vec3{0.0f};
  p.normal = outwards - std::sqrt(std::max(0.0f, 1.0f - within * within)) * ray.direction;
  return p;
}

vec3 ball_radiance(const RainPicture& picture, const Ray& ray, const Passage& p, float behind, float cone) {
  const BodyRays body = picture.light.rays(ray.direction, p.normal);
  const vec3 point = ray.origin + p.t * ray.direction;
  const vec3 through = refracted_light(picture, point, body.exit, body.straight, p.t, behind, cone);
  vec3 seen =
      body.mirrored * picture.light.parts().radiance(body.mirror_direction, cone) + (1.0f - body.mirrored) * through;
  if (picture.light.has_lamps()) seen += picture.light.glare(body, point, std::max(kLeastVariance, 0.5f * cone * cone));
  return seen;
}

void draw_ball(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  const WaterPiece& piece = picture.pieces[splat.piece];
  const WaterPiece ball{WaterPiece::Kind::sphere,
                        piece.kind == WaterPiece::Kind::streak ? 0.5f * (piece.from + piece.to) : piece.from,
                        {},
                        {},
                        piece.radius,
                        1};
  const float radius = 0.5f * splat.w0;
  // An edge that falls off over a pixel around this radius covers the ball's area.
  const float rim = std::sqrt(std::max(0.0f, radius * radius - 1.0f / 12.0f));
  // The picture in the ball comes out of the mean as it grows.
  const float detail = picture.look.level_of_detail ? glm::smoothstep(1.2f, 3.5f, radius) : 1.0f;
  const int fine = picture.look.level_of_detail || radius > 2.5f ? 1 : kFine;
  const float cone = std::min(1.0f / radius, 0.3f);
  const vec2 centre{splat.x, splat.y};
  const Pixels pixels(tile, centre - radius - 1.0f, centre + radius + 1.0f);
  for (int y = pixels.y0; y < pixels.y1; ++y)
    for (int x = pixels.x0; x < pixels.x1; ++x) {
      const float behind = picture.depth(x, y);
      float covered = 0, t = splat.t0;
      vec3 colour{0.0f};
      if (fine == 1) {
        const Ray ray = picture.view.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
        const Passage p = passage(ray, ball);
        covered = std::clamp(rim - p.beside * radius + 0.5f, 0.0f, 1.0f);
        if (!(covered > 0)) continue;
        colour = splat.colour;
        if (detail > 0) colour += detail * (ball_radiance(picture, ray, p, behind, cone) - colour);
        t = p.t;
      } else {
        for (int k = 0; k < fine * fine; ++k) {
          const Ray ray = picture.view.ray(
              {static_cast<float>(x) + (static_cast<float>(k % fine) + 0.5f) / static_cast<float>(fine),
               static_cast<float>(y) + (static_cast<float>(k / fine) + 0.5f) / static_cast<float>(fine)});
          const Passage p = passage(ray, ball);
          if (!(p.beside < 1)) continue;
          covered += 1;
          colour += ball_radiance(picture, ray, p, behind, 0.05f);
        }
        if (!(covered > 0)) continue;
        colour /= covered;
        covered /= static_cast<float>(fine * fine);
      }
      blend(tile.row(y)[x], colour, splat.alpha * covered * visible_part(picture.depth, x, y, t, splat.soft));
    }
}

// --- Pyramids --------------------------------------------------------------------------------------------------

/// A triangle in the picture with normals at its corners.
struct Face {
  std::array<vec2, 3> corners;     ///< px
  std::array<vec3, 3> normals;     ///< not unit
  std::array<float, 3> distances;  ///< m
  float per_area = 0;              ///< 1 / twice the signed area, px^-2
  vec3 margin{0.0f};               ///< by how much the weights differ between a pixel's middle and its corners

  /// Barycentric coordinates, all >= 0 inside.
  vec3 weights(vec2 p) const {
    const auto cross = [](vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; };
    const float a = cross(corners[1] - p, corners[2] - p) * per_area;
    const float b = cross(corners[2] - p, corners[0] - p) * per_area;
    return {a, b, 1.0f - a - b};
  }
};

/// The faces that look at the eye; where it looks into the base, that too.
int faces_of(const RainPicture& picture, const WaterPiece& piece, std::array<Face, 6>& faces) {
  const View& view = picture.view;
  const vec3 axis = piece.to - piece.from;
  const float height = glm::length(axis), half = glm::length(piece.across);
  const vec3 up = axis / height;
  const vec3 side = glm::cross(up, piece.across);
  const float side_length = glm::length(side);
  if (!(side_length > 1e-3f * half)) return 0;
  const vec3 other = side * (half / side_length);
  const std::array<vec3, 4> base{piece.from + piece.across, piece.from + other, piece.from - piece.across,
                                 piece.from - other};
  const bool parallel = view.projection == Projection::orthographic;
  const auto spot = [&](vec3 point) { return view.project(point); };
  const auto distance = [&](vec3 point, float depth) { return parallel ? depth : glm::length(point - view.eye); };
  const auto seen_from = [&](vec3 point, vec3 normal) {
    return glm::dot(parallel ? -view.forward : view.eye - point, normal) > 0;
  };
  const vec3 tip = spot(piece.to);
  const float tip_distance = distance(piece.to, tip.z);
  int count = 0;
  const auto add = [&](const Face& face) {
    const vec2 a = face.corners[1] - face.corners[0], b = face.corners[2] - face.corners[0];
    const float area = a.x * b.y - a.y * b.x;
    if (!(std::abs(area) > 1e-9f)) return;
    Face& added = faces[static_cast<std::size_t>(count++)];
    added = face;
    added.per_area = 1.0f / area;
    const vec3 origin = added.weights({0, 0});
    added.margin = 0.5f * (glm::abs(added.weights({1, 0}) - origin) + glm::abs(added.weights({0, 1}) - origin));
  };
  // Normals at the corners lean outwards along the diagonals, so that the light goes round the pile without edges.
  std::array<vec3, 4> places, normals;
  std::array<float, 4> distances;
  for (std::size_t k = 0; k < 4; ++k) {
    places[k] = spot(base[k]);
    distances[k] = distance(base[k], places[k].z);
    normals[k] = glm::normalize((base[k] - piece.from) * height + kLean * half * axis);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    const vec3 outwards = 0.5f * (base[k] + base[next]) - piece.from;
    if (!seen_from(piece.to, outwards * height * height + axis * glm::dot(outwards, outwards))) continue;
    add({{vec2{places[k]}, vec2{places[next]}, vec2{tip}},
         {normals[k], normals[next], 0.5f * (normals[k] + normals[next])},
         {distances[k], distances[next], tip_distance},
         0,
         {}});
  }
  if (seen_from(piece.from, -up)) {
    const vec3 n0 = -up;
    for (std::size_t k : {0u, 2u})
      add({{vec2{places[k]}, vec2{places[k + 1]}, vec2{places[(k + 2) % 4]}},
           {n0 + 0.7f * normals[k], n0 + 0.7f * normals[k + 1], n0 + 0.7f * normals[(k + 2) % 4]},
           {distances[k], distances[k + 1], distances[(k + 2) % 4]},
           0,
           {}});
  }
  return count;
}

/// Part of the pixel around `middle` that lies within the face.
float covered_part(const Face& face, vec2 middle, int fine) {
  const vec3 at_middle = face.weights(middle), least = at_middle - face.margin, most = at_middle + face.margin;
  if (most.x < 0 || most.y < 0 || most.z < 0) return 0;
  if (least.x >= 0 && least.y >= 0 && least.z >= 0) return 1;
  int inside = 0;
  for (int k = 0; k < fine * fine; ++k) {
    const vec2 p = middle + vec2{(static_cast<float>(k % fine) + 0.5f) / static_cast<float>(fine) - 0.5f,
                                 (static_cast<float>(k / fine) + 0.5f) / static_cast<float>(fine) - 0.5f};
    const vec3 w = face.weights(p);
    inside += w.x >= 0 && w.y >= 0 && w.z >= 0 ? 1 : 0;
  }
  return static_cast<float>(inside) / static_cast<float>(fine * fine);
}

void draw_pyramid(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  const WaterPiece& piece = picture.pieces[splat.piece];
  std::array<Face, 6> faces;
  const int count = faces_of(picture, piece, faces);
  vec2 low{1e30f}, high{-1e30f};
  for (int k = 0; k < count; ++k)
    for (const vec2 corner : faces[static_cast<std::size_t>(k)].corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
  const Pixels pixels(tile, low, high);
  const int fine = picture.look.level_of_detail ? 4 : kFine;
  const float cone = std::clamp(4.0f / splat.w0, 0.04f, 0.45f);
  for (int y = pixels.y0; y < pixels.y1; ++y)
    for (int x = pixels.x0; x < pixels.x1; ++x) {
      const vec2 middle{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
      float covered = 0, t = 0;
      vec3 normal{0.0f};
      for (int k = 0; k < count; ++k) {
        const Face& face = faces[static_cast<std::size_t>(k)];
        const float part = covered_part(face, middle, fine);
        if (!(part > 0)) continue;
        vec3 w = glm::max(face.weights(middle), vec3{0.0f});
        w /= w.x + w.y + w.z;
        covered += part;
        t += part * (w.x * face.distances[0] + w.y * face.distances[1] + w.z * face.distances[2]);
        normal += part * (w.x * face.normals[0] + w.y * face.normals[1] + w.z * face.normals[2]);
      }
      if (!(covered > 0)) continue;
      t /= covered;
      const float length = glm::length(normal);
      const Ray ray = picture.view.ray(middle);
      const BodyRays body = picture.light.rays(ray.direction, length > 1e-6f ? normal / length : -ray.direction);
      const vec3 point = ray.origin + t * ray.direction;
      const vec3 through = refracted_light(picture, point, body.exit, body.straight, t, picture.depth(x, y), cone);
      vec3 seen = body.mirrored * picture.light.parts().radiance(body.mirror_direction, cone) +
                  (1.0f - body.mirrored) * (through + kScattered * (picture.light.parts().mean - through));
      if (picture.light.has_lamps())
        seen += picture.light.glare(body, point, std::max(10 * kLeastVariance, 0.5f * cone * cone));
      blend(tile.row(y)[x], seen,
            splat.alpha * std::min(covered, 1.0f) * visible_part(picture.depth, x, y, t, splat.soft));
    }
}

// --- Disks -----------------------------------------------------------------------------------------------------

void draw_disk(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  const WaterPiece& piece = picture.pieces[splat.piece];
  const vec3 normal = glm::normalize(piece.across);
  const vec2 centre{splat.x, splat.y};
  const Pixels pixels(tile, centre - 0.5f * splat.w0 - 1.0f, centre + 0.5f * splat.w0 + 1.0f);
  // Distance from the centre in radii where a ray meets the plane; far away if it does not.
  const auto meet = [&](const Ray& ray) {
    const float along = glm::dot(ray.direction, normal);
    const float t = glm::dot(piece.from - ray.origin, normal) / along;
    return t > 0 && std::isfinite(t) ? (ray.origin + t * ray.direction - piece.from) / piece.radius : vec3{1e3f};
  };
  for (int y = pixels.y0; y < pixels.y1; ++y)
    for (int x = pixels.x0; x < pixels.x1; ++x) {
      const vec2 middle{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
      const Ray ray = picture.view.ray(middle);
      const vec3 place = meet(ray);
      const float rho = glm::length(place);
      // Coverage by the distance to the rim in pixels.
      const float dx = glm::length(meet(picture.view.ray(middle + vec2{1, 0}))) - rho;
      const float dy = glm::length(meet(picture.view.ray(middle + vec2{0, 1}))) - rho;
      const float slope = std::max(std::sqrt(dx * dx + dy * dy), 1e-6f);
      float covered = std::clamp((1.0f - rho) / slope + 0.5f, 0.0f, 1.0f);
      if (!picture.look.level_of_detail) {
        int inside = 0;
        for (int k = 0; k < kFine * kFine; ++k) {
          const vec2 p{(static_cast<float>(k % kFine) + 0.5f) / kFine, (static_cast<float>(k / kFine) + 0.5f) / kFine};
          inside += glm::length(meet(picture.view.ray(middle - 0.5f + p))) < 1 ? 1 : 0;
        }
        covered = static_cast<float>(inside) / (kFine * kFine);
      }
      if (!(covered > 0)) continue;
      // A lens that is flat in its middle and steep at the rim.
      const float within = std::min(rho, 1.0f), rim = within * within * within * within;
      const vec3 towards_eye = glm::dot(ray.direction, normal) > 0 ? -normal : normal;
      const vec3 tilted = glm::normalize(towards_eye + 0.6f * within * within * within * place);
      const float cos_i = std::max(0.0f, -glm::dot(ray.direction, tilted));
      const vec3 mirror = glm::normalize(formulas::mirrored(ray.direction, tilted));
      const float mirrored = formulas::fresnel_reflectance(cos_i, picture.look.ior);
      const vec3 below = picture.behind(x, y);
      const vec3 around = picture.light.parts().radiance(-mirror, 0.9f);
      vec3 seen = mirrored * picture.light.parts().radiance(mirror, 0.03f) +
                  (1.0f - mirrored) * (below + 0.4f * rim * (around - below));
      if (picture.light.has_lamps()) seen += mirrored * picture.light.glare({mirror, mirror, 1, 0}, piece.from, 3e-3f);
      blend(tile.row(y)[x], seen, splat.alpha * covered * visible_part(picture.depth, x, y, splat.t0, splat.soft));
    }
}

}  // namespace

void draw_body(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  switch (splat.kind) {
    case Splat::Kind::ball:
      return draw_ball(picture, tile, splat);
    case Splat::Kind::pyramid:
      return draw_pyramid(picture, tile, splat);
    case Splat::Kind::disk:
      return draw_disk(picture, tile, splat);
    default:
      return;
  }
}

}  // namespace meniscus
