#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>

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

}  // namespace

void add_bench_caustics(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("caustics", "Light cast through the water of a wavy tank");
  const auto arguments = std::make_shared<CausticsArguments>();
  command->add_option("--particles", arguments->particles, "Particles in the tank (default: 150000)")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{4'000'000'000}).description(""));
  command
      ->add_option_function<std::string>(
          "--screen", [arguments](const std::string& text) { arguments->screen = parse_size("--screen", text); },
          "Size of the virtual screen, px (default: 256x64)")
      ->type_name("WIDTHxHEIGHT");
  command->add_option("--repeat", arguments->repeat, "Runs that the median is taken of (default: 5)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000).description(""));
  command->add_option("--threads", arguments->threads, "Threads; 0: one a core (default: 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 1024).description(""));
  command->add_flag("--exact-hits", arguments->exact_hits, "Meet the floor by rays instead of the geometry map");
  command->add_flag("--single-interface", arguments->single_interface, "Light that has entered the water stays in it");
  command->add_flag("--reference", arguments->reference, "Compare the map with photons");
  command->add_flag("--json", arguments->json, "Print one JSON object");
  command->callback([arguments] {
    const Json json = measure(*arguments);
    if (arguments->json) {
      std::cout << text_of(json) << '\n';
      return;
    }
    for (const auto& [name, value] : json.items()) std::cout << fmt::format("  {:<14}{}\n", name, value.dump());
  });
}

}  // namespace meniscus::apps
