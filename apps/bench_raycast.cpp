#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>

#include "commands.h"
#include "json.h"
#include "meniscus/render.h"
#include "parse.h"

namespace meniscus::apps {
namespace {

struct RaycastArguments {
  std::size_t particles = 1'000'000;
  PictureSize size{1024, 1024};
  std::uint64_t seed = 1;
  int frames = 5;
  int threads = 0;
  std::string instruction_set = "best";
  bool iso_sweep = false;
  bool json = false;
};

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Measured {
  double frame_ms = 0;
  StageTimes stages;
};

/// One frame: the surface built and seen.
Measured fast_frame(const Particles& particles, const RaycastOptions& options, const View& view, SurfaceBuffers* seen) {
  Measured measured;
  const auto start = Clock::now();
  const auto surface = make_raycast_surface(particles, options, {}, &measured.stages);
  SurfaceBuffers buffers = surface->see(view, {}, &measured.stages);
  measured.frame_ms = ms_since(start);
  if (seen) *seen = std::move(buffers);
  return measured;
}

/// The median frame after one that warms up.
Measured median_frame(const Particles& particles, const RaycastOptions& options, const View& view, int frames) {
  fast_frame(particles, options, view, nullptr);
  std::vector<Measured> all;
  for (int i = 0; i < frames; ++i) all.push_back(fast_frame(particles, options, view, nullptr));
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end(),
                   [](const auto& a, const auto& b) { return a.frame_ms < b.frame_ms; });
  return *middle;
}

struct PlainTime {
  double frame_ms = 0;
  PictureSize measured;
  double measured_ms = 0;
};

View reduced(const View& view, int divisor) {
  return view.resized(std::max(1, view.width / divisor), std::max(1, view.height / divisor));
}

/// The plain method's time for the whole picture. Where that takes long, it is measured at a quarter of the width
/// and height and at an eighth, and the straight line through both is followed: what does not depend on the pixels
/// (sorting) is not scaled with them.
PlainTime plain_time(const Particles& particles, const RaycastOptions& options, const View& view) {
  const ThreadLimit one_thread(1);
  const auto build_start = Clock::now();
  const auto surface = make_plain_raycast_surface(particles, options);
  const double build_ms = ms_since(build_start);
  const auto see_ms = [&](const View& at) {
    const auto start = Clock::now();
    static_cast<void>(surface->see(at));
    return ms_since(start);
  };
  const View small = reduced(view, 8), larger = reduced(view, 4);
  const double small_ms = see_ms(small), larger_ms = see_ms(larger);
  const auto pixels = [](const View& at) { return static_cast<double>(at.width) * at.height; };
  const double per_pixel =
      pixels(larger) > pixels(small) ? std::max(0.0, (larger_ms - small_ms) / (pixels(larger) - pixels(small))) : 0.0;
  const double expected_ms = larger_ms + per_pixel * (pixels(view) - pixels(larger));
  if (expected_ms < 3000) {
    const double whole_ms = build_ms + see_ms(view);
    return {whole_ms, {view.width, view.height}, whole_ms};
  }
  return {build_ms + expected_ms, {larger.width, larger.height}, build_ms + larger_ms};
}

struct Agreement {
  double hit_mismatch = 0;  ///< fraction of the pixels compared
  double depth_error_p99_spacings = 0;
  std::size_t pixels = 0;
};

/// The fast picture against the plain one at every n-th pixel across and down, 65,536 pixels or fewer.
Agreement agreement(const Particles& particles, const RaycastOptions& options, const View& view,
                    const SurfaceBuffers& fast) {
  int every = 1;
  while ((view.width / every) * (view.height / every) > 65536) ++every;
  std::vector<vec2> points;
  std::vector<float> fast_depth;
  for (int y = every / 2; y < view.height; y += every)
    for (int x = every / 2; x < view.width; x += every) {
      points.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      fast_depth.push_back(fast.depth(x, y));
    }
  RaycastOptions depth_only = options;
  depth_only.want_normals = depth_only.want_thickness = false;
  const SurfaceBuffers plain = make_plain_raycast_surface(particles, depth_only)->see(view, points);
  std::vector<double> errors;
  std::size_t mismatches = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool fast_hit = std::isfinite(fast_depth[i]), plain_hit = std::isfinite(plain.depth[i]);
    if (fast_hit != plain_hit) ++mismatches;
    if (fast_hit && plain_hit) errors.push_back(std::abs(fast_depth[i] - plain.depth[i]) / options.spacing);
  }
  Agreement result;
  result.pixels = points.size();
  result.hit_mismatch = static_cast<double>(mismatches) / static_cast<double>(std::max<std::size_t>(points.size(), 1));
  if (!errors.empty()) {
    const auto p99 = errors.begin() + static_cast<std::ptrdiff_t>((errors.size() - 1) * 99 / 100);
    std::nth_element(errors.begin(), p99, errors.end());
    result.depth_error_p99_spacings = *p99;
  }
  return result;
}

Json iso_sweep(const Particles& particles, const RaycastOptions& options, const View& view, int frames) {
  Json sweep = Json::array();
  for (const float iso : {0.3f, 0.4f, 0.5f, 0.6f, 0.7f}) {
    RaycastOptions swept = options;
    swept.iso = iso;
    const double ms = median_frame(particles, swept, view, frames).frame_ms;
    sweep.push_back({{"iso", json_of(iso)}, {"frame_ms", ms}});
  }
  return sweep;
}

Json measure(const RaycastArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  use_instruction_set(arguments.instruction_set);
  const Particles particles = synthetic_tank(arguments.particles, arguments.seed);
  RaycastOptions options;
  options.spacing = *particles.spacing;
  const View view = fitted_view(particles.bounds().grown(options.spacing), Axis::y, {}, 0, arguments.size.width,
                                arguments.size.height);
  const Measured fast = median_frame(particles, options, view, arguments.frames);
  const std::uint64_t peak = peak_rss_bytes();  // the plain method's memory is not of interest
  SurfaceBuffers seen;
  fast_frame(particles, options, view, &seen);
  const auto covered = std::count_if(seen.depth.begin(), seen.depth.end(), [](float d) { return std::isfinite(d); });
  Json json;
  json["particles"] = particles.size();
  json["width"] = view.width;
  json["height"] = view.height;
  json["seed"] = arguments.seed;
  json["threads"] = thread_count();
  json["instruction_set"] =
      arguments.instruction_set == "best" ? instruction_sets().front() : arguments.instruction_set;
  json["covered_pixels"] = covered;
  json["stages_ms"] = json_of(fast.stages);
  json["frame_ms"] = fast.frame_ms;
  json["peak_rss_bytes"] = peak;
  if (arguments.iso_sweep) json["iso_sweep"] = iso_sweep(particles, options, view, arguments.frames);
  const PlainTime plain = plain_time(particles, options, view);
  json["plain_frame_ms"] = plain.frame_ms;
  json["plain_measured_size"] = {plain.measured.width, plain.measured.height};
  json["plain_measured_ms"] = plain.measured_ms;
  json["ratio"] = plain.frame_ms / fast.frame_ms;
  const Agreement agreed = agreement(particles, options, view, seen);
  json["compared_pixels"] = agreed.pixels;
  json["hit_mismatch"] = agreed.hit_mismatch;
  json["depth_error_p99_spacings"] = agreed.depth_error_p99_spacings;
  return json;
}

void print(const Json& json) {
  std::cout << fmt::format("{} particles, {}x{} pixels, {} threads\n", json["particles"].get<std::size_t>(),
                           json["width"].get<int>(), json["height"].get<int>(), json["threads"].get<int>());
  for (const auto& [stage, ms] : json["stages_ms"].items())
    std::cout << fmt::format("  {:<14}{:>10.1f} ms\n", stage, ms.get<double>());
  std::cout << fmt::format("  {:<14}{:>10.1f} ms\n", "frame", json["frame_ms"].get<double>());
  std::cout << fmt::format("  {:<14}{:>10.1f} ms on one thread, measured at {}x{}: {:.1f} times\n", "plain method",
                           json["plain_frame_ms"].get<double>(), json["plain_measured_size"][0].get<int>(),
                           json["plain_measured_size"][1].get<int>(), json["ratio"].get<double>());
  std::cout << fmt::format("  differs in {:.4f} % of the pixels; depth within {:.5f} spacings in 99 % of them\n",
                           100 * json["hit_mismatch"].get<double>(), json["depth_error_p99_spacings"].get<double>());
  std::cout << fmt::format("  peak memory   {:>10.1f} MB\n", json["peak_rss_bytes"].get<double>() / 1e6);
  if (json.contains("iso_sweep"))
    for (const auto& entry : json["iso_sweep"])
      std::cout << fmt::format("  iso {:<10}{:>10.1f} ms\n", entry["iso"].get<double>(),
                               entry["frame_ms"].get<double>());
}

}  // namespace

void add_bench_raycast(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("raycast", "The ray-cast surface of a wavy tank with drops");
  const auto arguments = std::make_shared<RaycastArguments>();
  command->add_option("--particles", arguments->particles, "Particles in the tank (default: 1000000)")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{4'000'000'000}));
  command
      ->add_option_function<std::string>(
          "--size", [arguments](const std::string& text) { arguments->size = parse_size("--size", text); },
          "Size of the picture, px (default: 1024x1024)")
      ->type_name("WIDTHxHEIGHT");
  command->add_option("--seed", arguments->seed, "Of the particles' places (default: 1)")->type_name("N");
  command->add_option("--repeat", arguments->frames, "Frames that the median is taken of (default: 5)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000));
  command->add_option("--threads", arguments->threads, "Threads; 0: one a core (default: 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 1024));
  command
      ->add_option("--instruction-set", arguments->instruction_set,
                   "Vector instructions to use, such as avx3, avx2, sse4 or best (default: best)")
      ->type_name("NAME");
  command->add_flag("--iso-sweep", arguments->iso_sweep, "Measure for iso-values from 0.3 to 0.7 as well");
  command->add_flag("--json", arguments->json, "Print one JSON object");
  command->footer(
      "A frame is the building of the surface from the particles and one look at it: depth, normals, thickness.\n"
      "The plain method computes the same surface ray by ray with one thread. Where a whole picture of it takes\n"
      "more than three seconds it is measured at a quarter of the width and height (plain_measured_size) and at an\n"
      "eighth, and the time for all pixels follows from both.");
  command->callback([arguments] {
    const Json json = measure(*arguments);
    if (arguments->json)
      std::cout << text_of(json) << '\n';
    else
      print(json);
  });
}

}  // namespace meniscus::apps
