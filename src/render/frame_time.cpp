#include "render/frame_time.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

namespace meniscus {
namespace {

constexpr double kPixels = 16000;                ///< of the small picture
constexpr double kFewest = 3000, kMost = 40000;  ///< particles in it
// Seconds a pixel of encoding, on a machine that draws as fast as the one of docs/performance.md.
constexpr double kPng = 60e-9, kFilm = 25e-9, kExr = 120e-9;

double seconds_of(const std::chrono::steady_clock::time_point& start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Stages that grow with the particles, and those that do not grow with the frame; all others grow with its pixels.
const std::set<std::string>& particle_stages() {
  static const std::set<std::string> stages{"sort",    "masses",     "colours",       "particles", "columns", "smooth",
                                            "surface", "neighbours", "splat density", "surfels",   "walls"};
  return stages;
}
bool is_fixed(const std::string& stage) {
  return stage.starts_with("caustics") || stage == "shadow" || stage == "scene" || stage == "virtual eyes" ||
         stage == "eyes" || stage == "surroundings" || stage == "reference";
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
  const Particles tank = synthetic_tank(static_cast<std::size_t>(few));
  const PictureOptions small = small_picture(picture, factor);
  FrameTime best;
  double best_total = 1e30;
  for (int run = 0; run < 2; ++run) {
    FrameTime time;
    const auto survey_start = std::chrono::steady_clock::now();
    const Survey survey = survey_particles(tank);
    // Beyond half a million particles the spacing is estimated from some of them: little more than finding a box.
    const double survey_s = seconds_of(survey_start);
    time.survey_a_particle = std::min(survey_s / few, 30e-9);
    FrameSettings settings = settings_of(survey, small);
    const auto start = std::chrono::steady_clock::now();
    const FramePicture frame = render_frame(tank, settings);
    const double total = seconds_of(start);
    double by_particles = 0, fixed = 0, told = 0;
    for (const auto& [stage, ms] : frame.times.rows()) {
      const double s = ms * 1e-3;
      told += s;
      if (particle_stages().contains(stage)) by_particles += s;
      if (is_fixed(stage)) fixed += s;
    }
    const double rest = std::max(told - by_particles - fixed, 0.0) + std::max(total - told, 0.0);
    time.a_particle = by_particles / few;
    time.a_pixel = rest / (static_cast<double>(small.width) * small.height);
    time.fixed = fixed;
    if (total < best_total) {
      best_total = total;
      best = time;
    }
  }
  best.write_a_pixel = format == PictureFormat::exr ? kExr : format == PictureFormat::mp4 ? kFilm : kPng;
  return best;
}

}  // namespace meniscus
