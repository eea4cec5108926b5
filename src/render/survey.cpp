#include <fmt/format.h>

#include <algorithm>

#include "meniscus/render.h"
#include "render/frame_sizes.h"

namespace meniscus {
namespace {

/// A spacing estimated from fewer particles gives way to one from ten times as many.
constexpr std::size_t kEnoughToTell = 1000;

/// Collects a survey frame by frame.
class Surveyor {
 public:
  explicit Surveyor(const SurveyOptions& options) : options_(options) {}

  void add(const Particles& particles) {
    ++survey_.frames_read;
    survey_.most_particles = std::max(survey_.most_particles, particles.size());
    if (particles.empty()) return;
    if (spacing_from_ == 0) {
      survey_.up = options_.up ? UpEstimate{*options_.up, "given"} : estimate_up(particles);
      for (const Attribute& attribute : particles.attributes) survey_.attributes.push_back(attribute.name);
      if (options_.sizes.empty())
        if (const std::optional<std::string> note = note_on_radii(particles)) survey_.notes.push_back(*note);
    }
    if (spacing_from_ == 0 || (spacing_from_ < kEnoughToTell && particles.size() >= 10 * spacing_from_)) {
      survey_.spacing = options_.spacing ? SpacingEstimate{*options_.spacing, 3, "given"} : estimate_spacing(particles);
      spacing_from_ = particles.size();
    }
    survey_.bounds.add(robust_bounds(particles));
    if (options_.colour) add_colour_range(particles);
  }

  Survey finish(std::size_t frames) {
    survey_.frames = frames;
    if (options_.spacing) survey_.spacing = {*options_.spacing, 3, "given"};
    if (spacing_from_ == 0) survey_.up = options_.up ? UpEstimate{*options_.up, "given"} : UpEstimate{};
    if (const glm::dvec3 from = survey_.origin.value_or(glm::dvec3{0.0}); from != glm::dvec3{0.0})
      survey_.notes.push_back(fmt::format(
          "positions, cameras and bodies are counted from ({:.15g}, {:.15g}, {:.15g}) m", from.x, from.y, from.z));
    if (survey_.frames_read + survey_.unreadable.size() < frames)
      survey_.notes.push_back(fmt::format("camera, ground and colours are fitted to {} of {} frames, evenly spread",
                                          survey_.frames_read, frames));
    return std::move(survey_);
  }

  Survey& survey() { return survey_; }

 private:
  void add_colour_range(const Particles& particles) {
    if (options_.colour->range) {
      survey_.colour_range = options_.colour->range;
      return;
    }
    // The first frame must have the attribute; another may lack it, and is drawn without when its turn comes.
    if (survey_.colour_range && !particles.find(options_.colour->attribute)) return;
    std::pair<float, float> range{};
    static_cast<void>(particle_colours(particles, *options_.colour, range));
    if (survey_.colour_range) {
      range.first = std::min(range.first, survey_.colour_range->first);
      range.second = std::max(range.second, survey_.colour_range->second);
    }
    survey_.colour_range = range;
  }

  const SurveyOptions& options_;
  Survey survey_;
  std::size_t spacing_from_ = 0;  ///< particles of the frame that the spacing is from
};

/// What is known of frames that are not to be made beforehand.
Survey survey_of(const Foreseen& foreseen, std::size_t frames, const SurveyOptions& options) {
  Survey survey;
  survey.frames = frames;
  survey.most_particles = foreseen.particles;
  survey.bounds = foreseen.bounds;
  survey.spacing = {foreseen.spacing, 3, foreseen.reasoning};
  if (options.spacing) survey.spacing = {*options.spacing, 3, "given"};
  survey.up = options.up ? UpEstimate{*options.up, "given"} : UpEstimate{foreseen.up, foreseen.reasoning};
  survey.attributes = foreseen.attributes;
  if (!options.colour) return survey;
  survey.colour_range = options.colour->range;
  if (!survey.colour_range && options.colour->attribute == "velocity") {
    survey.colour_range = {0.0f, foreseen.fastest};
    survey.notes.push_back(
        fmt::format("the colours of velocity end at {:.3g} m/s: a range may be given", foreseen.fastest));
  }
  return survey;
}

}  // namespace

Survey survey_frames(const FrameSequence& sequence, const SurveyOptions& options,
                     FunctionRef<void(std::size_t, std::size_t)>* on_frame) {
  const std::size_t count = sequence.frames.size();
  if (sequence.foreseen) return survey_of(*sequence.foreseen, count, options);
  Surveyor surveyor(options);
  FrameSequence same_origin = sequence;
  const std::size_t looked_at = std::min(count, static_cast<std::size_t>(std::max(options.most_frames, 1)));
  std::exception_ptr first_error;
  for (std::size_t i = 0; i < looked_at; ++i) {
    // Evenly, with the first and the last among them.
    const std::size_t frame = looked_at > 1 ? i * (count - 1) / (looked_at - 1) : 0;
    std::shared_ptr<const Particles> particles;
    try {
      particles = std::make_shared<Particles>(read_frame(same_origin, sequence.frames[frame]));
    } catch (const Error& error) {
      if (options.strict || count == 1) throw;
      surveyor.survey().unreadable.emplace_back(error.what());
      if (!first_error) first_error = std::current_exception();
    }
    if (particles) {
      surveyor.add(*particles);
      if (!same_origin.reading.origin && !particles->empty()) same_origin.reading.origin = particles->origin;
      surveyor.survey().origin = same_origin.reading.origin;
      if (count == 1) surveyor.survey().only_frame = particles;
    }
    if (on_frame) (*on_frame)(i + 1, looked_at);
  }
  if (surveyor.survey().frames_read == 0 && first_error) std::rethrow_exception(first_error);
  return surveyor.finish(count);
}

Survey survey_particles(const Particles& particles, const SurveyOptions& options) {
  Surveyor surveyor(options);
  surveyor.add(particles);
  return surveyor.finish(1);
}

}  // namespace meniscus
