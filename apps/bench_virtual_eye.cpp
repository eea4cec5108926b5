#include "bench_virtual_eye.h"

#include <string>

#include "bench_timing.h"
#include "meniscus/image.h"
#include "meniscus/render.h"

namespace meniscus::apps {
namespace {

/// A tiled pool with a column that leans and a block in it.
Scene pool() {
  Ground ground;
  ground.centre = vec3{1, 0, 1};
  Scene scene(Environment{EnvironmentOptions{}}, ground);
  Tank tank;
  tank.style = TankStyle::tiled;
  tank.inside = {{0, 0, 0}, {2, 0.8f, 2}};
  scene.set_tank(tank);
  const auto placed = [](Mesh mesh, vec3 colour) {
    PlacedSolid solid{make_solid(std::move(mesh)), glm::mat4{1.0f}, SolidMaterial{}};
    solid.material->albedo = colour;
    return solid;
  };
  scene.set_solids({placed(cylinder_mesh({0.75f, 0, 0.9f}, {0.95f, 1.0f, 0.95f}, 0.09f), {0.8f, 0.3f, 0.15f}),
                    placed(box_mesh({1.25f, 0, 0.8f}, {1.45f, 0.7f, 1.0f}), {0.85f, 0.75f, 0.3f})});
  return scene;
}

HeightField water(bool curved) {
  WaveFieldOptions options;
  options.region = {{0, 0, 0}, {2, 0.5f, 2}};
  options.step = 2.0f / 256;
  if (curved) {
    const auto wave = [](float amplitude, float wavelength, float direction, float phase) {
      WaveTrain train;
      train.amplitude = amplitude;
      train.wavelength = wavelength;
      train.direction_deg = direction;
      train.phase_deg = phase;
      return train;
    };
    options.waves = {wave(0.02f, 0.9f, 20, 0), wave(0.012f, 0.55f, 75, 80), wave(0.006f, 0.31f, -40, 200)};
  }
  return height_field(options, 0);
}

Json one_case(const char* name, bool curved, PictureSize size, int bounces, int frames) {
  Scene scene = pool();
  CameraOptions camera;
  camera.elevation_deg = 28.0f;
  camera.azimuth_deg = 15.0f;
  const View view = fitted_view(scene.solid_bounds(), Axis::y, camera, 0, size.width, size.height);
  const Material material = material_preset("water", 2.0f);
  const HeightField field = water(curved);
  const auto plain = make_height_field_surface(field);
  scene.set_water_light(caustics(*plain, scene, material));

  // The reference, and what single rays show: the same optics as virtual eyes, without their approximation.
  const SurfaceBuffers seen = plain->see(view);
  const auto traced = [&](int interfaces, double& ms) {
    OpticsInputs optics{{}, nullptr, plain.get(), nullptr};
    optics.options.refraction = RefractionMethod::ray_traced;
    optics.options.bounces = interfaces;
    Image<vec3> picture;
    std::vector<double> times;
    for (int i = 0; i < frames; ++i) {
      const auto start = Clock::now();
      picture = shade(view, {}, seen, scene, material, optics);
      times.push_back(ms_since(start));
    }
    ms = median(std::move(times));
    return developed(picture, ToneOptions{});
  };
  double traced_ms = 0, single_ms = 0;
  const Image<Rgb8> reference = traced(bounces, traced_ms);
  const Image<Rgb8> single = traced(1, single_ms);

  // Planes, bending, maps and shading: all that the method itself needs for a frame.
  const auto with_eyes = [&](const VirtualEyeOptions& options, double& ms) {
    OpticsInputs optics;
    optics.options.refraction = RefractionMethod::virtual_eye;
    optics.options.eyes = options;
    Image<vec3> picture;
    std::vector<double> times;
    for (int i = 0; i <= frames; ++i) {  // the first one warms up
      const auto start = Clock::now();
      HeightField bent = field;
      const std::vector<WaterObject> objects = water_objects(bent, scene, options);
      adapt(bent, adaptations(objects, options));
      const double planes_ms = ms_since(start);
      const auto surface = make_height_field_surface(std::move(bent));
      const SurfaceBuffers seen_bent = surface->see(view);
      const auto rest = Clock::now();
      const auto eyes = make_virtual_eyes(view, *surface->height_field(), scene, objects, material, options);
      optics.surface = surface.get();
      optics.eyes = eyes.get();
      picture = shade(view, {}, seen_bent, scene, material, optics);
      if (i > 0) times.push_back(planes_ms + ms_since(rest));
    }
    ms = median(std::move(times));
    return developed(picture, ToneOptions{});
  };
  const auto add = [&](Json& json, const std::string& prefix, const VirtualEyeOptions& options) {
    double ms = 0;
    const auto against = compare(with_eyes(options, ms), reference);
    json[prefix + "_ms"] = ms;
    json[prefix + "_psnr_db"] = against.psnr_db;
    json[prefix + "_ssim"] = against.ssim;
  };
  Json json;
  json["case"] = name;
  add(json, "virtual_eye", {});
  VirtualEyeOptions published;
  published.object_position = published.static_position = false;
  add(json, "published", published);
  published.per_point = true;
  add(json, "per_point", published);
  json["ray_traced_ms"] = traced_ms;
  json["ratio"] = traced_ms / json["virtual_eye_ms"].get<double>();
  const auto one = compare(single, reference);
  json["single_interface_ms"] = single_ms;
  json["single_interface_psnr_db"] = one.psnr_db;
  json["single_interface_ssim"] = one.ssim;
  return json;
}

}  // namespace

Json virtual_eye_cases(PictureSize size, int bounces, int frames) {
  return Json::array(
      {one_case("planar", false, size, bounces, frames), one_case("curved", true, size, bounces, frames)});
}

}  // namespace meniscus::apps
