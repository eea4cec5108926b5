#include "bench_crown.h"

namespace meniscus::apps {
namespace {

Ground crown_ground() {
  Ground ground;
  ground.square = 0.25f;
  ground.albedo = vec3(0.20f, 0.22f, 0.24f);
  ground.second_albedo = vec3(0.09f, 0.11f, 0.13f);
  ground.fade_radius = 24;
  return ground;
}

}  // namespace

CrownLook::CrownLook()
    : material_(material_preset("water", 0.4f)), scene_(Environment(EnvironmentOptions{}), crown_ground()) {}

Image<vec3> CrownLook::shaded(const View& view, const SurfaceBuffers& water, StageTimes* times) const {
  OpticsInputs optics;
  optics.options.refraction = RefractionMethod::thickness;
  return shade(view, {}, water, scene_, material_, optics, times);
}

RaycastOptions crown_options(const Particles& crown) {
  RaycastOptions options;
  options.spacing = *crown.spacing;
  return options;
}

}  // namespace meniscus::apps
