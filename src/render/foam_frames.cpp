#include "render/foam_frames.h"

#include <fmt/format.h>

#include "render/numbered_path.h"
#include "render/solid_depths.h"

namespace meniscus {

std::vector<vec3> foam_of_frame(const FoamOptions& foam, std::int64_t number, const ReadOptions& reading,
                                std::vector<std::string>& notes) {
  ReadOptions options;  // which particles of the water are meant does not concern the foam
  options.scale = reading.scale;
  options.origin = reading.origin;
  options.allow_outside = reading.allow_outside;
  std::vector<vec3> places;
  for (const std::string& file : foam.files) {
    const NumberedPath path(file);
    try {
      const Particles particles = read_particles(path.of(number), options);
      places.reserve(places.size() + particles.size());
      for (std::size_t i = 0; i < particles.size(); ++i) places.push_back(particles.position(i));
    } catch (const Error& error) {
      notes.push_back(fmt::format("foam left out: {}", error.what()));
    }
  }
  return places;
}

void draw_foam_over(const FrameSettings& settings, const View& view, const Scene& scene, const SurfaceBuffers& buffers,
                    const SceneBuffers* solids, Image<vec3>& radiance, StageTimes* times) {
  FoamLook look = settings.foam_look;
  constexpr float kRadius = 0.3f;  // spacings
  if (look.radius == 0) look.radius = kRadius * settings.surface.spacing;
  draw_foam(view, settings.foam, look, settings.environment, settings.material, settings.ground.up, buffers,
            solid_depths(view, scene, solids), radiance, times);
}

}  // namespace meniscus
