#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <memory>

#include "bench_options.h"
#include "bench_timing.h"
#include "commands.h"
#include "meniscus/render.h"

namespace meniscus::apps {
namespace {

struct TankArguments {
  PictureSize size{950, 950};
  int frames = 5;
  int warm_up = 20;
  int threads = 0;
  bool json = false;
};

/// A row of the paper's table.                                                                [Cords2008] table 1
struct TankRow {
  const char* name;
  std::size_t particles;  ///< 0: superposed waves
  std::vector<BodyOptions> bodies;
};

BodyOptions body(const char* shape, vec3 centre, vec3 size, vec3 colour) {
  BodyOptions made;
  made.shape = shape;
  made.world_from_body = glm::scale(glm::translate(glm::mat4{1.0f}, centre), size);
  made.material = SolidMaterial{};
  made.material->albedo = colour;
  made.role = ObstacleRole{};
  return made;
}

/// Stand-ins for the paper's scenes, which it shows without describing them.
std::vector<TankRow> table_rows() {
  const vec3 red{0.8f, 0.3f, 0.15f}, sand{0.85f, 0.75f, 0.3f}, green{0.3f, 0.6f, 0.35f};
  const BodyOptions cuboid = body("box", {0.5f, 0.3f, 0.5f}, {0.16f, 0.6f, 0.16f}, red);
  const BodyOptions column = body("cylinder", {0.55f, 0.3f, 0.5f}, {0.16f, 0.6f, 0.16f}, sand);
  const std::vector<BodyOptions> several{body("box", {0.3f, 0.2f, 0.35f}, {0.14f, 0.4f, 0.14f}, red), column,
                                         body("sphere", {0.75f, 0.22f, 0.7f}, {0.24f, 0.24f, 0.24f}, green)};
  std::vector<BodyOptions> table{body("box", {0.5f, 0.42f, 0.5f}, {0.5f, 0.04f, 0.5f}, sand)};
  for (const vec2 leg : {vec2{0.3f, 0.3f}, vec2{0.7f, 0.3f}, vec2{0.3f, 0.7f}, vec2{0.7f, 0.7f}})
    table.push_back(body("box", {leg.x, 0.2f, leg.y}, {0.06f, 0.4f, 0.06f}, sand));
  return {{"fig. 4", 0, {cuboid}},       {"fig. 5 b", 0, several},     {"fig. 9", 2000, {column}},
          {"fig. 9", 3000, {column}},    {"fig. 12 a", 2000, several}, {"fig. 12 b", 2000, {cuboid}},
          {"fig. 12 b", 3000, {cuboid}}, {"fig. 12 c", 2000, table}};
}

/// A tank of a cubic metre, a quarter of it water, which begins as a dam.
SimulatedWater water_of(const TankRow& row, const TankArguments& arguments) {
  SimulatedWater water;
  water.simulation.tank = {{0, 0, 0}, {1, 0.8f, 1}};
  water.simulation.blocks = {{{0, 0, 0}, {0.5f, 0.5f, 1}}};
  water.simulation.fluid.spacing = static_cast<float>(std::cbrt(0.25 / static_cast<double>(row.particles)));
  water.frames_per_second = 1 / 0.009;  // three steps a frame, the paper's most
  water.most_steps = 3;
  water.frames = static_cast<std::size_t>(arguments.warm_up + 4 * (arguments.frames + 1));
  return water;
}

HeightField waves(double time) {
  WaveFieldOptions options;
  options.region = {{0, 0, 0}, {1, 0.25f, 1}};
  options.step = 1.0f / 128;
  WaveTrain one, other;
  one.amplitude = 0.012f;
  one.direction_deg = 25;
  other.amplitude = 0.007f;
  other.wavelength = 0.3f;
  other.direction_deg = 100;
  options.waves = {one, other};
  return height_field(options, time);
}

enum class Light { none, simple, physical };

/// One row's tank as it is drawn, frame after frame.
class DrawnTank {
 public:
  DrawnTank(const TankRow& row, const TankArguments& arguments) : bodies_(row.bodies), arguments_(arguments) {
    PictureOptions picture;
    picture.width = arguments.size.width;
    picture.height = arguments.size.height;
    picture.method = SurfaceMethod::height_field;
    picture.optics.refraction = RefractionMethod::virtual_eye;
    picture.antialias = Antialias::off;  // as in the paper
    picture.tank = TankStyle::tiled;
    picture.tank_inside = Bounds{{0, 0, 0}, {1, 0.8f, 1}};
    picture.camera.elevation_deg = 35.0f;
    picture.camera.azimuth_deg = 20.0f;
    Survey survey;
    if (row.particles > 0) {
      simulated_ = std::make_unique<SimulatedScene>(water_of(row, arguments), row.bodies);
      survey = simulated_->survey();
    } else {
      survey.bounds = {{0, 0, 0}, {1, 0.25f, 1}};
      survey.spacing.spacing = 0.02f;
    }
    settings_ = settings_of(survey, picture);
    if (!simulated_) settings_.heights = waves;
    for (int i = 0; i < arguments.warm_up; ++i) static_cast<void>(next_water(nullptr));
  }

  /// Median frames a second with this light; the stages' means are added to `stages` (ms).
  double frames_per_second(Light light, StageTimes& stages) {
    FrameSettings settings = settings_;
    settings.caustics = light != Light::none;
    settings.shadow = light != Light::none;
    settings.caustics_options.method = light == Light::physical ? CausticsMethod::light_map : CausticsMethod::simple;
    std::vector<double> frames;
    for (int i = 0; i <= arguments_.frames; ++i) {  // the first one warms up
      StageTimes times;
      const auto start = Clock::now();
      const Particles particles = next_water(&times);
      settings.solids = placed_;
      const FramePicture picture = render_frame(particles, settings);
      if (i == 0) continue;
      frames.push_back(ms_since(start));
      for (const StageTimes* part : {static_cast<const StageTimes*>(&times), &picture.times})
        for (const auto& [stage, ms] : part->rows()) stages.add(stage, ms / arguments_.frames);
    }
    return 1000 / median(std::move(frames));
  }

 private:
  Particles next_water(StageTimes* times) {
    Particles particles;
    std::vector<std::string> notes;
    placed_ = bodies_.at(frame_, 0, notes);
    if (simulated_) {
      const StageTimer timer(times, "simulation");
      particles = simulated_->frame(frame_);
    } else {
      particles.time = 0.009 * static_cast<double>(frame_);
    }
    ++frame_;
    return particles;
  }

  Bodies bodies_;
  const TankArguments& arguments_;
  std::unique_ptr<SimulatedScene> simulated_;
  FrameSettings settings_;
  std::vector<PlacedSolid> placed_;
  std::size_t frame_ = 0;
};

Json measure(const TankArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  Json rows = Json::array();
  StageTimes stages;
  const std::vector<TankRow> table = table_rows();
  for (const TankRow& row : table) {
    DrawnTank tank(row, arguments);
    StageTimes not_shown;
    Json json;
    json["name"] = row.name;
    json["particles"] = row.particles;
    json["refl_refr_fps"] = tank.frames_per_second(Light::none, not_shown);
    json["simple_caustics_fps"] = tank.frames_per_second(Light::simple, not_shown);
    StageTimes physical;
    json["physical_caustics_fps"] = tank.frames_per_second(Light::physical, physical);
    for (const auto& [stage, ms] : physical.rows()) stages.add(stage, ms / static_cast<double>(table.size()));
    rows.push_back(std::move(json));
  }
  Json json;
  json["width"] = arguments.size.width;
  json["height"] = arguments.size.height;
  json["threads"] = thread_count();
  json["rows"] = rows;
  json["stages_ms"] = json_of(stages);
  return json;
}

void print(const Json& json) {
  std::cout << fmt::format("{}x{} pixels, {} threads; frames a second\n  {:<12}{:>10}{:>14}{:>14}{:>14}\n",
                           json["width"].get<int>(), json["height"].get<int>(), json["threads"].get<int>(), "scene",
                           "particles", "refl. refr.", "simple c.", "physical c.");
  for (const Json& row : json["rows"])
    std::cout << fmt::format("  {:<12}{:>10}{:>14.1f}{:>14.1f}{:>14.1f}\n", row["name"].get<std::string>(),
                             row["particles"].get<std::size_t>(), row["refl_refr_fps"].get<double>(),
                             row["simple_caustics_fps"].get<double>(), row["physical_caustics_fps"].get<double>());
  std::cout << "  a frame with physical caustics, mean of all scenes:\n";
  for (const auto& [stage, ms] : json["stages_ms"].items())
    std::cout << fmt::format("  {:<22}{:>10.2f} ms\n", stage, ms.get<double>());
}

}  // namespace

void add_bench_tank(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("tank", "A live tank, simulated and drawn: table 1 of Cords 2008");
  const auto arguments = std::make_shared<TankArguments>();
  add_size(*command, "--size", arguments->size, "Size of the pictures, px (default: 950x950)");
  add_repeat(*command, arguments->frames, "Frames that each median is taken of (default: 5)");
  command->add_option("--warm-up", arguments->warm_up, "Frames that are simulated before (default: 20)")
      ->type_name("N")
      ->check(CLI::Range(0, 100'000).description(""));
  add_threads(*command, arguments->threads);
  add_json(*command, arguments->json);
  command->footer(
      "A frame is three steps of SPH, the height field, objects from virtual eyes, caustics and the developed "
      "picture,\n"
      "one ray a pixel. stages_ms are means over all scenes with physical caustics (the light map).");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
