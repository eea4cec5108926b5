#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <iostream>
#include <memory>

#include "bench_crown.h"
#include "bench_options.h"
#include "commands.h"
#include "json.h"
#include "meniscus/render.h"
#include "render/antialias.h"

namespace meniscus::apps {
namespace {

constexpr float kOrbitDeg = 0.2f;    ///< a frame
constexpr float kFlow = 0.0025f;     ///< m a frame, at most
constexpr float kFlowPeriod = 0.8f;  ///< m from eddy to eddy

struct TemporalArguments {
  std::size_t particles = 1'000'000;
  std::vector<float> px_per_spacing;
  int frames = 6;
  int rays = 8;
  int threads = 0;
  bool json = false;
};

/// The camera of the crown, turned about its axis.
View turned_view(int size, float degrees) {
  View view = crown_view(size, size);
  const float angle = degrees * 0.01745329252f, c = std::cos(angle), s = std::sin(angle);
  const auto turned = [&](vec3 v) { return vec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x); };
  view.eye = turned(view.eye);
  view.right = turned(view.right);
  view.up = turned(view.up);
  view.forward = turned(view.forward);
  return view;
}

/// The crown after some frames of a flow of three crossed shears: each component depends on the other two coordinates
/// only, so that nothing is compressed.
Particles flowed(const Particles& crown, float frames) {
  Particles moved = crown;
  constexpr float k = 6.2831853f / kFlowPeriod,
                  far = kFlow / 3.4641016f;  // 2 sqrt(3): the most that they can add up to
  parallel_for(crown.size(), 65536, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const vec3 p = crown.position(i);
      moved.x[i] += frames * far * (std::sin(k * p.z) + std::cos(k * p.y));
      moved.y[i] += frames * far * (std::sin(k * p.x) + std::cos(k * p.z));
      moved.z[i] += frames * far * (std::sin(k * p.y) + std::cos(k * p.x));
    }
  });
  return moved;
}

/// What a screen would show, 0 to 1, in steps that look alike: without rounding.
Image<vec3> displayed(const Image<vec3>& radiance) {
  Image<vec3> shown(radiance.width(), radiance.height());
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    const vec3 linear = tone_mapped(radiance[i], {});
    shown[i] = {srgb_from_linear(linear.x), srgb_from_linear(linear.y), srgb_from_linear(linear.z)};
  }
  return shown;
}

/// Means over squares of n x n pixels, of radiance: what a sensor sees.
Image<vec3> mean_of_squares(const Image<vec3>& radiance, int n) {
  Image<vec3> mean(radiance.width() / n, radiance.height() / n);
  const auto inverse = 1.0f / static_cast<float>(n * n);
  for (int y = 0; y < n * mean.height(); ++y)
    for (int x = 0; x < n * mean.width(); ++x) mean(x / n, y / n) += inverse * radiance(x, y);
  return mean;
}

double sum_of_squares(const Image<vec3>& a) {
  double sum = 0;
  for (const vec3& v : a) sum += glm::dot(v, v);
  return sum;
}

Image<vec3> difference(const Image<vec3>& a, const Image<vec3>& b) {
  Image<vec3> result(a.width(), a.height());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

/// What the frames of one motion add up to.
class Frames {
 public:
  void add(Image<vec3> picture, const Image<vec3>& truth) {
    Image<vec3> error = difference(picture, truth);
    error_ += sum_of_squares(error);
    if (count_++ > 0) {
      change_ += sum_of_squares(difference(picture, picture_before_));
      error_change_ += sum_of_squares(difference(error, error_before_));
    }
    values_ = 3.0 * static_cast<double>(picture.size());
    picture_before_ = std::move(picture);
    error_before_ = std::move(error);
  }

  double change() const { return std::sqrt(change_ / (values_ * (count_ - 1))); }
  double error() const { return std::sqrt(error_ / (values_ * count_)); }
  double error_change() const { return std::sqrt(error_change_ / (values_ * (count_ - 1))); }

 private:
  int count_ = 0;
  double values_ = 0, change_ = 0, error_ = 0, error_change_ = 0;
  Image<vec3> picture_before_, error_before_;
};

/// The picture with its outlines drawn by many rays, as render draws them unless it is told not to.
Image<vec3> with_outlines(const CrownLook& look, const Surface& surface, const View& view, SurfaceBuffers water,
                          Image<vec3> radiance) {
  OpticsInputs optics;
  optics.options.refraction = RefractionMethod::thickness;
  const std::vector<std::uint32_t> pixels =
      with_wide_pixels(silhouette_pixels(view, water, look.scene(), surface.spacing()), surface, view, water);
  refine_pixels(surface, view, look.scene(), look.material(), optics, pixels, water, radiance);
  return radiance;
}

/// A few frames of one motion, drawn by one ray a pixel, with outlines, and by many rays a pixel.
Json row_of(const Particles& crown, const TemporalArguments& arguments, bool orbit, float px_per_spacing) {
  const CrownLook look;
  const RaycastOptions options = crown_options(crown);
  // The picture's size at which a spacing is so many pixels, at the crown.
  const View probe = crown_view(1024, 1024);
  const float height = 1024 * probe.pixel_size(probe.project({0, 0.38f, 0}).z);
  const int size = std::max(8, static_cast<int>(std::lround(px_per_spacing * height / options.spacing)));
  std::unique_ptr<Surface> surface;
  if (orbit) surface = make_raycast_surface(crown, options);
  Frames plain, outlined, truths;
  for (int frame = 0; frame < arguments.frames; ++frame) {
    if (!orbit) surface = make_raycast_surface(flowed(crown, static_cast<float>(frame)), options);
    const View view = turned_view(size, orbit ? kOrbitDeg * static_cast<float>(frame) : 0);
    const View fine = view.resized(arguments.rays * size, arguments.rays * size);
    const Image<vec3> truth = displayed(mean_of_squares(look.shaded(fine, surface->see(fine)), arguments.rays));
    SurfaceBuffers water = surface->see(view);
    Image<vec3> radiance = look.shaded(view, water);
    plain.add(displayed(radiance), truth);
    outlined.add(displayed(with_outlines(look, *surface, view, std::move(water), std::move(radiance))), truth);
    truths.add(truth, truth);
  }
  return {{"motion", orbit ? "orbit" : "flow"},
          {"px_per_spacing", json_of(px_per_spacing)},
          {"size", size},
          {"change_rms", plain.change()},
          {"truth_change_rms", truths.change()},
          {"ratio", plain.change() / truths.change()},
          {"error_rms", plain.error()},
          {"error_change_rms", plain.error_change()},
          {"outlined_change_rms", outlined.change()},
          {"outlined_ratio", outlined.change() / truths.change()},
          {"outlined_error_rms", outlined.error()},
          {"outlined_error_change_rms", outlined.error_change()}};
}

Json measure(const TemporalArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  const Particles crown = synthetic_crown(arguments.particles);
  std::vector<float> wanted = arguments.px_per_spacing;
  if (wanted.empty()) wanted = {0.5f, 1, 2};
  Json rows = Json::array();
  for (const bool orbit : {true, false})
    for (const float px : wanted) rows.push_back(row_of(crown, arguments, orbit, px));
  return {{"scene", "crown"},
          {"particles", crown.size()},
          {"frames", arguments.frames},
          {"rays_a_pixel", arguments.rays * arguments.rays},
          {"orbit_deg_a_frame", json_of(kOrbitDeg)},
          {"flow_m_a_frame", json_of(kFlow)},
          {"rows", std::move(rows)}};
}

void print(const Json& json) {
  std::cout << fmt::format("{} particles, {} frames; against {} rays a pixel; in shares of white\n",
                           json["particles"].get<std::size_t>(), json["frames"].get<int>(),
                           json["rays_a_pixel"].get<int>());
  std::cout << fmt::format("{:<8}{:>12}{:>8} |{:^26}|{:^26}\n", "", "", "truth", "one ray a pixel", "with outlines");
  std::cout << fmt::format("{:<8}{:>12}{:>8} |{:>8}{:>9}{:>9}|{:>8}{:>9}{:>9}\n", "motion", "px a spacing", "change",
                           "ratio", "error", "changes", "ratio", "error", "changes");
  for (const Json& row : json["rows"]) {
    const auto value = [&](const char* key) { return row[key].get<double>(); };
    std::cout << fmt::format("{:<8}{:>12.2f}{:>8.4f} |{:>8.2f}{:>9.4f}{:>9.4f}|{:>8.2f}{:>9.4f}{:>9.4f}\n",
                             row["motion"].get<std::string>(), value("px_per_spacing"), value("truth_change_rms"),
                             value("ratio"), value("error_rms"), value("error_change_rms"), value("outlined_ratio"),
                             value("outlined_error_rms"), value("outlined_error_change_rms"));
  }
}

}  // namespace

void add_bench_temporal(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("temporal", "Shimmer of a moving crown against many rays a pixel");
  const auto arguments = std::make_shared<TemporalArguments>();
  add_particles(*command, arguments->particles, 1000, 200'000'000, "Particles of the crown (default: 1000000)");
  command
      ->add_option("--px-per-spacing", arguments->px_per_spacing,
                   "Pixels that a spacing takes at the crown, with commas (default: 0.5,1,2)")
      ->type_name("PX,...")
      ->delimiter(',')
      ->check(CLI::Range(0.05, 32.0).description(""));
  command->add_option("--frames", arguments->frames, "Frames of each motion (default: 6)")
      ->type_name("N")
      ->check(CLI::Range(2, 1000).description(""));
  command->add_option("--rays", arguments->rays, "Rays along the edge of a pixel of the truth (default: 8)")
      ->type_name("N")
      ->check(CLI::Range(1, 32).description(""));
  add_threads(*command, arguments->threads);
  add_json(*command, arguments->json);
  command->footer(
      "orbit: the camera turns by 0.2 degrees a frame; flow: the water moves by up to 2.5 mm a frame. The pictures "
      "are\n"
      "so small that a spacing takes the pixels asked for. change_rms is the change from frame to frame,\n"
      "truth_change_rms that of pictures of many rays a pixel, averaged after shading; what ratio is above 1 is\n"
      "shimmer. error_rms is the difference to the truth, error_change_rms its change from frame to frame. The same\n"
      "with outlined_ before: of pictures whose outlines are drawn by up to 16 rays a pixel, as render draws them\n"
      "unless --antialias off. All are root mean squares over the values of the developed pictures, 0 to 1, not\n"
      "rounded.");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
