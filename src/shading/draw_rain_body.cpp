// Pieces that are wider than a pixel: balls and disks with what each pixel shows in them.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "meniscus/formulas/optics.h"
#include "shading/draw_rain_body.h"

namespace meniscus {
namespace {

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

void draw_body(const RainPicture& picture, const Tile& tile, const Splat& splat) {
  switch (splat.kind) {
    case Splat::Kind::ball:
      return draw_ball(picture, tile, splat);
    case Splat::Kind::pyramid:
      return draw_pile(picture, tile, splat);
    case Splat::Kind::disk:
      return draw_disk(picture, tile, splat);
    default:
      return;
  }
}

}  // namespace meniscus
