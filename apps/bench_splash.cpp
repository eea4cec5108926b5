#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <sstream>

#include "base/random.h"
#include "bench_options.h"
#include "bench_timing.h"
#include "commands.h"
#include "meniscus/shading.h"

namespace meniscus::apps {
namespace {

struct SplashArguments {
  PictureSize size{640, 480};
  std::vector<int> counts{100, 500, 1000, 3000, 30000};
  int scenes = 10;
  int threads = 0;
  bool whole = false;
  bool json = false;
};

/// A column of the published table.
struct Kind {
  const char* name;
  Wetness wetness;
  std::array<double, 4> published;  ///< frames a second at 100, 500, 1000, 3000              [Mizukami2013] table 2
};
constexpr std::array<Kind, 4> kKinds{{{"wet_fps", Wetness::wet, {492.61, 165.84, 85.11, 30.36}},
                                      {"puddle_3mm_fps", Wetness::puddle_3mm, {303.03, 81.90, 43.71, 14.96}},
                                      {"puddle_5mm_fps", Wetness::puddle_5mm, {204.08, 52.00, 23.30, 9.05}},
                                      {"crown_cone_fps", Wetness::puddle_10mm, {534.73, 222.22, 124.38, 45.35}}}};
constexpr std::array<int, 4> kPublishedCounts{100, 500, 1000, 3000};
constexpr float kFarthest = 20, kEyeHeight = 1.6f, kAge = 0.1f, kDiameter = 0.002f;

/// Medium drops that fell straight down within the last tenth of a second, on places that are even over the picture
/// where it shows ground up to 20 m away.
Splashes random_splashes(const View& view, Wetness wetness, int count, std::uint64_t scene) {
  Splashes splashes{SplashOptions{}};
  Draws draws(scene, static_cast<std::uint64_t>(wetness));
  for (int i = 0; i < count;) {
    const Ray ray = view.ray({draws.between(0, view.width), draws.between(0, view.height)});
    const float distance = ray.direction.y < 0 ? -kEyeHeight / ray.direction.y : kFarthest;
    if (!(distance < kFarthest)) continue;
    Impact impact;
    impact.id = mixed(scene * 1'000'003 + static_cast<std::uint64_t>(i));
    impact.time = -draws.between(0.002, kAge);
    impact.point = ray.origin + distance * ray.direction;
    impact.point.y = 0;
    impact.velocity = {0, -6.5f, 0};
    impact.diameter = kDiameter;
    impact.wetness = wetness;
    splashes.add(impact);
    ++i;
  }
  return splashes;
}

Json measure(const SplashArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  const View view =
      perspective_view({0, kEyeHeight, 0}, {0, 0.4f, -5}, {0, 1, 0}, 0.8f, arguments.size.width, arguments.size.height);
  EnvironmentOptions sky;
  sky.cloud_cover = 1;
  Ground ground;
  ground.albedo = vec3{0.11f};
  ground.fade_radius = 100;
  const Scene scene(Environment(sky), ground);
  const SceneBuffers background = scene.see(view);
  const Surroundings surroundings(scene, {0, 0.5f, -4});
  RainLook look;
  look.level_of_detail = !arguments.whole;

  Image<vec3> picture(view.width, view.height);
  std::vector<WaterPiece> pieces;
  const auto frame_ms = [&](const Splashes& splashes) {
    // As in a film: the picture of the ground is there already, and is drawn over.
    std::copy(background.radiance.begin(), background.radiance.end(), picture.begin());
    const auto start = Clock::now();
    pieces.clear();
    splashes.pieces(0, arguments.whole ? nullptr : &view, pieces);
    draw_rain(view, pieces, surroundings, look, background.depth, picture);
    return ms_since(start);
  };

  Json rows = Json::array(), published = Json::array(), growth;
  std::array<double, kKinds.size()> at_100{}, at_3000{};
  for (const int count : arguments.counts) {
    Json row;
    row["splashes"] = count;
    Json drawn;
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      double total = 0;
      std::size_t shapes = 0;
      for (int s = 0; s < arguments.scenes; ++s) {
        const Splashes splashes = random_splashes(view, kKinds[k].wetness, count, static_cast<std::uint64_t>(s) + 1);
        std::vector<double> repeats;
        for (int repeat = 0; repeat < 3; ++repeat) repeats.push_back(frame_ms(splashes));
        total += median(repeats);
        shapes += pieces.size();
      }
      const double ms = total / arguments.scenes;
      row[kKinds[k].name] = 1000 / ms;
      drawn[kKinds[k].name] = static_cast<double>(shapes) / arguments.scenes;
      if (count == 100) at_100[k] = ms;
      if (count == 3000) at_3000[k] = ms;
    }
    row["pieces"] = {drawn["wet_fps"], drawn["puddle_3mm_fps"], drawn["puddle_5mm_fps"], drawn["crown_cone_fps"]};
    rows.push_back(row);
  }
  for (std::size_t i = 0; i < kPublishedCounts.size(); ++i) {
    Json row;
    row["splashes"] = kPublishedCounts[i];
    for (const Kind& kind : kKinds) row[kind.name] = kind.published[i];
    published.push_back(row);
  }
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    if (at_100[k] > 0 && at_3000[k] > 0) growth[kKinds[k].name] = at_3000[k] / at_100[k];
  Json json;
  json["rows"] = rows;
  json["paper"] = published;
  json["growth"] = growth;
  json["view"] = {{"width", view.width},
                  {"height", view.height},
                  {"eye_height_m", json_of(kEyeHeight)},
                  {"farthest_m", json_of(kFarthest)}};
  json["scenes"] = arguments.scenes;
  json["level_of_detail"] = look.level_of_detail;
  json["threads"] = thread_count();
  return json;
}

void print(const Json& json) {
  const auto table = [](const Json& rows) {
    for (const Json& row : rows)
      std::cout << fmt::format("{:>10}{:>10.1f}{:>10.1f}{:>10.1f}{:>12.1f}\n", row["splashes"].get<int>(),
                               row["wet_fps"].get<double>(), row["puddle_3mm_fps"].get<double>(),
                               row["puddle_5mm_fps"].get<double>(), row["crown_cone_fps"].get<double>());
  };
  std::cout << fmt::format("frames a second at {} x {} px, {} threads, mean of {} scenes\n",
                           json["view"]["width"].get<int>(), json["view"]["height"].get<int>(),
                           json["threads"].get<int>(), json["scenes"].get<int>())
            << fmt::format("{:>10}{:>10}{:>10}{:>10}{:>12}\n", "splashes", "wet", "3 mm", "5 mm", "crown-cone");
  table(json["rows"]);
  std::cout << "published\n";
  table(json["paper"]);
}

std::vector<int> parsed_counts(const std::string& text) {
  std::vector<int> counts;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    std::size_t used = 0;
    int count = 0;
    try {
      count = std::stoi(word, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || used != word.size() || count < 1 || count > 1'000'000)
      throw UsageError(
          fmt::format("--counts: expected numbers from 1 to 1000000 with commas between, found \"{}\"", text));
    counts.push_back(count);
  }
  if (counts.empty()) throw UsageError("--counts: expected at least one number");
  return counts;
}

}  // namespace

void add_bench_splash(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("splash", "Drawing of splashes at random places");
  const auto arguments = std::make_shared<SplashArguments>();
  add_size(*command, "--size", arguments->size, "Picture (default: 640x480)");
  command
      ->add_option_function<std::string>(
          "--counts", [arguments](const std::string& text) { arguments->counts = parsed_counts(text); },
          "Splashes in the picture (default: 100,500,1000,3000,30000)")
      ->type_name("N,N,...");
  command->add_option("--scenes", arguments->scenes, "Scenes that the mean is taken of (default: 10)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000).description(""));
  command->add_flag("--whole", arguments->whole, "Draw far splashes as near ones");
  add_threads(*command, arguments->threads);
  add_json(*command, arguments->json);
  command->footer(
      "Medium drops on asphalt that is wet or under 3, 5 or 10 mm of water, fallen within the last 0.1 s, seen from "
      "1.6 m above the ground up to 20 m away. Measured are the pieces of the splashes and their drawing over a "
      "picture "
      "of the ground; each scene counts with the median of three.");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
