#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <new>

#include "bench_crown.h"
#include "bench_memory.h"
#include "bench_options.h"
#include "bench_timing.h"
#include "commands.h"
#include "json.h"
#include "meniscus/io.h"
#include "meniscus/render.h"

namespace meniscus::apps {
namespace {

/// Seconds a frame on a GTX 970.                                                           [Xiao2017] table 1
constexpr std::array<int, 5> kPaperSizes{512, 768, 1024, 1440, 1920};
struct PaperRow {
  std::size_t particles;
  std::array<double, 5> seconds;
};
constexpr std::array<PaperRow, 5> kPaper{{{779'752, {0.00936, 0.0127, 0.0178, 0.0270, 0.0424}},
                                          {2'027'776, {0.0274, 0.0362, 0.05138, 0.0779, 0.1226}},
                                          {12'394'215, {0.0891, 0.1128, 0.1568, 0.2474, 0.3733}},
                                          {37'975'520, {0.1565, 0.2119, 0.2966, 0.4494, 0.7062}},
                                          {142'612'764, {0.5926, 0.6600, 0.7840, 1.3879, 2.3663}}}};

constexpr std::size_t kMostParticles = 4'000'000'000;

struct Table1Arguments {
  std::vector<std::size_t> particles;
  std::vector<int> sizes;
  std::size_t max_particles = kMostParticles;
  int repeat = 5;
  int threads = 0;
  std::string frames;
  bool json = false;
};

/// Paper's ms of this cell of its table; null where it has none.
Json paper_ms(std::size_t particles, int size) {
  for (const PaperRow& row : kPaper)
    for (std::size_t i = 0; i < kPaperSizes.size(); ++i)
      if (row.particles == particles && kPaperSizes[i] == size) return 1000 * row.seconds[i];
  return nullptr;
}

struct Timed {
  double ms = 0;
  StageTimes stages;
  std::uint64_t peak_bytes = 0;  ///< of the program's memory while this was done
};
/// The median; the upper of the two middle ones of an even number. The stages are those of that very run.
Timed middle_of(std::vector<Timed> runs) {
  const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(runs.size() / 2);
  std::nth_element(runs.begin(), middle, runs.end(), [](const Timed& a, const Timed& b) { return a.ms < b.ms; });
  return *middle;
}

/// Fewer runs of what takes long: one of the largest of the table.
int repeats_of(std::size_t particles, int repeat) {
  constexpr double kParticles = 24e6;
  return std::clamp(static_cast<int>(std::ceil(repeat * kParticles / static_cast<double>(particles))), 1, repeat);
}

struct Frame {
  Image<vec3> radiance;
  std::size_t covered = 0;  ///< pixels with water
};

Timed timed_build(const Particles& crown, const RaycastOptions& options, std::unique_ptr<Surface>& surface) {
  surface.reset();
  forget_peak();
  Timed timed;
  const auto start = Clock::now();
  surface = make_raycast_surface(crown, options, {}, &timed.stages);
  timed.ms = ms_since(start);
  timed.peak_bytes = peak_rss_bytes();
  return timed;
}

Timed timed_view(const Surface& surface, const CrownLook& look, const View& view, Frame& frame) {
  forget_peak();
  Timed timed;
  const auto start = Clock::now();
  const SurfaceBuffers seen = surface.see(view, {}, &timed.stages);
  frame.radiance = look.shaded(view, seen, &timed.stages);
  timed.ms = ms_since(start);
  timed.peak_bytes = peak_rss_bytes();
  frame.covered = static_cast<std::size_t>(
      std::count_if(seen.depth.begin(), seen.depth.end(), [](float d) { return std::isfinite(d); }));
  return timed;
}

/// All sizes of one number of particles.
Json rows_of(const Particles& crown, const std::vector<int>& sizes, int repeats, const std::string& frames) {
  const CrownLook look;
  const RaycastOptions options = crown_options(crown);
  const bool warm = crown.size() < 20'000'000;  // those take so long that nothing is cold
  std::vector<Timed> builds;
  std::vector<std::vector<Timed>> views(sizes.size());
  std::vector<std::size_t> covered(sizes.size(), 0);
  std::unique_ptr<Surface> surface;
  for (int run = warm ? -1 : 0; run < repeats; ++run) {
    const Timed build = timed_build(crown, options, surface);
    if (run >= 0) builds.push_back(build);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      Frame frame;
      const Timed view = timed_view(*surface, look, crown_view(sizes[i], sizes[i]), frame);
      if (run >= 0) views[i].push_back(view);
      if (run + 1 < repeats) continue;
      covered[i] = frame.covered;
      if (!frames.empty())
        write_png(fmt::format("{}/crown_{}_{}.png", frames, crown.size(), sizes[i]), developed(frame.radiance, {}));
    }
  }
  const Timed build = middle_of(builds);
  Json rows = Json::array();
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const Timed view = middle_of(views[i]);
    StageTimes stages = build.stages;
    stages.add(view.stages);
    const std::uint64_t input = 3 * sizeof(float) * crown.size(), peak = std::max(build.peak_bytes, view.peak_bytes);
    rows.push_back({{"particles", crown.size()},
                    {"size", sizes[i]},
                    {"spacing", json_of(options.spacing)},
                    {"covered_pixels", covered[i]},
                    {"runs", repeats},
                    {"stages_ms", json_of(stages)},
                    {"build_ms", build.ms},
                    {"view_ms", view.ms},
                    {"frame_ms", build.ms + view.ms},
                    {"input_bytes", input},
                    {"peak_rss_bytes", peak},
                    {"beside_input_bytes", peak - std::min(input, peak)},
                    {"paper_ms", paper_ms(crown.size(), sizes[i])}});
  }
  return rows;
}

std::vector<std::size_t> counts_of(const Table1Arguments& arguments) {
  std::vector<std::size_t> counts = arguments.particles;
  if (counts.empty())
    for (const PaperRow& row : kPaper) counts.push_back(row.particles);
  std::erase_if(counts, [&](std::size_t count) { return count > arguments.max_particles; });
  if (counts.empty()) counts.push_back(arguments.max_particles);
  std::sort(counts.begin(), counts.end());  // where a peak of memory cannot be forgotten it is still that of the row
  return counts;
}

/// Whether a crown and its surface fit into the memory that there is; else a note is made.
bool fits(std::size_t count, const std::vector<int>& sizes, Json& notes) {
  const Bounds box{{-1, 0, -1}, {1, 1.05f, 1}};
  RaycastOptions options;
  options.spacing = std::cbrt(1.22f / static_cast<float>(count));  // m^3 of a crown
  const auto edge = static_cast<std::uint64_t>(sizes.empty() ? 0 : *std::max_element(sizes.begin(), sizes.end()));
  const RaycastEstimate estimate = estimate_raycast(count, box, options, edge * edge);
  const std::uint64_t needed =
      3 * sizeof(float) * count + std::max(estimate.build_bytes, estimate.kept_bytes + estimate.view_bytes);
  const std::uint64_t available = available_bytes();
  if (needed < available) return true;
  notes.push_back(fmt::format("{} particles left out: they would take {:.1f} GB, {:.1f} GB are free", count,
                              static_cast<double>(needed) / 1e9, static_cast<double>(available) / 1e9));
  return false;
}

/// How many times as long the most particles take as the fewest; null without two numbers of them.
Json growth(const Json& rows, int size, const char* key) {
  const Json *first = nullptr, *last = nullptr;
  for (const Json& row : rows) {
    if (row["size"] != size) continue;
    if (!first) first = &row;
    last = &row;
  }
  if (first == last) return nullptr;
  return (*last)[key].get<double>() / (*first)[key].get<double>();
}

Json measure(const Table1Arguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  std::vector<int> sizes = arguments.sizes;
  if (sizes.empty()) sizes.assign(kPaperSizes.begin(), kPaperSizes.end());
  Json json, notes = Json::array();
  const View view = crown_view(sizes.front(), sizes.front());
  json["scene"] = "crown";
  json["threads"] = thread_count();
  json["instruction_set"] = instruction_sets().front();
  json["repeat"] = arguments.repeat;
  json["statistic"] = "median";
  json["camera"] = {{"eye", json_of(view.eye)},
                    {"forward", json_of(view.forward)},
                    {"up", json_of(view.up)},
                    {"vertical_fov_deg", 2 * std::atan(static_cast<double>(view.half_height)) * 57.29577951308232}};
  Json rows = Json::array();
  for (const std::size_t count : counts_of(arguments)) {
    if (!fits(count, sizes, notes)) continue;
    try {
      const Particles crown = synthetic_crown(count);
      if (!arguments.frames.empty()) write_particles(fmt::format("{}/crown_{}.ply", arguments.frames, count), crown);
      for (Json& row : rows_of(crown, sizes, repeats_of(count, arguments.repeat), arguments.frames))
        rows.push_back(std::move(row));
    } catch (const std::bad_alloc&) {
      notes.push_back(fmt::format("{} particles left out: memory ran out", count));
    }
  }
  const int size = std::find(sizes.begin(), sizes.end(), 1024) != sizes.end() ? 1024 : sizes.back();
  json["growth_size"] = size;
  json["growth"] = growth(rows, size, "frame_ms");
  json["view_growth"] = growth(rows, size, "view_ms");
  json["rows"] = std::move(rows);
  json["notes"] = std::move(notes);
  return json;
}

void print(const Json& json) {
  std::cout << fmt::format("{} threads, {}; ms; MB beside the particles\n", json["threads"].get<int>(),
                           json["instruction_set"].get<std::string>());
  std::cout << fmt::format("{:>11}{:>7}{:>9}{:>9}{:>9}{:>9}{:>10}\n", "particles", "size", "build", "view", "frame",
                           "paper", "memory");
  for (const Json& row : json["rows"]) {
    const Json& paper = row["paper_ms"];
    std::cout << fmt::format("{:>11}{:>7}{:>9.1f}{:>9.1f}{:>9.1f}{:>9}{:>10.0f}\n", row["particles"].get<std::size_t>(),
                             row["size"].get<int>(), row["build_ms"].get<double>(), row["view_ms"].get<double>(),
                             row["frame_ms"].get<double>(),
                             paper.is_null() ? "-" : fmt::format("{:.1f}", paper.get<double>()),
                             row["beside_input_bytes"].get<double>() / 1e6);
  }
  if (!json["growth"].is_null())
    std::cout << fmt::format(
        "from the fewest to the most particles at {0} x {0}: a frame takes {1:.1f} times as long, a new view of the "
        "same particles {2:.1f} times\n",
        json["growth_size"].get<int>(), json["growth"].get<double>(), json["view_growth"].get<double>());
  for (const Json& note : json["notes"]) std::cout << note.get<std::string>() << '\n';
}

}  // namespace

void add_bench_table1(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("table1", "The table of times of the ray-cast method: a water crown");
  const auto arguments = std::make_shared<Table1Arguments>();
  command
      ->add_option("--particles", arguments->particles,
                   "Particles of the crowns, with commas (default: 779752,2027776,12394215,37975520,142612764)")
      ->type_name("N,...")
      ->delimiter(',')
      ->check(CLI::Range(std::size_t{1000}, kMostParticles).description(""));
  command
      ->add_option("--max-particles", arguments->max_particles,
                   "Leave out what is larger; where nothing is left, one crown of so many (default: all)")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1000}, kMostParticles).description(""));
  command
      ->add_option("--sizes", arguments->sizes,
                   "Width and height of the pictures, px, with commas (default: 512,768,1024,1440,1920)")
      ->type_name("N,...")
      ->delimiter(',')
      ->check(CLI::Range(1, 16384).description(""));
  add_repeat(*command, arguments->repeat, "Runs that the median is taken of; fewer of the largest (default: 5)");
  add_threads(*command, arguments->threads);
  command
      ->add_option("--write-frames", arguments->frames,
                   "Folder that the pictures and the particles (crown_N.ply) are written to")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory.description(""));
  add_json(*command, arguments->json);
  command->footer(
      "build_ms is the making of the surface from the particles, which all sizes of a crown share; view_ms is what\n"
      "each view adds, as a camera that moves about still particles would: depth, normals, thickness and shading to\n"
      "linear radiance. frame_ms is both. The particles are made before: beside_input_bytes is the peak of the\n"
      "program's memory without them. paper_ms is what [Xiao2017] took on a GTX 970. growth and view_growth compare\n"
      "the most particles with the fewest at 1024 x 1024. Crowns that would not fit into memory are left out: see "
      "notes.");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
