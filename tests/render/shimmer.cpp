// Water that moves slowly where a pixel is as wide as several particles: pictures change little more than the truth
// does.
#include <gtest/gtest.h>

#include <cmath>

#include "meniscus/image.h"
#include "meniscus/render.h"
#include "render/antialias.h"

namespace meniscus {
namespace {

constexpr int kFrames = 4, kTruth = 6;  ///< rays along the edge of a pixel

/// The crown after some steps of a flow that compresses nothing.
Particles flowed(Particles crown, float far) {
  for (std::size_t i = 0; i < crown.size(); ++i) {
    const vec3 p = crown.position(i);
    crown.x[i] += far * (std::sin(7.9f * p.z) + std::cos(7.9f * p.y));
    crown.y[i] += far * (std::sin(7.9f * p.x) + std::cos(7.9f * p.z));
    crown.z[i] += far * (std::sin(7.9f * p.y) + std::cos(7.9f * p.x));
  }
  return crown;
}

/// What a screen would show.
Image<vec3> displayed(Image<vec3> radiance) {
  for (vec3& v : radiance) {
    v = tone_mapped(v, {});
    v = {srgb_from_linear(v.x), srgb_from_linear(v.y), srgb_from_linear(v.z)};
  }
  return radiance;
}

double change(const Image<vec3>& a, const Image<vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(glm::dot(a[i] - b[i], a[i] - b[i]));
  return sum;
}

TEST(RefinePixels, LeavesWaterOfWidePixelsAsStillAsManyRaysDo) {
  const Particles crown = synthetic_crown(60000);
  RaycastOptions options;
  options.spacing = *crown.spacing;
  Ground ground;
  ground.albedo = vec3(0.2f);
  ground.second_albedo = vec3(0.1f);
  const Scene scene(Environment(EnvironmentOptions{}), ground);
  const Material material = material_preset("water", 0.4f);
  OpticsInputs optics;
  optics.options.refraction = RefractionMethod::thickness;
  // A pixel is two spacings wide at the crown.
  View view = crown_view(1024, 1024);
  const int size = static_cast<int>(512 * view.pixel_size(view.project({0, 0.38f, 0}).z) / options.spacing);
  view = view.resized(size, size);
  const auto drawn = [&](const Surface& surface, const View& with, SurfaceBuffers& seen) {
    seen = surface.see(with);
    return shade(with, {}, seen, scene, material, optics);
  };
  Image<vec3> before[3];
  double changes[3] = {0, 0, 0};
  for (int frame = 0; frame < kFrames; ++frame) {
    const auto surface = make_raycast_surface(flowed(crown, 0.0007f * static_cast<float>(frame)), options);
    SurfaceBuffers seen, fine;
    const Image<vec3> truth = downsampled(drawn(*surface, view.resized(kTruth * size, kTruth * size), fine), kTruth);
    const Image<vec3> plain = drawn(*surface, view, seen);
    Image<vec3> refined = plain;
    const std::vector<std::uint32_t> pixels =
        with_wide_pixels(silhouette_pixels(view, seen, scene, options.spacing), *surface, view, seen);
    const Image<vec3> normals = seen.normal;
    refine_pixels(*surface, view, scene, material, optics, pixels, seen, refined);
    EXPECT_TRUE(std::equal(normals.begin(), normals.end(), seen.normal.begin(), seen.normal.end()));
    const Image<vec3> now[3] = {displayed(truth), displayed(plain), displayed(refined)};
    for (int k = 0; k < 3; ++k) {
      if (frame > 0) changes[k] += change(now[k], before[k]);
      before[k] = now[k];
    }
  }
  RecordProperty("plain", std::to_string(std::sqrt(changes[1] / changes[0])));
  RecordProperty("refined", std::to_string(std::sqrt(changes[2] / changes[0])));
  EXPECT_GT(std::sqrt(changes[1] / changes[0]), 2) << "one ray a pixel shimmers";
  EXPECT_LT(std::sqrt(changes[2] / changes[0]), 1.8);
}

}  // namespace
}  // namespace meniscus
