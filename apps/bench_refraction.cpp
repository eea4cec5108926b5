#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <memory>

#include "bench_options.h"
#include "bench_timing.h"
#include "bench_virtual_eye.h"
#include "commands.h"
#include "json.h"
#include "meniscus/image.h"
#include "meniscus/render.h"
#include "parse.h"
#include "shading/refraction.h"

namespace meniscus::apps {
namespace {

struct RefractionArguments {
  std::size_t particles = 100'000;
  PictureSize size{512, 512};
  std::uint64_t seed = 1;
  int frames = 3;
  int threads = 0;
  int bounces = 8;
  bool json = false;
};

/// The tank's water on a chequered floor with a ball, a block and a column in it.
Scene scene_around(const Particles& particles, float spacing) {
  const Bounds box = particles.bounds();
  const float floor = box.low.y - 0.5f * spacing;
  Ground ground;
  ground.height = floor;
  ground.square = 0.2f;
  ground.albedo = vec3{0.75f};
  ground.second_albedo = vec3{0.2f};
  Scene scene(Environment{EnvironmentOptions{}}, ground);
  const vec3 centre = box.centre();
  const auto placed = [](Mesh mesh, vec3 colour) {
    PlacedSolid solid{make_solid(std::move(mesh)), glm::mat4{1.0f}, SolidMaterial{}};
    solid.material->albedo = colour;
    return solid;
  };
  std::vector<PlacedSolid> solids;
  solids.push_back(placed(sphere_mesh({centre.x - 0.5f, floor + 0.25f, centre.z + 0.2f}, 0.25f), {0.8f, 0.25f, 0.15f}));
  solids.push_back(
      placed(box_mesh({centre.x + 0.2f, floor, centre.z - 0.1f}, {centre.x + 0.6f, floor + 0.3f, centre.z + 0.4f}),
             {0.85f, 0.7f, 0.2f}));
  solids.push_back(placed(
      cylinder_mesh({centre.x - 0.1f, floor, centre.z - 0.5f}, {centre.x - 0.1f, floor + 0.4f, centre.z - 0.5f}, 0.12f),
      {0.25f, 0.6f, 0.35f}));
  scene.set_solids(std::move(solids));
  return scene;
}

/// Where the refracted rays of the seen water meet the scene, in its picture against by ray.
struct HitErrors {
  std::size_t rays = 0;
  double misses = 0;  ///< fraction that the picture does not show
  double p90_px = 0;  ///< between both hits as seen in the picture, of the rest
};

HitErrors hit_errors(const View& view, const SurfaceBuffers& seen, const Scene& scene, const SceneBuffers& behind,
                     const OpticsOptions& options, const Material& material) {
  HitErrors result;
  std::size_t misses = 0;
  std::vector<double> errors;
  const GeometryMap map{view, &behind.depth};
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const vec2 pixel{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
      Sample sample;
      sample.ray = view.ray(pixel);
      sample.depth = seen.depth(x, y);
      if (!std::isfinite(sample.depth) || behind.depth(x, y) < sample.depth) continue;
      sample.normal = facing(seen.normal(x, y), sample.ray.direction);
      const Refraction refraction = refraction_of(sample, material);
      const Ray ray{refraction.point, refraction.direction};
      const float exact = scene.distance(ray);
      const ImageSpaceHit hit = image_space_hit(map, ray, pixel, options.threshold, options.iterations);
      ++result.rays;
      if (!hit.met || !hit.in_picture || !std::isfinite(exact)) {
        ++misses;
        continue;
      }
      const vec3 at = view.project(ray.origin + exact * ray.direction);
      errors.push_back(glm::length(vec2{at.x, at.y} - hit.picture));
    }
  result.misses = static_cast<double>(misses) / static_cast<double>(std::max<std::size_t>(result.rays, 1));
  if (!errors.empty()) {
    const auto p90 = errors.begin() + static_cast<std::ptrdiff_t>((errors.size() - 1) * 9 / 10);
    std::nth_element(errors.begin(), p90, errors.end());
    result.p90_px = *p90;
  }
  return result;
}

Json measure(const RefractionArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  const Particles particles = synthetic_tank(arguments.particles, arguments.seed);
  RaycastOptions options;
  options.spacing = *particles.spacing;
  const View view = fitted_view(particles.bounds().grown(options.spacing), Axis::y, {}, 0, arguments.size.width,
                                arguments.size.height);
  const auto surface = make_raycast_surface(particles, options);
  const SurfaceBuffers seen = surface->see(view);
  const Scene scene = scene_around(particles, options.spacing);
  const Material material = material_preset("water", 1.0f);
  const SceneBuffers behind = scene.see(view);
  // The median time of a picture, after one that warms up; in image space with the picture of the scene.
  const auto timed = [&](RefractionMethod method, int bounces, Image<vec3>& picture) {
    OpticsInputs optics{{}, &behind, surface.get()};
    optics.options.refraction = method;
    optics.options.bounces = bounces;
    std::vector<double> times;
    for (int i = 0; i <= arguments.frames; ++i) {
      const auto start = Clock::now();
      SceneBuffers again;
      if (method == RefractionMethod::image_space) {
        again = scene.see(view);
        optics.behind = &again;
      }
      picture = shade(view, {}, seen, scene, material, optics);
      if (i > 0) times.push_back(ms_since(start));
    }
    return median(std::move(times));
  };
  Image<vec3> thickness, image_space, traced, single;
  Json json;
  json["particles"] = particles.size();
  json["width"] = view.width;
  json["height"] = view.height;
  json["seed"] = arguments.seed;
  json["threads"] = thread_count();
  json["bounces"] = arguments.bounces;
  json["thickness_ms"] = timed(RefractionMethod::thickness, 1, thickness);
  json["image_space_ms"] = timed(RefractionMethod::image_space, 1, image_space);
  json["ray_traced_ms"] = timed(RefractionMethod::ray_traced, arguments.bounces, traced);
  json["single_interface_ms"] = timed(RefractionMethod::ray_traced, 1, single);
  json["psnr_db"] = compare(developed(image_space, ToneOptions{}), developed(single, ToneOptions{})).psnr_db;
  const HitErrors errors = hit_errors(view, seen, scene, behind, OpticsOptions{}, material);
  json["refracted_rays"] = errors.rays;
  json["hit_position_error_p90_px"] = errors.p90_px;
  json["misses"] = errors.misses;
  const Json cases = virtual_eye_cases(arguments.size, arguments.bounces, arguments.frames);
  json["virtual_eye_ms"] = std::max(cases[0]["virtual_eye_ms"].get<double>(), cases[1]["virtual_eye_ms"].get<double>());
  json["virtual_eye_psnr_db"] =
      std::min(cases[0]["virtual_eye_psnr_db"].get<double>(), cases[1]["virtual_eye_psnr_db"].get<double>());
  json["virtual_eye"] = cases;
  return json;
}

void print(const Json& json) {
  std::cout << fmt::format("{} particles, {}x{} pixels, {} threads\n", json["particles"].get<std::size_t>(),
                           json["width"].get<int>(), json["height"].get<int>(), json["threads"].get<int>());
  for (const char* key : {"thickness_ms", "image_space_ms", "single_interface_ms", "ray_traced_ms"})
    std::cout << fmt::format("  {:<22}{:>10.1f}\n", key, json[key].get<double>());
  std::cout << fmt::format(
      "  image space against rays with a single interface: {:.1f} dB; hits within {:.2f} px in 90 %; "
      "{:.1f} % not in the picture\n",
      json["psnr_db"].get<double>(), json["hit_position_error_p90_px"].get<double>(),
      100 * json["misses"].get<double>());
  for (const Json& c : json["virtual_eye"]) {
    std::cout << fmt::format("  an object through {} water, against {:.1f} ms ray-traced:\n",
                             c["case"].get<std::string>(), c["ray_traced_ms"].get<double>());
    for (const std::string way : {"virtual_eye", "published", "per_point", "single_interface"})
      std::cout << fmt::format("    {:<20}{:>10.1f} ms {:>7.1f} dB, ssim {:.3f}\n", way, c[way + "_ms"].get<double>(),
                               c[way + "_psnr_db"].get<double>(), c[way + "_ssim"].get<double>());
  }
}

}  // namespace

void add_bench_refraction(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("refraction", "What is seen through a wavy tank over solid bodies");
  const auto arguments = std::make_shared<RefractionArguments>();
  add_particles(*command, arguments->particles, 1, 4'000'000'000, "Particles in the tank (default: 100000)");
  add_size(*command, "--size", arguments->size, "Size of the picture, px (default: 512x512)");
  add_seed(*command, arguments->seed);
  add_repeat(*command, arguments->frames, "Pictures that the median is taken of (default: 3)");
  add_threads(*command, arguments->threads);
  command->add_option("--bounces", arguments->bounces, "Interfaces in one path at most (default: 8)")
      ->type_name("N")
      ->check(CLI::Range(1, 64).description(""));
  add_json(*command, arguments->json);
  command->footer(
      "Times are those of shading alone, in image space with the picture of the scene that it looks into. psnr_db\n"
      "compares image space with rays that know a single interface; hit_position_error_p90_px is the distance in the\n"
      "picture between where the iteration and where a ray meet the scene; misses is the fraction of the refracted\n"
      "rays whose hit the picture does not show. virtual_eye has an object through planar and through curved water,\n"
      "drawn from virtual eyes and compared with the ray-traced picture; virtual_eye_ms and virtual_eye_psnr_db are\n"
      "those of the worse of both.");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
