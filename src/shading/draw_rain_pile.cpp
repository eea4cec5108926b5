// Piles of water: pyramids in outline, round jets in light.
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>

#include "shading/draw_rain_body.h"

namespace meniscus {
namespace {

/// Part of the height over which a pile comes out of the water that it stands on: there it shows what is behind it.
constexpr float kFoot = 0.15f;

/// A triangle in the picture.
struct Face {
  std::array<vec2, 3> corners;     ///< px
  std::array<vec3, 3> normals;     ///< not unit
  std::array<float, 3> distances;  ///< m
  bool to_tip = false;             ///< its third corner is the tip
  float per_area = 0;              ///< 1 / twice the signed area, px^-2
  vec3 margin{0.0f};               ///< by how much the weights differ between a pixel's middle and its corners

  /// Barycentric coordinates, all >= 0 inside.
  vec3 weights(vec2 p) const {
    const auto cross = [](vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; };
    const float a = cross(corners[1] - p, corners[2] - p) * per_area;
    const float b = cross(corners[2] - p, corners[0] - p) * per_area;
    return {a, b, 1.0f - a - b};
  }
  bool holds(vec2 p) const {
    const vec3 w = weights(p);
    return w.x >= 0 && w.y >= 0 && w.z >= 0;
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
    normals[k] = glm::normalize((base[k] - piece.from) * height + kLeanOfPiles * half * axis);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    const vec3 outwards = 0.5f * (base[k] + base[next]) - piece.from;
    if (!seen_from(piece.to, outwards * height * height + axis * glm::dot(outwards, outwards))) continue;
    add({{vec2{places[k]}, vec2{places[next]}, vec2{tip}},
         {normals[k], normals[next], 0.5f * (normals[k] + normals[next])},
         {distances[k], distances[next], tip_distance},
         true,
         0,
         {}});
  }
  if (seen_from(piece.from, -up)) {
    const vec3 n0 = -up;
    for (std::size_t k : {0u, 2u})
      add({{vec2{places[k]}, vec2{places[k + 1]}, vec2{places[(k + 2) % 4]}},
           {n0 + 0.7f * normals[k], n0 + 0.7f * normals[k + 1], n0 + 0.7f * normals[(k + 2) % 4]},
           {distances[k], distances[k + 1], distances[(k + 2) % 4]},
           false,
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
    inside += face.holds(p) ? 1 : 0;
  }
  return static_cast<float>(inside) / static_cast<float>(fine * fine);
}

/// A pile as a cone of round sections.
struct Cone {
  vec3 foot, up;       ///< m, the middle of the base; unit, towards the tip
  float height, half;  ///< m
  vec3 one, other;     ///< half the base's diagonals, m

  explicit Cone(const WaterPiece& piece)
      : foot(piece.from),
        up(piece.to - piece.from),
        height(glm::length(up)),
        half(glm::length(piece.across)),
        one(piece.across) {
    up /= height;
    other = glm::cross(up, one);
  }
  float slope() const { return half / height; }
  /// Unit normal where a ray passes at this part of the height: it goes round the axis from rim to rim of what is seen.
  /// @param otherwise  where the ray goes along the axis
  vec3 normal(const Ray& ray, float along, vec3 otherwise) const {
    const vec3 side = glm::cross(ray.direction, up);
    const float side2 = glm::dot(side, side), aside = glm::smoothstep(0.04f, 0.25f, side2);
    if (!(aside > 0)) return otherwise;
    const vec3 across = side / std::sqrt(side2), towards = glm::cross(across, up);  // `towards` is away from the eye
    const float reach = std::max(std::abs(glm::dot(one, across)), std::abs(glm::dot(other, across)));
    const float radius = std::max(reach * (1.0f - along), 1e-3f * half);
    const float beside = std::clamp(glm::dot(ray.origin - foot, across) / radius, -0.99f, 0.99f);
    const float facing = std::sqrt(1.0f - beside * beside);
    const vec3 to_eye = glm::dot(towards, ray.direction) < 0 ? towards : -towards;
    const vec3 round = glm::normalize(beside * across + facing * to_eye + kLeanOfPiles * slope() * up);
    return aside < 1 ? glm::normalize(otherwise + aside * (round - otherwise)) : round;
  }
};

/// What a place of a pile shows: a mirror image, what is behind, a little displaced, and at its rims light that has
/// come up in it. @param sky  of that, linear
vec3 pile_radiance(const RainPicture& picture, const Ray& ray, vec3 normal, vec3 sky, float t, float behind,
                   float cone) {
  const JetRays jet = picture.light.jet_rays(ray.direction, normal);
  const vec3 point = ray.origin + t * ray.direction;
  const vec3 through = refracted_light(picture, point, jet.body.exit, jet.body.straight, t, behind, cone);
  vec3 seen = jet.body.mirrored * picture.light.parts().radiance(jet.body.mirror_direction, cone) +
              (1.0f - jet.body.mirrored) * (through + jet.scattered * (sky - through));
  if (picture.light.has_lamps())
    seen += picture.light.glare(jet.body, point, std::max(10 * kLeastVariance, 0.5f * cone * cone));
  return seen;
}

/// What a pixel, or a point of it, sees of a pile.
struct Place {
  float covered = 0;  ///< part of the pixel
  float t = 0;        ///< m from the eye
  float along = 0;    ///< part of the height
  vec3 normal{0.0f};  ///< of the faces, not unit
};

/// @param part_of  how much of the pixel a face covers
template <class PartOf>
Place place_at(std::span<const Face> faces, vec2 point, PartOf part_of) {
  Place place;
  for (const Face& face : faces) {
    const float part = part_of(face);
    if (!(part > 0)) continue;
    vec3 w = glm::max(face.weights(point), vec3{0.0f});
    w /= w.x + w.y + w.z;
    place.covered += part;
    place.t += part * (w.x * face.distances[0] + w.y * face.distances[1] + w.z * face.distances[2]);
    place.normal += part * (w.x * face.normals[0] + w.y * face.normals[1] + w.z * face.normals[2]);
    if (face.to_tip) place.along += part * w.z;
  }
  if (place.covered > 0) {
    place.t /= place.covered;
    place.along /= place.covered;
  }
  return place;
}

/// The light of one pile.
class PileLight {
 public:
  PileLight(const RainPicture& picture, const Splat& splat)
      : picture_(picture),
        shape_(picture.pieces[splat.piece]),
        mean_(splat.colour),
        // Its details come out of the mean as it grows.
        detail_(picture.look.level_of_detail ? glm::smoothstep(1.2f, 3.5f, 0.5f * splat.w0) : 1.0f),
        cone_(std::clamp(4.0f / splat.w0, 0.04f, 0.45f)),
        sky_(picture.light.in_jets(shape_.up)) {}

  /// @param point  px, in the pixel (x, y)
  vec3 at(int x, int y, vec2 point, const Place& place) const {
    if (!(detail_ > 0)) return mean_;
    const Ray ray = picture_.view.ray(point);
    const float length = glm::length(place.normal);
    const vec3 normal = shape_.normal(ray, place.along, length > 1e-6f ? place.normal / length : -ray.direction);
    vec3 seen = pile_radiance(picture_, ray, normal, sky_, place.t, picture_.depth(x, y), cone_);
    seen += (1.0f - glm::smoothstep(0.0f, kFoot, place.along)) * (picture_.behind(x, y) - seen);
    return mean_ + detail_ * (seen - mean_);
  }

 private:
  const RainPicture& picture_;
  Cone shape_;
  vec3 mean_;
  float detail_, cone_;
  vec3 sky_;
};

}  // namespace

void draw_pile(const RainPicture& picture, const Tile& tile, const Splat& splat) {
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
  const PileLight light(picture, splat);
  for (int y = pixels.y0; y < pixels.y1; ++y)
    for (int x = pixels.x0; x < pixels.x1; ++x) {
      const vec2 middle{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
      Place place;
      vec3 seen{0.0f};
      if (picture.look.level_of_detail) {
        place = place_at({faces.data(), static_cast<std::size_t>(count)}, middle,
                         [&](const Face& face) { return covered_part(face, middle, 4); });
        if (!(place.covered > 0)) continue;
        seen = light.at(x, y, middle, place);
      } else {
        for (int k = 0; k < kFine * kFine; ++k) {
          const vec2 point =
              middle - 0.5f +
              vec2{static_cast<float>(k % kFine) + 0.5f, static_cast<float>(k / kFine) + 0.5f} / float{kFine};
          const Place one = place_at({faces.data(), static_cast<std::size_t>(count)}, point,
                                     [&](const Face& face) { return face.holds(point) ? 1.0f : 0.0f; });
          if (!(one.covered > 0)) continue;
          place.covered += 1;
          place.t += one.t;
          seen += light.at(x, y, point, one);
        }
        if (!(place.covered > 0)) continue;
        place.t /= place.covered;
        seen /= place.covered;
        place.covered /= kFine * kFine;
      }
      blend(tile.row(y)[x], seen,
            splat.alpha * std::min(place.covered, 1.0f) * visible_part(picture.depth, x, y, place.t, splat.soft));
    }
}

}  // namespace meniscus
