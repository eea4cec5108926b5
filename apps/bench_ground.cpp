#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <numbers>
#include <string>

#include "bench_options.h"
#include "commands.h"
#include "sim/splash_make.h"

namespace meniscus::apps {
namespace {

struct GroundArguments {
  int splashes = 100'000;
  float diameter_mm = 2;
  std::uint64_t seed = 1;
  int threads = 0;
  bool json = false;
};

constexpr std::array kMaterials{GroundMaterial::concrete, GroundMaterial::asphalt, GroundMaterial::steel};
constexpr std::array kWetnesses{Wetness::dry, Wetness::wet, Wetness::puddle_3mm, Wetness::puddle_5mm,
                                Wetness::puddle_10mm};
constexpr std::array kQuantities{"number", "angle_deg", "speed_m_s"};

/// Of one quantity over all splashes on one state of a cell.
struct Spread {
  double count = 0, sum = 0, squares = 0, least = INFINITY, most = -INFINITY;
  void add(double value) {
    ++count, sum += value, squares += value * value;
    least = std::min(least, value), most = std::max(most, value);
  }
};

/// Number, angle above the ground and speed of the droplets that leave; those of a crown fall back with it.
std::array<Spread, 3> drawn(const GroundArguments& arguments, GroundMaterial material, Wetness wetness) {
  std::array<Spread, 3> spreads;
  SplashOptions options;
  options.seed = arguments.seed;
  Impact impact;
  impact.diameter = 1e-3f * arguments.diameter_mm;
  impact.velocity = {0, -fall_speed(impact.diameter), 0};
  impact.material = material;
  impact.wetness = wetness;
  std::vector<Droplet> droplets;
  for (int i = 0; i < arguments.splashes; ++i) {
    impact.id = static_cast<std::uint64_t>(i);
    droplets.clear();
    make_splash(impact, options, droplets);
    int leaving = 0;
    for (const Droplet& droplet : droplets) {
      if (!(droplet.radius > 0)) continue;
      ++leaving;
      const double speed = glm::length(glm::dvec3(droplet.velocity));
      spreads[1].add(std::asin(std::min(droplet.velocity.y / speed, 1.0)) * 180 / std::numbers::pi);
      spreads[2].add(speed);
    }
    spreads[0].add(leaving);
  }
  return spreads;
}

Json measure(const GroundArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  std::array<std::array<Spread, 3>, kMaterials.size() * kWetnesses.size()> cells;
  parallel_for(cells.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      cells[i] = drawn(arguments, kMaterials[i / kWetnesses.size()], kWetnesses[i % kWetnesses.size()]);
  });
  Json rows = Json::array();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const GroundMaterial material = kMaterials[i / kWetnesses.size()];
    const Wetness wetness = kWetnesses[i % kWetnesses.size()];
    Json row;
    row["material"] = name_of(material);
    row["wetness"] = name_of(wetness);
    row["splash"] = name_of(splash_kind(material, wetness));
    for (std::size_t q = 0; q < kQuantities.size(); ++q) {
      const Spread& spread = cells[i][q];
      if (cells[i][1].count == 0) continue;  // nothing leaves
      const double mean = spread.sum / spread.count;
      row[kQuantities[q]] = {{"min", spread.least},
                             {"mean", mean},
                             {"max", spread.most},
                             {"deviation", std::sqrt(std::max(spread.squares / spread.count - mean * mean, 0.0))}};
    }
    rows.push_back(row);
  }
  Json json;
  json["rows"] = rows;
  json["splashes"] = arguments.splashes;
  json["diameter_mm"] = json_of(arguments.diameter_mm);
  return json;
}

void print(const Json& json) {
  std::cout << fmt::format("{} splashes of drops of {:g} mm on each state of a cell: smallest, mean, largest\n",
                           json["splashes"].get<int>(), json["diameter_mm"].get<double>())
            << fmt::format("{:<10}{:<13}{:<12}{:>18}{:>20}{:>20}\n", "", "", "", "droplets", "angle, deg",
                           "speed, m/s");
  for (const Json& row : json["rows"]) {
    std::string line = fmt::format("{:<10}{:<13}{:<12}", row["material"].get<std::string>(),
                                   row["wetness"].get<std::string>(), row["splash"].get<std::string>());
    if (row.contains("number")) {
      const auto of = [&](const char* name, const char* key) { return row[name][key].get<double>(); };
      line += fmt::format("{:>5.0f}{:>8.2f}{:>5.0f}", of("number", "min"), of("number", "mean"), of("number", "max"));
      line += fmt::format("{:>7.2f}{:>7.2f}{:>6.1f}", of("angle_deg", "min"), of("angle_deg", "mean"),
                          of("angle_deg", "max"));
      line += fmt::format("{:>8.3f}{:>6.3f}{:>6.3f}", of("speed_m_s", "min"), of("speed_m_s", "mean"),
                          of("speed_m_s", "max"));
    }
    std::cout << line << '\n';
  }
}

}  // namespace

void add_bench_ground(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("ground", "Splashes by material and wetness of the ground");
  const auto arguments = std::make_shared<GroundArguments>();
  command->add_option("--splashes", arguments->splashes, "On each state of a cell (default: 100000)")
      ->type_name("N")
      ->check(CLI::Range(1, 10'000'000).description(""));
  command->add_option("--diameter", arguments->diameter_mm, "Of the drops, mm (default: 2)")
      ->type_name("MM")
      ->check(CLI::Range(0.1, 10.0).description(""));
  command->add_option("--seed", arguments->seed, "Of the splashes (default: 1)")->type_name("N");
  add_threads(*command, arguments->threads);
  add_json(*command, arguments->json);
  command->footer(
      "Drops fall straight down at their terminal velocity. Number, angle above the ground and speed of the\n"
      "droplets that leave: smallest, mean, largest.");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
