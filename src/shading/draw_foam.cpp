// Particles of spray, foam and bubbles over a shaded picture: each is a soft disc, seen through the water's surface
// where it lies behind that.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "meniscus/formulas/optics.h"
#include "meniscus/shading.h"

namespace meniscus {
namespace {

constexpr int kTile = 32;             ///< px
constexpr float kLeastRadius = 1.5f;  ///< px; smaller discs are drawn so wide, and fainter
constexpr int kSteps = 8;             ///< towards the pixel in which a disc behind the surface is seen

/// A disc in the picture.
struct Disc {
  vec2 middle;         ///< px
  float radius = 0;    ///< px; 0: not seen
  float distance = 0;  ///< m along the ray
  bool under = false;  ///< behind the water's surface
  float opacity = 0;
  vec3 radiance{0.0f};
};

void check(const View& view, std::span<const vec3> places, const FoamLook& look, const SurfaceBuffers& water,
           const Image<float>& solids, const Image<vec3>& radiance) {
  if (view.projection == Projection::cube) throw Error(ErrorCode::unsupported, "foam is not drawn into cube views");
  const auto fits = [&](const auto& image) { return image.width() == view.width && image.height() == view.height; };
  if (!fits(radiance) || !fits(solids) || !fits(water.depth) || !fits(water.normal))
    throw Error(
        ErrorCode::invalid_argument,
        fmt::format("buffers of another size do not belong to a view of {} x {} pixels", view.width, view.height));
  if (!(look.radius > 0) || !std::isfinite(look.radius))
    throw Error(ErrorCode::invalid_argument, fmt::format("a foam radius of {} m is not above 0", look.radius));
  if (!(look.opacity >= 0 && look.opacity <= 1))
    throw Error(ErrorCode::invalid_argument, fmt::format("an opacity of {} is not from 0 to 1", look.opacity));
  if (places.size() > 0xffffffffu)
    throw Error(ErrorCode::limit_exceeded, "more than 2^32 particles of foam in one picture");
}

/// Light that a white ball sends to the eye, by the angle between the directions to the eye and to the sun: Lambert's
/// ball, 2 / (3 pi) (sin a + (pi - a) cos a) of its albedo / pi.
float ball_phase(float cosine) {
  const float c = std::clamp(cosine, -1.0f, 1.0f), a = std::acos(c);
  return 2.0f / (3.0f * std::numbers::pi_v<float>)*(std::sin(a) + (std::numbers::pi_v<float> - a) * c);
}

class Discs {
 public:
  Discs(const View& view, const FoamLook& look, const Environment& environment, const Material& material,
        const SurfaceBuffers& water, vec3 up)
      : view_(view), look_(look), environment_(environment), material_(material), water_(water) {
    // From above and from below in equal parts: water throws the sky's light back from beneath.
    sky_ = 0.5f * (environment.irradiance(up) + environment.irradiance(-up));
  }

  Disc at(vec3 place) const {
    Disc disc;
    const vec3 seen = view_.project(place);
    if (!(seen.z > 0) && view_.projection == Projection::perspective) return disc;
    disc.middle = {seen.x, seen.y};
    disc.distance = distance_to(place);
    if (!(disc.distance > 0) || !std::isfinite(seen.x) || !std::isfinite(seen.y)) return disc;
    const float radius = look_.radius / view_.pixel_size(seen.z);
    const float reach = 2.0f * std::max(radius, kLeastRadius);
    if (seen.x < -reach || seen.y < -reach || seen.x > static_cast<float>(view_.width) + reach ||
        seen.y > static_cast<float>(view_.height) + reach)
      return disc;
    const vec3 to_eye =
        view_.projection == Projection::perspective ? glm::normalize(view_.eye - place) : -view_.forward;
    disc.radiance = look_.albedo / std::numbers::pi_v<float> *
                    (sky_ + ball_phase(glm::dot(to_eye, environment_.sun_direction())) * environment_.sun_irradiance());
    disc.opacity = look_.opacity;
    const float surface = surface_at(disc.middle);
    if (!water_.eye_in_water && surface < disc.distance - look_.radius && !look_behind(place, disc)) return disc;
    // What is thinner than a pixel covers less of it.
    const float drawn = std::max(radius, kLeastRadius);
    disc.opacity *= (radius / drawn) * (radius / drawn);
    disc.radius = drawn;
    return disc;
  }

 private:
  float distance_to(vec3 place) const {
    return view_.projection == Projection::perspective ? glm::length(place - view_.eye)
                                                       : glm::dot(place - view_.eye, view_.forward);
  }

  bool pixel_of(vec2 at, int& x, int& y) const {
    x = static_cast<int>(std::floor(at.x));
    y = static_cast<int>(std::floor(at.y));
    return x >= 0 && y >= 0 && x < view_.width && y < view_.height;
  }

  /// m along the ray; infinity beside the water and the picture.
  float surface_at(vec2 at) const {
    int x = 0, y = 0;
    return pixel_of(at, x, y) ? water_.depth(x, y) : std::numeric_limits<float>::infinity();
  }

  /// Moves the disc to where it is seen through the surface: from the point of the surface in its pixel the refracted
  /// ray goes past the particle; the picture point moves by as much. False: it is not seen through the surface.
  bool look_behind(vec3 place, Disc& disc) const {
    vec2 at = disc.middle;
    float path = 0, reflected = 1;
    for (int step = 0; step < kSteps; ++step) {
      int x = 0, y = 0;
      if (!pixel_of(at, x, y) || !std::isfinite(water_.depth(x, y))) return false;
      const Ray ray = view_.ray(at);
      const vec3 surface = ray.origin + water_.depth(x, y) * ray.direction, normal = water_.normal(x, y);
      const float cosine = -glm::dot(ray.direction, normal);
      if (!(cosine > 0)) return false;
      const formulas::Interface between = formulas::fresnel(cosine, material_.ior);
      const vec3 inside = formulas::refracted(ray.direction, normal, material_.ior, between.cos_t);
      path = std::max(glm::dot(place - surface, inside), 0.0f);
      reflected = between.reflectance;
      if (step + 1 == kSteps) break;
      const vec3 beside = place - (surface + path * inside);
      const vec3 moved = view_.project(surface + beside);
      if (!(moved.z > 0) && view_.projection == Projection::perspective) return false;
      at = {moved.x, moved.y};
    }
    disc.under = true;
    disc.middle = at;
    // Its light comes down through about as much water as it then passes on its way to the eye.
    disc.radiance *= formulas::beer_lambert(material_.extinction + material_.scattering, 2.0f * path);
    disc.opacity *= 1.0f - reflected;
    return true;
  }

  const View& view_;
  const FoamLook& look_;
  const Environment& environment_;
  const Material& material_;
  const SurfaceBuffers& water_;
  vec3 sky_;
};

struct Rect {
  int x0, y0, x1, y1;  ///< tiles, both ends included
};

Rect tiles_of(const Disc& disc, int across, int down) {
  const auto tile = [](float at, int most) {
    return std::clamp(static_cast<int>(std::floor(at / kTile)), 0, most - 1);
  };
  return {tile(disc.middle.x - disc.radius, across), tile(disc.middle.y - disc.radius, down),
          tile(disc.middle.x + disc.radius, across), tile(disc.middle.y + disc.radius, down)};
}

/// From far to near, behind the surface before in front of it, then by index.
std::uint64_t key_of(const Disc& disc, std::size_t index) {
  const std::uint32_t near = std::bit_cast<std::uint32_t>(disc.distance) >> 1;  // distances are positive
  const std::uint32_t order = (disc.under ? 0u : 1u << 31) | (0x7fffffffu - near);
  return static_cast<std::uint64_t>(order) << 32 | index;
}

void draw(const Disc& disc, int x0, int y0, int x1, int y1, const SurfaceBuffers& water, const Image<float>& solids,
          Image<vec3>& radiance) {
  const auto first = [](float at, int low) { return std::max(low, static_cast<int>(std::floor(at))); };
  const auto last = [](float at, int high) { return std::min(high, static_cast<int>(std::ceil(at)) + 1); };
  for (int y = first(disc.middle.y - disc.radius, y0); y < last(disc.middle.y + disc.radius, y1); ++y)
    for (int x = first(disc.middle.x - disc.radius, x0); x < last(disc.middle.x + disc.radius, x1); ++x) {
      const vec2 off = vec2{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f} - disc.middle;
      const float rest = 1.0f - glm::dot(off, off) / (disc.radius * disc.radius);
      if (rest <= 0) continue;
      // Solids hide it; behind the surface those in front of the surface do.
      const float hidden_from = disc.under ? water.depth(x, y) : disc.distance;
      if (!(hidden_from <= solids(x, y)) || (disc.under && !std::isfinite(hidden_from))) continue;
      const float weight = disc.opacity * rest * rest;
      radiance(x, y) += weight * (disc.radiance - radiance(x, y));
    }
}

}  // namespace

void draw_foam(const View& view, std::span<const vec3> places, const FoamLook& look, const Environment& environment,
               const Material& material, vec3 up, const SurfaceBuffers& water, const Image<float>& solids,
               Image<vec3>& radiance, StageTimes* times) {
  check(view, places, look, water, solids, radiance);
  const StageTimer timer(times, "foam");
  const Discs discs_of(view, look, environment, material, water, up);
  std::vector<Disc> discs(places.size());
  parallel_for(places.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) discs[i] = discs_of.at(places[i]);
  });
  const int across = (view.width + kTile - 1) / kTile, down = (view.height + kTile - 1) / kTile;
  std::vector<std::vector<std::uint64_t>> tiles(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  for (std::size_t i = 0; i < discs.size(); ++i) {
    if (!(discs[i].radius > 0)) continue;
    const Rect rect = tiles_of(discs[i], across, down);
    for (int y = rect.y0; y <= rect.y1; ++y)
      for (int x = rect.x0; x <= rect.x1; ++x)
        tiles[static_cast<std::size_t>(y * across + x)].push_back(key_of(discs[i], i));
  }
  parallel_for(tiles.size(), 1, [&](std::size_t tile, std::size_t) {
    std::sort(tiles[tile].begin(), tiles[tile].end());
    const int x0 = static_cast<int>(tile) % across * kTile, y0 = static_cast<int>(tile) / across * kTile;
    for (const std::uint64_t key : tiles[tile])
      draw(discs[key & 0xffffffffu], x0, y0, std::min(x0 + kTile, view.width), std::min(y0 + kTile, view.height), water,
           solids, radiance);
  });
}

}  // namespace meniscus
