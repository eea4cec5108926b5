#include "shading/caustics_photons.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "shading/light_map.h"

namespace meniscus {

Image<vec3> photon_map(const Surface& surface, const LightCast& cast, const Scene& scene, const Material& material,
                       int finer, bool single_interface) {
  if (cast.maps.empty()) return {};
  const CausticsMap& map = cast.maps.front();
  const View& view = map.view();

  // The same picture of the water in more points.
  VirtualScreen screen;
  screen.view = cast.screen.view.resized(cast.screen.view.width * finer, cast.screen.view.height * finer);
  screen.width = screen.view.width;
  screen.height = screen.view.height;
  screen.up = cast.screen.up;
  screen.seen = surface.see(screen.view);
  for (std::size_t i = 0; i < screen.seen.coverage.size(); ++i)
    screen.seen.coverage[i] = screen.seen.coverage[i] > 0.5f && std::isfinite(screen.seen.depth[i]) &&
                              glm::dot(screen.seen.normal[i], screen.seen.normal[i]) > 0.25f;
  CausticsOptions options;
  options.single_interface = single_interface;
  const Image<LightLanding> landings = land(screen, surface, cast.light, scene, material, nullptr, options);

  Image<vec3> texels(view.width, view.height);
  const float texel = view.pixel_size(0.0f), per_area = 1.0f / (texel * texel);
  for (int y = 0; y < screen.height; ++y)
    for (int x = 0; x < screen.width; ++x) {
      const LightLanding& landing = landings(x, y);
      if (landing.state != LandingState::landed || -glm::dot(landing.normal, view.forward) < kGrazingCosine ||
          map.solids().hides(landing.point, landing.normal).surely)
        continue;
      const vec3 right = screen.beside(x + 1, y, landing.from) - landing.from;
      const vec3 below = screen.beside(x, y + 1, landing.from) - landing.from;
      const vec3 power = std::abs(glm::dot(glm::cross(right, below), cast.light.towards(landing.from))) *
                         cast.light.irradiance(landing.from) * landing.passed;
      const vec3 at = view.project(landing.point);
      const int i = static_cast<int>(std::floor(at.x)), j = static_cast<int>(std::floor(at.y));
      if (i >= 0 && j >= 0 && i < view.width && j < view.height) texels(i, j) += power * per_area;
    }
  blur_finely(texels, cast.smooth_px);
  return texels;
}

}  // namespace meniscus
