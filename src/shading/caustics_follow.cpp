#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/formulas/optics.h"
#include "shading/caustics_landing.h"
#include "shading/sample.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Interfaces after the first that light is followed across.
constexpr int kInterfaces = 5;
/// Spacings between where the water ends and a solid, up to which it stands on the solid.
constexpr float kTouching = 1.5f;
/// Where the straight way down holds this part of water and more, bent light does not leave it either.
constexpr float kFull = 0.9f;

/// What happens at an interface; two bits each in LightLanding::way.
enum Event : std::uint8_t { came_out = 1, was_mirrored = 2, came_in = 3 };

/// The light of one point after the interfaces so far.
struct Parcel {
  std::size_t index = 0;
  Ray ray;
  float water = 0;     ///< m in water so far
  float to_solid = 0;  ///< m along the ray; infinity: none
  vec3 solid_normal{0.0f};
  float later = 1;
  vec3 exit{0.0f};
  std::uint16_t way = 0;
  std::uint8_t inside = 1, mirrored = 0;
  bool done = false;
};

class Follower {
 public:
  Follower(const Surface& surface, const Scene& scene, const Material& material, Image<LightLanding>& landings)
      : scene_(scene),
        material_(material),
        landings_(landings),
        extinction_(caustics_extinction(material)),
        touching_(kTouching * surface.spacing()) {}

  /// Takes the parcel over the interface that it meets, or brings it to its end.
  void step(Parcel& parcel, const Crossing& crossing) const {
    const bool ends = !(crossing.distance < kInfinity) || (parcel.inside && touches(parcel, crossing.distance));
    if (ends) {
      if (parcel.inside) parcel.water += std::min(parcel.to_solid, 1e30f);
      finish(parcel);
      return;
    }
    const vec3 direction = parcel.ray.direction;
    const vec3 normal = facing(parcel.inside ? -crossing.normal : crossing.normal, direction);
    const float eta = parcel.inside ? 1.0f / material_.ior : material_.ior;
    const formulas::Interface interface = formulas::fresnel(-glm::dot(direction, normal), eta);
    if (parcel.inside) parcel.water += crossing.distance;
    parcel.ray.origin += crossing.distance * direction;
    Event event = parcel.inside ? came_out : came_in;
    if (interface.cos_t > 0) {
      parcel.later *= 1.0f - std::min(1.0f, interface.reflectance * material_.specular);
      parcel.ray.direction = formulas::refracted(direction, normal, eta, interface.cos_t);
      if (parcel.inside && parcel.way == 0) parcel.exit = parcel.ray.origin;
      parcel.inside = !parcel.inside;
    } else {
      if (parcel.mirrored) {
        LightLanding& landing = landings_[parcel.index];
        landing.state = LandingState::trapped;
        landing.passed = vec3{0.0f};
        parcel.done = true;
        return;
      }
      parcel.mirrored = 1;
      event = was_mirrored;
      parcel.exit = parcel.ray.origin;
      parcel.ray.direction = glm::normalize(formulas::mirrored(direction, normal));
    }
    parcel.way = static_cast<std::uint16_t>(parcel.way * 4 + event);
    aim(parcel);
  }

  /// The parcel lands at what it meets without further interfaces.
  void finish(Parcel& parcel) const {
    parcel.done = true;
    if (parcel.way == 0) return;  // as it landed before
    LightLanding& landing = landings_[parcel.index];
    landing.way = parcel.way;
    landing.later = parcel.later;
    landing.exit = parcel.exit;
    landing.direction = parcel.ray.direction;
    if (!(parcel.to_solid < kInfinity)) {
      landing.state = LandingState::lost;
      landing.passed = vec3{0.0f};
      return;
    }
    landing.point = parcel.ray.origin + parcel.to_solid * parcel.ray.direction;
    landing.normal = parcel.solid_normal;
    landing.path = parcel.water;
    landing.passed = landing.transmittance * landing.later * formulas::beer_lambert(extinction_, landing.path);
    landing.state = LandingState::landed;
  }

  /// Finds the solid on the parcel's way.
  void aim(Parcel& parcel) const {
    const SolidHit hit = scene_.hit(parcel.ray);
    parcel.to_solid = hit.distance;
    parcel.solid_normal = hit.face_normal;
  }

 private:
  bool touches(const Parcel& parcel, float distance) const {
    return parcel.to_solid < kInfinity &&
           (parcel.to_solid - distance) * std::abs(glm::dot(parcel.ray.direction, parcel.solid_normal)) <= touching_;
  }

  const Scene& scene_;
  const Material& material_;
  Image<LightLanding>& landings_;
  vec3 extinction_;
  float touching_;
};

/// Whether the straight way from a point to the floor may leave the water.
bool may_leave(const VirtualScreen& screen, const LightLanding& landing, int x, int y) {
  if (landing.state != LandingState::landed) return true;
  const Ray ray = screen.ray(x, y);
  const float along = std::abs(glm::dot(ray.direction, landing.normal));
  const float level = std::abs(glm::dot(landing.from - landing.point, landing.normal));
  return !(screen.seen.thickness(x, y) * along >= kFull * level);
}

}  // namespace

void follow(const VirtualScreen& screen, const Surface& surface, const Scene& scene, const Material& material,
            Image<LightLanding>& landings) {
  const Follower follower(surface, scene, material, landings);
  const bool thickness_known =
      std::any_of(screen.seen.thickness.begin(), screen.seen.thickness.end(), [](float t) { return t > 0; });
  // In squares of four by four points, so that sixteen consecutive rays lie close together.
  constexpr int kSquare = 4;
  std::vector<Parcel> parcels;
  for (int top = 0; top < screen.height; top += kSquare)
    for (int left = 0; left < screen.width; left += kSquare)
      for (int y = top; y < std::min(top + kSquare, screen.height); ++y)
        for (int x = left; x < std::min(left + kSquare, screen.width); ++x) {
          const LightLanding& landing = landings(x, y);
          if (landing.state == LandingState::dry || !(landing.transmittance > 0)) continue;
          if (thickness_known && !may_leave(screen, landing, x, y)) continue;
          Parcel parcel;
          parcel.index =
              static_cast<std::size_t>(y) * static_cast<std::size_t>(screen.width) + static_cast<std::size_t>(x);
          parcel.ray = {landing.from, landing.direction};
          parcel.exit = landing.from;
          const bool landed = landing.state == LandingState::landed;
          parcel.to_solid = landed ? landing.path : kInfinity;
          parcel.solid_normal = landing.normal;
          parcels.push_back(parcel);
        }

  std::vector<Ray> rays;
  std::vector<float> from, limit;
  std::vector<std::uint8_t> inside;
  std::vector<Crossing> found;
  for (int i = 0; i < kInterfaces && !parcels.empty(); ++i) {
    rays.clear();
    limit.clear();
    inside.clear();
    for (const Parcel& parcel : parcels) {
      rays.push_back(parcel.ray);
      limit.push_back(parcel.to_solid);
      inside.push_back(parcel.inside);
    }
    from.assign(parcels.size(), 0.0f);
    found.assign(parcels.size(), Crossing{});
    surface.crossings(rays, from, limit, inside, found);
    parallel_for(parcels.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p) follower.step(parcels[p], found[p]);
    });
    std::erase_if(parcels, [](const Parcel& parcel) { return parcel.done; });
  }
  // What is still on its way goes on in what it is in.
  for (Parcel& parcel : parcels) {
    if (parcel.inside && parcel.to_solid < kInfinity) parcel.water += parcel.to_solid;
    follower.finish(parcel);
  }
}

}  // namespace meniscus
