#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <iostream>
#include <memory>

#include "bench_options.h"
#include "bench_timing.h"
#include "commands.h"
#include "json.h"
#include "meniscus/render.h"
#include "parse.h"

namespace meniscus::apps {
namespace {

struct PointSampledArguments {
  std::size_t particles = 150'000;
  PictureSize size{512, 512};
  PictureSize screen{256, 64};
  double grid_step = 0.5;
  int repeat = 5;
  int threads = 0;
  bool json = false;
};

/// The pool's floor and walls, with tiles.
Scene scene_around(const Bounds& water, float spacing) {
  Ground ground;
  ground.height = water.low.y - 0.5f * spacing;
  ground.square = 0.25f;
  Scene scene(Environment{EnvironmentOptions{}}, ground);
  Tank tank;
  tank.style = TankStyle::tiled;
  tank.inside = water.grown(0.5f * spacing);
  tank.inside.high.y += 0.5f * water.extent().y;
  scene.set_tank(tank);
  return scene;
}

Json measure(const PointSampledArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  WavesOptions waves;
  waves.particles = arguments.particles;
  const Particles particles = synthetic_waves(waves, 1.0);
  SurfelOptions options;
  options.spacing = *particles.spacing;
  options.grid_step = static_cast<float>(arguments.grid_step) * options.spacing;

  std::vector<Surfel> surfels;
  std::vector<double> construction;
  for (int i = 0; i <= arguments.repeat; ++i) {  // the first one warms up
    const auto start = Clock::now();
    surfels = extract_surfels(particles, options);
    if (i > 0) construction.push_back(ms_since(start));
  }
  const std::size_t count = surfels.size();
  const auto surface = make_surfel_surface(std::move(surfels), options.spacing);

  const Bounds box = particles.bounds();
  Scene scene = scene_around(box, options.spacing);
  CameraOptions camera;
  camera.elevation_deg = 40.0f;
  const View view = fitted_view(box, Axis::y, camera, 0, arguments.size.width, arguments.size.height);
  const Material material = material_preset("water", 4.0f);
  CausticsOptions light;
  light.screen_width = arguments.screen.width;
  light.screen_height = arguments.screen.height;
  light.screen = ScreenDirection::up;
  light.single_interface = true;

  // The frame whose time is the median.
  std::vector<std::pair<double, StageTimes>> frames;
  for (int i = 0; i <= arguments.repeat; ++i) {
    StageTimes times;
    const auto start = Clock::now();
    SurfaceBuffers seen;
    {
      const StageTimer timer(&times, "surface");
      seen = surface->see(view);
      seen.thickness = Image<float>(view.width, view.height);  // not known of points alone
    }
    scene.set_water_light(caustics(*surface, scene, material, light, &times));
    SceneBuffers behind;
    {
      const StageTimer timer(&times, "scene");
      behind = scene.see(view);
    }
    OpticsInputs optics{{}, &behind, nullptr};
    optics.options.refraction = RefractionMethod::image_space;
    const Image<vec3> radiance = shade(view, {}, seen, scene, material, optics, &times);
    if (i > 0) frames.emplace_back(ms_since(start), std::move(times));
  }
  const auto middle = frames.begin() + static_cast<std::ptrdiff_t>(frames.size() / 2);
  std::nth_element(frames.begin(), middle, frames.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });

  const double frame_ms = middle->first, construction_ms = median(construction);
  Json json;
  json["particles"] = particles.size();
  json["surfels"] = count;
  json["width"] = view.width;
  json["height"] = view.height;
  json["screen"] = {arguments.screen.width, arguments.screen.height};
  json["threads"] = thread_count();
  Json stages;
  for (const auto& [stage, ms] : middle->second.rows()) stages[stage] = ms;
  json["stages_ms"] = stages;
  json["frame_ms"] = frame_ms;
  json["construction_ms"] = construction_ms;
  json["frames_per_second"] = 1000 / frame_ms;
  json["frames_per_second_with_construction"] = 1000 / (frame_ms + construction_ms);
  return json;
}

void print(const Json& json) {
  for (const auto& [name, value] : json.items()) std::cout << fmt::format("  {:<36}{}\n", name, value.dump());
}

}  // namespace

void add_bench_point_sampled(CLI::App& bench) {
  CLI::App* command =
      bench.add_subcommand("point_sampled", "Frames of a pool with waves, sampled by points, with caustics");
  const auto arguments = std::make_shared<PointSampledArguments>();
  add_particles(*command, arguments->particles, 1000, 100'000'000, "Particles in the pool, about (default: 150000)");
  add_size(*command, "--size", arguments->size, "Size of the picture, px (default: 512x512)");
  add_size(*command, "--screen", arguments->screen, "Size of the virtual screen, px (default: 256x64)");
  command->add_option("--grid-step", arguments->grid_step, "Between points of the grid, spacings (default: 0.5)")
      ->type_name("STEP")
      ->check(CLI::Range(0.1, 4.0).description(""));
  add_repeat(*command, arguments->repeat, "Frames that the median is taken of (default: 5)");
  add_threads(*command, arguments->threads);
  add_json(*command, arguments->json);
  command->footer(
      "A frame is the splatted surface, caustics with a single interface from a level screen, the picture of the "
      "scene\n"
      "and reflection and refraction in image space. Construction is the density and the surfels.");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
