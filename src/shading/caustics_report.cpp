#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "shading/caustics_photons.h"

namespace meniscus {

CausticsReport measure_caustics(const Surface& surface, const Scene& scene, const Material& material,
                                const CausticsOptions& options, StageTimes* times, int finer) {
  CausticsReport report;
  const Bounds box = casting_box(surface, {});
  const auto lights = box.empty() ? std::vector<LightSource>{} : caustics_lights(scene, box, 1);
  if (lights.empty()) return report;
  const LightCast cast = cast_light(surface, lights[0], box, scene, material, options, times, true);
  report.triangles = cast.balance.triangles;
  report.entered = cast.balance.entered;
  report.absorbed = cast.balance.absorbed;
  report.mirrored = cast.balance.mirrored + cast.balance.trapped;
  report.landed = cast.balance.drawn + cast.balance.hidden + cast.balance.grazing;
  if (finer <= 0 || cast.maps.empty()) return report;

  StageTimes reference;
  Image<vec3> photons;
  {
    const StageTimer timer(&reference, "reference");
    photons = photon_map(surface, cast, scene, material, finer, options.single_interface);
  }
  report.reference_ms = reference.total_ms();
  const auto grey = [](vec3 v) {
    return (static_cast<double>(v.x) + static_cast<double>(v.y) + static_cast<double>(v.z)) / 3;
  };
  const double count = static_cast<double>(photons.size());
  double mean = 0, error = 0;
  for (const vec3& texel : photons) mean += grey(texel) / count;
  const double white = 4 * mean;
  for (std::size_t i = 0; i < photons.size(); ++i) {
    const double d = std::min(grey(photons[i]), white) - std::min(grey(cast.maps[0].texels()[i]), white);
    error += d * d / count;
  }
  report.psnr_db = error > 0 ? 10 * std::log10(white * white / error) : 0;
  return report;
}

}  // namespace meniscus
