#include "render/frame_time.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

namespace meniscus {
namespace {

constexpr double kPixels = 9000;                 ///< of the small picture
constexpr double kFewest = 2000, kMost = 30000;  ///< particles in it
constexpr int kLightPixels = 128;                ///< along the light's virtual screen, instead of 512
constexpr double kDeeperLight = 1.7;             ///< see light_scale()
constexpr double kDearestSurvey = 250e-9;        ///< s a particle; more was the machine's mood
// Seconds a pixel of encoding, on a machine that draws as fast as the one of docs/performance.md.
constexpr double kPng = 60e-9, kFilm = 25e-9, kExr = 120e-9;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Stages that grow with the particles, and those that do not grow with the frame; all others grow with its pixels.
const std::set<std::string>& particle_stages() {
  static const std::set<std::string> stages{"sort",    "masses",     "colours",       "particles", "columns", "smooth",
                                            "surface", "neighbours", "splat density", "surfels",   "walls",   "splat"};
  return stages;
}
bool is_fixed(const std::string& stage) {
  return stage == "shadow" || stage == "scene" || stage == "virtual eyes" || stage == "eyes" ||
         stage == "surroundings" || stage == "reference";
}

/// The frame's caustics over those of the small picture: the screen has that many times more pixels, and light goes
/// through more particles where the water has more of them (twice as long at a million as at three thousand).
double light_scale(const PictureOptions& picture) {
  const int width = picture.caustics_options.screen_width > 0 ? picture.caustics_options.screen_width : 512;
  const double ratio = static_cast<double>(width) / kLightPixels;
  return ratio * ratio * kDeeperLight;
}

/// The same picture of a small tank: without what stands in files, and with the camera that fits it.
PictureOptions small_picture(const PictureOptions& picture, double factor) {
  PictureOptions small = picture;
  small.width = std::max(16, static_cast<int>(std::lround(picture.width * factor)));
  small.height = std::max(16, static_cast<int>(std::lround(picture.height * factor)));
  small.surface.spacing = small.surface.smoothing_length = small.surface.normal_radius = 0;
  small.surfels.grid_step = small.surfels.gap_threshold = small.surfels.epsilon = 0;
  small.height_field.step = small.height_field.iso_radius = 0;
  small.height_field.smoothing = -1;
  small.height_field.region = {};
  small.caustics_options.screen_width = kLightPixels;
  small.caustics_options.screen_height = small.caustics_options.map_size = 0;
  small.colour.reset();
  small.legend = false;
  small.environment_hdr.clear();
  small.bodies.clear();
  small.bodies_bounds = {};
  small.tank_inside.reset();
  small.ground_height.reset();
  small.lamps.clear();
  small.camera = {};
  small.path.reset();
  small.rain.reset();
  small.heights = nullptr;
  small.memory_limit = 0;
  small.drop_isolated = 0;
  return small;
}

}  // namespace

FrameTime measure_frame(const PictureOptions& picture, std::uint64_t particles, PictureFormat format) {
  // A miniature: edges of picture and water shrink alike, so that a spacing stays as many pixels.
  const double pixels = static_cast<double>(picture.width) * picture.height;
  const double factor = std::min(1.0, std::sqrt(kPixels / pixels));
  const double few =
      std::clamp(static_cast<double>(std::max<std::uint64_t>(particles, 1)) * std::pow(factor, 3), kFewest, kMost);
  const PictureOptions small = small_picture(picture, factor);
  FrameTime mean;
  for (const bool crown : {false, true}) {
    const auto count = static_cast<std::size_t>(few);
    const Particles water = crown ? synthetic_crown(count) : synthetic_tank(count);
    const auto survey_start = Clock::now();
    const Survey survey = survey_particles(water);
    mean.survey_a_particle += 0.5 * std::min(seconds_since(survey_start) / few, kDearestSurvey);
    const FrameSettings settings = settings_of(survey, small);
    const auto start = Clock::now();
    const FramePicture frame = render_frame(water, settings);
    const double total = seconds_since(start);
    double by_particles = 0, by_light = 0, fixed = 0;
    for (const auto& [stage, ms] : frame.times.rows()) {
      const double s = ms * 1e-3;
      if (particle_stages().contains(stage)) by_particles += s;
      if (stage.starts_with("caustics")) by_light += s;
      if (is_fixed(stage)) fixed += s;
    }
    mean.a_particle += 0.5 * by_particles / few;
    mean.a_pixel += 0.5 * std::max(total - by_particles - by_light - fixed, 0.0) /
                    (static_cast<double>(small.width) * small.height);
    mean.fixed += 0.5 * (fixed + by_light * light_scale(picture));
  }
  mean.write_a_pixel = format == PictureFormat::exr ? kExr : format == PictureFormat::mp4 ? kFilm : kPng;
  return mean;
}

}  // namespace meniscus
