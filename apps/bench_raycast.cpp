#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "bench_options.h"
#include "bench_timing.h"
#include "commands.h"
#include "json.h"
#include "meniscus/render.h"
#include "merged_particles.h"
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
  int size_range = 0;
  bool json = false;
};

struct Measured {
  double frame_ms = 0;
  StageTimes stages;
};

/// One frame: the surface built and seen.
Measured fast_frame(const Particles& particles, const RaycastOptions& options, const View& view, SurfaceBuffers* seen,
                    const ParticleSizes& sizes = {}) {
  Measured measured;
  const auto start = Clock::now();
  const auto surface = make_raycast_surface(particles, options, {}, &measured.stages, sizes);
  SurfaceBuffers buffers = surface->see(view, {}, &measured.stages);
  measured.frame_ms = ms_since(start);
  if (seen) *seen = std::move(buffers);
  return measured;
}

/// The median frame after one that warms up.
Measured median_frame(const Particles& particles, const RaycastOptions& options, const View& view, int frames,
                      const ParticleSizes& sizes = {}) {
  fast_frame(particles, options, view, nullptr, sizes);
  std::vector<Measured> all;
  for (int i = 0; i < frames; ++i) all.push_back(fast_frame(particles, options, view, nullptr, sizes));
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end(),
                   [](const auto& a, const auto& b) { return a.frame_ms < b.frame_ms; });
  return *middle;
}

/// Every n-th pixel of a view across and down, n odd: its rays are exactly those of the pixels in the middle of the
/// squares of n x n, of as many whole squares as fit around the picture's centre.
struct Subgrid {
  View view;
  int every = 1;
  int left = 0, top = 0;  ///< px of the whole picture that its first pixel stands for
};

Subgrid subgrid_of(const View& whole, int every) {
  // An even number of squares fits an even number of pixels around the centre, an odd one an odd number.
  const auto squares = [&](int pixels) { return pixels / every - ((pixels / every) ^ pixels) % 2; };
  const int width = squares(whole.width), height = squares(whole.height);
  Subgrid grid{whole.resized(width, height), every, (whole.width - every * (width - 1)) / 2,
               (whole.height - every * (height - 1)) / 2};
  grid.view.half_height *= static_cast<float>(every * height) / static_cast<float>(whole.height);
  return grid;
}

/// The plain method's picture, of every n-th pixel if the whole takes long, and its time for the whole.
struct PlainFrame {
  SurfaceBuffers seen;
  Subgrid grid;
  double measured_ms = 0;  ///< of the pixels in `grid`, the building included
  double frame_ms = 0;     ///< of all
};

/// Where the whole picture takes long it is measured at every fifth pixel across and down and at every eleventh, and
/// the straight line through both is followed: what does not depend on the pixels (sorting) is not scaled with them.
PlainFrame plain_frame(const Particles& particles, const RaycastOptions& options, const View& view) {
  constexpr double kLongMs = 3000;
  const ThreadLimit one_thread(1);
  const auto build_start = Clock::now();
  const auto surface = make_plain_raycast_surface(particles, options);
  const double build_ms = ms_since(build_start);
  PlainFrame frame;
  const auto see = [&](int every) {
    frame.grid = subgrid_of(view, every);
    const auto start = Clock::now();
    frame.seen = surface->see(frame.grid.view);
    const double ms = ms_since(start);
    frame.measured_ms = build_ms + ms;
    return ms;
  };
  const auto pixels = [](const View& at) { return static_cast<double>(at.width) * at.height; };
  if (std::min(view.width, view.height) >= 64) {
    const double few_ms = see(11);
    const double few = pixels(frame.grid.view);
    const double more_ms = see(5);
    const double more = pixels(frame.grid.view);
    const double expected_ms = more_ms + std::max(0.0, (more_ms - few_ms) / (more - few)) * (pixels(view) - more);
    frame.frame_ms = build_ms + expected_ms;
    if (frame.frame_ms > kLongMs) return frame;
  }
  frame.frame_ms = build_ms + see(1);
  return frame;
}

struct Agreement {
  std::size_t pixels = 0;   ///< compared
  double hit_mismatch = 0;  ///< fraction of them
  double depth_error_p99_spacings = 0;
};

/// The fast picture against the plain one, at the pixels that the plain one has.
Agreement agreement(const SurfaceBuffers& fast, const PlainFrame& plain, float spacing) {
  std::vector<double> errors;
  std::size_t mismatches = 0;
  const Image<float>& depth = plain.seen.depth;
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) {
      const float a = fast.depth(plain.grid.left + x * plain.grid.every, plain.grid.top + y * plain.grid.every);
      const float b = depth(x, y);
      if (std::isfinite(a) != std::isfinite(b)) ++mismatches;
      if (std::isfinite(a) && std::isfinite(b)) errors.push_back(std::abs(a - b) / spacing);
    }
  Agreement result;
  result.pixels = depth.size();
  result.hit_mismatch = static_cast<double>(mismatches) / static_cast<double>(std::max<std::size_t>(depth.size(), 1));
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

std::ptrdiff_t covered_pixels(const SurfaceBuffers& seen) {
  return std::count_if(seen.depth.begin(), seen.depth.end(), [](float d) { return std::isfinite(d); });
}

/// The same water with every other slab of it in particles of up to `range` times the size, by the side of the uniform
/// ones: frame by frame in turn, so that both meet the same machine.
Json of_different_sizes(const Particles& particles, const RaycastOptions& options, const View& view, int frames,
                        int range) {
  const MergedParticles merged = merged_particles(particles, options.spacing, range);
  const ParticleSizes sizes{merged.spacing, {}};
  SurfaceBuffers seen;
  fast_frame(merged.particles, options, view, &seen, sizes);
  std::vector<double> alike_ms, different_ms;
  for (int i = 0; i < frames; ++i) {
    alike_ms.push_back(fast_frame(particles, options, view, nullptr).frame_ms);
    different_ms.push_back(fast_frame(merged.particles, options, view, nullptr, sizes).frame_ms);
  }
  const Measured one = median_frame(merged.particles, options, view, frames, sizes);
  Json json;
  json["size_range"] = range;
  json["sizes_particles"] = merged.particles.size();
  json["sizes_covered_pixels"] = covered_pixels(seen);
  json["sizes_stages_ms"] = json_of(one.stages);
  json["sizes_frame_ms"] = median(different_ms);
  json["sizes_ratio"] = median(different_ms) / median(alike_ms);
  return json;
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
  Json json;
  json["particles"] = particles.size();
  json["width"] = view.width;
  json["height"] = view.height;
  json["seed"] = arguments.seed;
  json["threads"] = thread_count();
  json["instruction_set"] =
      arguments.instruction_set == "best" ? instruction_sets().front() : arguments.instruction_set;
  json["covered_pixels"] = covered_pixels(seen);
  json["stages_ms"] = json_of(fast.stages);
  json["frame_ms"] = fast.frame_ms;
  json["peak_rss_bytes"] = peak;
  if (arguments.iso_sweep) json["iso_sweep"] = iso_sweep(particles, options, view, arguments.frames);
  if (arguments.size_range > 0)
    json.update(of_different_sizes(particles, options, view, arguments.frames, arguments.size_range));
  const PlainFrame plain = plain_frame(particles, options, view);
  json["plain_frame_ms"] = plain.frame_ms;
  json["plain_measured_size"] = {plain.grid.view.width, plain.grid.view.height};
  json["plain_measured_ms"] = plain.measured_ms;
  json["ratio"] = plain.frame_ms / fast.frame_ms;
  const Agreement agreed = agreement(seen, plain, options.spacing);
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
  if (json.contains("sizes_ratio"))
    std::cout << fmt::format("  {:<14}{:>10.1f} ms, {:.2f} times that of equal ones\n",
                             "sizes of 1 to " + json["size_range"].dump(), json["sizes_frame_ms"].get<double>(),
                             json["sizes_ratio"].get<double>());
  if (json.contains("iso_sweep"))
    for (const auto& entry : json["iso_sweep"])
      std::cout << fmt::format("  iso {:<10}{:>10.1f} ms\n", entry["iso"].get<double>(),
                               entry["frame_ms"].get<double>());
}

}  // namespace

void add_bench_raycast(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("raycast", "The ray-cast surface of a wavy tank with drops");
  const auto arguments = std::make_shared<RaycastArguments>();
  add_particles(*command, arguments->particles, 1, 4'000'000'000, "Particles in the tank (default: 1000000)");
  add_size(*command, "--size", arguments->size, "Size of the picture, px (default: 1024x1024)");
  add_seed(*command, arguments->seed);
  add_repeat(*command, arguments->frames, "Frames that the median is taken of (default: 5)");
  add_threads(*command, arguments->threads);
  command
      ->add_option("--instruction-set", arguments->instruction_set,
                   "Vector instructions to use, such as avx3, avx2, sse4 or best (default: best)")
      ->type_name("NAME");
  command->add_flag("--iso-sweep", arguments->iso_sweep, "Measure for iso-values from 0.3 to 0.7 as well");
  command
      ->add_option("--size-range", arguments->size_range,
                   "Measure water as well whose every other slab is of particles up to N times as large")
      ->check(CLI::Range(2, 64))
      ->type_name("N");
  add_json(*command, arguments->json);
  command->footer(
      "A frame is the building of the surface from the particles and one look at it: depth, normals, thickness.\n"
      "The plain method computes the same surface ray by ray with one thread. Where a whole picture of it takes\n"
      "more than three seconds it is measured at every fifth pixel across and down (plain_measured_size) and at\n"
      "every eleventh, and the time for all pixels follows from both. Both methods' hits and depths are compared\n"
      "at the pixels that the plain one has computed (compared_pixels).");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
