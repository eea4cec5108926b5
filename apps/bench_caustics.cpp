#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "bench_options.h"
#include "commands.h"
#include "json.h"
#include "meniscus/render.h"
#include "parse.h"

namespace meniscus::apps {
namespace {

struct CausticsArguments {
  std::size_t particles = 150'000;
  PictureSize screen{256, 64};
  int repeat = 5;
  int threads = 0;
  bool exact_hits = false;
  bool single_interface = false;
  bool reference = false;
  bool json = false;
};

Json measure(const CausticsArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  const Particles particles = synthetic_tank(arguments.particles);
  RaycastOptions water;
  water.spacing = *particles.spacing;
  const auto surface = make_raycast_surface(particles, water);
  Ground ground;
  ground.height = particles.bounds().low.y - 0.5f * water.spacing;
  const Scene scene(Environment(EnvironmentOptions{}), ground);
  const Material material = material_preset("water", 4.0f);
  CausticsOptions options;
  options.screen_width = arguments.screen.width;
  options.screen_height = arguments.screen.height;
  options.exact_hits = arguments.exact_hits;
  options.single_interface = arguments.single_interface;

  // The run whose total is the median, after one that warms up.
  std::vector<StageTimes> runs;
  CausticsReport report;
  for (int i = 0; i <= arguments.repeat; ++i) {
    StageTimes times;
    report = measure_caustics(*surface, scene, material, options, &times);
    if (i > 0) runs.push_back(times);
  }
  const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(runs.size() / 2);
  std::nth_element(runs.begin(), middle, runs.end(),
                   [](const auto& a, const auto& b) { return a.total_ms() < b.total_ms(); });
  const auto row = [&](std::string_view name) {
    for (const auto& [stage, ms] : middle->rows())
      if (stage == name) return ms;
    return 0.0;
  };
  Json json;
  json["particles"] = particles.size();
  json["screen"] = {arguments.screen.width, arguments.screen.height};
  json["threads"] = thread_count();
  json["surface_ms"] = row("caustics surface");
  json["intersect_ms"] = row("caustics intersect");
  json["draw_ms"] = row("caustics draw");
  json["total_ms"] = middle->total_ms();
  json["triangles"] = report.triangles;
  json["entered_w"] = report.entered;
  json["absorbed_w"] = report.absorbed;
  json["mirrored_w"] = report.mirrored;
  json["landed_w"] = report.landed;
  if (arguments.reference) {
    const CausticsReport compared = measure_caustics(*surface, scene, material, options, nullptr, 8);
    json["psnr_db"] = compared.psnr_db;
    json["reference_ms"] = compared.reference_ms;
  }
  return json;
}

void print(const Json& json) {
  for (const auto& [name, value] : json.items()) std::cout << fmt::format("  {:<14}{}\n", name, value.dump());
}

}  // namespace

void add_bench_caustics(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("caustics", "Light cast through the water of a wavy tank");
  const auto arguments = std::make_shared<CausticsArguments>();
  add_particles(*command, arguments->particles, 1, 4'000'000'000, "Particles in the tank (default: 150000)");
  add_size(*command, "--screen", arguments->screen, "Size of the virtual screen, px (default: 256x64)");
  add_repeat(*command, arguments->repeat, "Runs that the median is taken of (default: 5)");
  add_threads(*command, arguments->threads);
  command->add_flag("--exact-hits", arguments->exact_hits, "Meet the floor by rays instead of the geometry map");
  command->add_flag("--single-interface", arguments->single_interface, "Light that has entered the water stays in it");
  command->add_flag("--reference", arguments->reference, "Compare the map with photons");
  add_json(*command, arguments->json);
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
