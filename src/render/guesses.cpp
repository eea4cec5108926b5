#include <fmt/format.h>

#include "meniscus/render.h"
#include "render/guessed.h"

namespace meniscus {
namespace {

std::string metres(float length) { return fmt::format("{:.4g} m", length); }
std::string point(vec3 p) { return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", p.x, p.y, p.z); }

Guess camera_guess(const Survey& survey, const PictureOptions& options) {
  if (options.path)
    return {"camera", fmt::format("a path of {} keys", options.path->keys().size()), "given", "--camera FILE.json"};
  const View view = view_of(survey, options, 0, 1, 25);
  return {"camera", fmt::format("eye {}", point(view.eye)),
          options.camera.eye ? "given"
                             : "from above and off the longer side, as near as the water of the whole sequence allows",
          "--azimuth, --elevation, --distance, --eye, --target, --fov, --orthographic, --camera"};
}

}  // namespace

std::vector<Guess> guesses_of(const Survey& survey, const PictureOptions& options) {
  const float spacing = spacing_of(survey, options);
  const bool spacing_given = options.surface.spacing > 0;
  std::vector<Guess> guesses;
  guesses.push_back(
      {"particle spacing", metres(spacing), spacing_given ? "given" : survey.spacing.reasoning, "--spacing METRES"});
  guesses.push_back({"particle radius", metres(spacing / 2), "half the spacing", "--spacing METRES"});
  const float smoothing = options.surface.smoothing_length;
  guesses.push_back({"smoothing length", metres(smoothing > 0 ? smoothing : 2 * spacing),
                     smoothing > 0 ? "given" : "twice the spacing", "--smoothing-length METRES"});
  guesses.push_back({"up axis", std::string(name_of(survey.up.axis)), survey.up.reasoning, "--up x|y|z"});
  guesses.push_back({"ground", metres(ground_height(survey, options)),
                     options.ground_height ? "given"
                     : survey.most_particles < kFewParticles
                         ? "just under the lowest drop"
                         : "a quarter of a spacing above the lowest particles of the sequence",
                     "--ground-height METRES"});
  guesses.push_back(camera_guess(survey, options));
  const vec2 sun = sun_deg(survey, options);
  guesses.push_back({"sun", fmt::format("azimuth {:.4g}, elevation {:.4g} degrees", sun.x, sun.y),
                     options.sun_deg ? "given" : "behind the water, to the right of the camera",
                     "--sun AZIMUTH,ELEVATION"});
  guesses.push_back({"depth of tint", metres(depth_scale(survey, options)),
                     "the shortest edge of the water's bounds, ten spacings at least", "--extinction, --tint"});
  guesses.push_back({"material", material_name(options),
                     !options.material.empty() ? "given"
                     : options.colour          ? "opaque, so that colours are seen as they are"
                                               : "what most simulations are of",
                     "--material NAME"});
  if (options.colour && survey.colour_range)
    guesses.push_back(
        {"colour range", fmt::format("{:.4g} : {:.4g}", survey.colour_range->first, survey.colour_range->second),
         options.colour->range ? "given" : fmt::format("smallest and largest value over {} frames", survey.frames_read),
         "--range LOW:HIGH"});
  return guesses;
}

}  // namespace meniscus
