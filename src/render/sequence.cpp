#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>

#include "meniscus/render.h"
#include "render/body_placement.h"
#include "render/foam_frames.h"
#include "render/frame_memory.h"
#include "render/rainy_frame.h"
#include "render/read_ahead.h"

namespace meniscus {
namespace {

/// The pictures of a sequence: which frame each shows and the number in its name.
struct Shot {
  FramePath frame;
  std::int64_t number = 0;
  std::size_t place = 0;  ///< which of a body's transforms is meant
};

bool numbered_by_name(const FrameSequence& sequence) {
  std::set<std::int64_t> numbers;
  for (const FramePath& frame : sequence.frames)
    if (frame.number) numbers.insert(*frame.number);
  return numbers.size() == sequence.frames.size();
}

std::vector<Shot> shots_of(const FrameSequence& sequence, std::size_t turntable) {
  std::vector<Shot> shots;
  if (sequence.frames.size() == 1 && turntable > 0) {
    for (std::size_t i = 0; i < turntable; ++i)
      shots.push_back({sequence.frames.front(), static_cast<std::int64_t>(i), i});
    return shots;
  }
  const std::vector<std::int64_t> numbers = picture_numbers(sequence);
  for (const FramePath& frame : sequence.frames)
    shots.push_back({frame, numbers[shots.size()], frame.place.value_or(shots.size())});
  return shots;
}

void check_name(const OutputTarget& target, std::size_t pictures) {
  if (pictures > 1 && !target.is_pattern() && !target.is_film())
    throw Error(ErrorCode::invalid_argument, {fmt::format("{} pictures do not fit into one file", pictures),
                                              "a pattern or a film",
                                              {},
                                              target.path(),
                                              {},
                                              {},
                                              "write to a name with {} for the frame number, or to an .mp4"});
}

void check(const OutputTarget& target, std::size_t pictures) {
  check_name(target, pictures);
  target.prepare();
}

/// Draws shot after shot; holds what lasts from one to the next.
class SequenceRun {
 public:
  SequenceRun(const FrameSequence& sequence, const Survey& survey, const PictureOptions& picture,
              const SequenceOptions& options)
      : sequence_(sequence), survey_(survey), picture_(picture), options_(options), target_(options.output) {
    sequence_.reading.origin = survey.origin;
  }

  SequenceReport run(std::vector<Shot> shots,
                     FunctionRef<void(const FrameReport&, std::size_t, std::size_t)>* on_frame) {
    check(target_, options_.further ? std::max<std::size_t>(shots.size(), 2) : shots.size());
    if (target_.is_film() && finished(target_.path())) return all_skipped(shots, on_frame);
    leave_out_ground();
    bodies_.emplace(picture_.bodies);
    check_bodies(shots);
    settings_ = settings_of(survey_, picture_);
    settings_->heights = picture_.heights;
    SequenceReport report;
    for (std::size_t i = 0; i < shots.size() || add_further(shots); ++i) {
      const std::optional<FramePath> next = next_to_read(shots, i);
      report.frames.push_back(one(shots[i], i, shots.size(), next ? &*next : nullptr));
      const FrameReport& frame = report.frames.back();
      report.times.add(frame.times);
      ++(frame.skipped ? report.skipped : frame.problem.empty() ? report.drawn : report.failed);
      if (on_frame) (*on_frame)(frame, i, shots.size());
    }
    if (report.drawn + report.skipped == 0 && first_error_) std::rethrow_exception(first_error_);
    if (film_) film_->finish();
    return report;
  }

 private:
  /// A body that is the rain's ground is drawn as that.
  void leave_out_ground() {
    if (!picture_.rain || !picture_.rain->ground.there || picture_.rain->ground.mesh.empty()) return;
    for (BodyOptions& body : picture_.bodies)
      if (body.name == picture_.rain->ground.mesh) body.absent = {true};
  }

  /// Where the bodies of the first frame are, and that there are any at all.
  void check_bodies(const std::vector<Shot>& shots) {
    std::size_t most = 0;
    std::vector<std::string> missing;
    for (std::size_t i = 0; i < shots.size() && most < picture_.bodies.size(); ++i) {
      std::vector<std::string> notes;
      const std::vector<PlacedSolid> placed = bodies_->at(shots[i].place, shots[i].number, notes);
      if (i == 0) {
        for (const PlacedSolid& body : placed) picture_.bodies_bounds.add(bounds_of(body));
        missing = notes;
      }
      most = std::max(most, picture_.bodies.size() - notes.size());
      if (bodies_->still()) break;
    }
    if (most < picture_.bodies.size())
      throw Error(ErrorCode::not_found, {"a body has no file in any frame",
                                         {},
                                         missing.empty() ? std::string{} : missing.front(),
                                         {},
                                         {},
                                         {},
                                         "check the pattern: {} stands for the number in the frame's name"});
  }

  /// Waits for frames that come later, if there are to be any.
  bool add_further(std::vector<Shot>& shots) const {
    if (!options_.further) return false;
    const bool by_name = numbered_by_name(sequence_);
    const std::size_t before = shots.size();
    for (FramePath& frame : options_.further()) {
      const auto place = static_cast<std::int64_t>(shots.size());
      const std::int64_t number = by_name ? frame.number.value_or(place) : place;
      const std::size_t in_sequence = frame.place.value_or(shots.size());
      shots.push_back({std::move(frame), number, in_sequence});
    }
    return shots.size() > before;
  }

  /// The frame that will be read after the i-th; none where it is the same or there is none.
  std::optional<FramePath> next_to_read(const std::vector<Shot>& shots, std::size_t i) const {
    // With a limit to the memory two frames at once may be one too many.
    if (survey_.only_frame || picture_.memory_limit > 0) return std::nullopt;
    for (++i; i < shots.size(); ++i)
      if (target_.is_film() || picture_.rain || !finished(target_.path_of(shots[i].number))) return shots[i].frame;
    return std::nullopt;
  }

  bool finished(const std::string& path) const { return options_.resume && std::filesystem::exists(path); }

  SequenceReport all_skipped(const std::vector<Shot>& shots,
                             FunctionRef<void(const FrameReport&, std::size_t, std::size_t)>* on_frame) const {
    SequenceReport report;
    for (const Shot& shot : shots) {
      FrameReport frame;
      frame.path = shot.frame.path;
      frame.output = target_.path();
      frame.skipped = true;
      report.frames.push_back(std::move(frame));
      if (on_frame) (*on_frame)(report.frames.back(), report.frames.size() - 1, shots.size());
    }
    report.skipped = shots.size();
    return report;
  }

  /// @param next  what is read while this is drawn; may be null
  FrameReport one(const Shot& shot, std::size_t index, std::size_t count, const FramePath* next) {
    const auto start = std::chrono::steady_clock::now();
    FrameReport report;
    report.path = shot.frame.path;
    report.output = target_.path_of(shot.number);
    const bool there = !target_.is_film() && finished(report.output);
    if (there) {
      report.skipped = true;
      if (!settings_->rain) return report;
    }
    try {
      if (there)
        rain_through(*frame_of(shot, index, count, next, report), *settings_);
      else
        draw(shot, index, count, next, report);
    } catch (const Error& error) {
      // A picture that cannot be written will not be followed by one that can, nor is a setting better for the next.
      const bool too_much = picture_.memory_limit > 0 && error.code() == ErrorCode::limit_exceeded;
      if (options_.strict || writing_ || (count == 1 && !options_.further) || too_much ||
          error.code() == ErrorCode::invalid_argument)
        throw;
      if (there) return report;
      if (!first_error_) first_error_ = std::current_exception();
      report.problem = error.what();
      if (film_) film_->add(last_picture_);
    }
    report.frame_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return report;
  }

  /// The particles of a shot; the settings become those of its picture.
  std::shared_ptr<const Particles> frame_of(const Shot& shot, std::size_t index, std::size_t count,
                                            const FramePath* next, FrameReport& report) {
    std::shared_ptr<const Particles> particles = options_.further ? nullptr : survey_.only_frame;
    if (!particles) {
      const StageTimer timer(&report.times, sequence_.body_transforms ? "simulate" : "read");
      particles = read(shot.frame);
    }
    if (next) ahead_.begin(*next);
    if (particles->dropped_non_finite > 0)
      report.notes.push_back(
          fmt::format("{} particles with NaN or infinite positions are left out", particles->dropped_non_finite));
    report.notes.insert(report.notes.end(), particles->notes.begin(), particles->notes.end());
    // A camera's path belongs to the whole sequence, as the water does: a part of it is seen from where that part is.
    const std::size_t along = picture_.path && options_.turntable == 0 ? shot.frame.place.value_or(index) : index;
    settings_->view = view_of(survey_, picture_, along, count, options_.video.frames_per_second);
    // Made frames know their time; files may count theirs from anywhere.
    const double in_film = static_cast<double>(shot.place) / options_.video.frames_per_second;
    settings_->time = sequence_.foreseen ? particles->time.value_or(in_film) : in_film;
    if (target_.format() == PictureFormat::ply) return particles;
    if (!picture_.foam.files.empty()) {
      const StageTimer timer(&report.times, "read");
      const std::size_t before = report.notes.size();
      settings_->foam =
          foam_of_frame(picture_.foam, shot.frame.number.value_or(shot.number), sequence_.reading, report.notes);
      if (options_.strict && report.notes.size() > before) throw Error(ErrorCode::not_found, report.notes.back());
    }
    std::vector<std::optional<glm::mat4>> moved;
    if (sequence_.body_transforms) moved = sequence_.body_transforms();
    const std::size_t notes = report.notes.size();
    settings_->solids = bodies_->at(shot.place, shot.number, report.notes, moved);
    if (options_.strict && report.notes.size() > notes) throw Error(ErrorCode::not_found, report.notes.back());
    return particles;
  }

  /// A frame that is still being written is read again until it is whole or grows no more.
  std::shared_ptr<const Particles> read(const FramePath& frame) {
    while (true) {
      try {
        return ahead_.take(frame);
      } catch (const Error& error) {
        if (error.code() != ErrorCode::malformed_file || !options_.read_again || !options_.read_again(frame)) throw;
      }
    }
  }

  void draw(const Shot& shot, std::size_t index, std::size_t count, const FramePath* next, FrameReport& report) {
    std::shared_ptr<const Particles> particles = frame_of(shot, index, count, next, report);
    if (target_.format() == PictureFormat::ply) {
      write_surfels(report, *particles);
      return;
    }
    keep_to_limit(report, *particles);
    FramePicture frame = render_frame(*particles, *settings_);
    particles.reset();
    report.particles = frame.particles;
    if (frame.far_away > 0)
      report.notes.push_back(
          fmt::format("{} particles left out: they are too far away from the others", frame.far_away));
    report.width = frame.picture.width();
    report.height = frame.picture.height();
    report.times.add(frame.times);
    const StageTimer timer(&report.times, "write");
    writing_ = true;
    write(report.output, frame);
    writing_ = false;
  }

  /// What of the memory that may be used is left for the surface, now that the particles are there.
  void keep_to_limit(const FrameReport& report, const Particles& particles) {
    const std::uint64_t limit = picture_.memory_limit;
    if (limit == 0) return;
    const std::uint64_t held = resident_bytes() + picture_bytes(picture_, target_.format());
    settings_->surface_memory = limit > held ? limit - held : 1;
    const float spacing = settings_->surface.spacing;
    if (slabs_for(settings_->surface_memory, particles.size(), particles.bounds(), spacing, picture_) > 0) return;
    const std::uint64_t resident = held - picture_bytes(picture_, target_.format());
    throw does_not_fit(picture_, limit, report.path, "the frame does not fit into the memory that may be used",
                       [&](const PictureOptions& other) {
                         return resident + picture_bytes(other, target_.format()) +
                                least_surface_bytes(particles.size(), particles.bounds(), spacing, other);
                       });
  }

  void write_surfels(FrameReport& report, const Particles& particles) {
    const std::vector<Surfel> surfels = surfels_of(particles, *settings_, &report.times);
    report.particles = particles.size();
    const StageTimer timer(&report.times, "write");
    std::vector<vec3> positions, normals;
    std::vector<float> radii;
    for (const Surfel& surfel : surfels) {
      positions.push_back(surfel.position);
      normals.push_back(surfel.normal);
      radii.push_back(surfel.radius);
    }
    writing_ = true;
    write_point_ply(report.output, positions, normals, radii);
    writing_ = false;
  }

  void write(const std::string& path, FramePicture& frame) {
    switch (target_.format()) {
      case PictureFormat::png:
        write_png(path, frame.picture);
        break;
      case PictureFormat::exr:
        write_layers(path, frame, settings_->view, options_.layers);
        break;
      case PictureFormat::mp4:
        if (!film_) film_.emplace(path, frame.picture.width(), frame.picture.height(), options_.video);
        film_->add(frame.picture);
        last_picture_ = std::move(frame.picture);
        break;
      case PictureFormat::ply:
        break;  // holds no picture
    }
  }

  FrameSequence sequence_;
  const Survey& survey_;
  PictureOptions picture_;
  const SequenceOptions& options_;
  OutputTarget target_;
  ReadAhead ahead_{sequence_};
  std::optional<FrameSettings> settings_;
  std::optional<Bodies> bodies_;
  std::optional<VideoWriter> film_;
  Image<Rgb8> last_picture_;
  std::exception_ptr first_error_;
  bool writing_ = false;
};

}  // namespace

std::vector<std::int64_t> picture_numbers(const FrameSequence& sequence) {
  const bool by_name = numbered_by_name(sequence);
  std::vector<std::int64_t> numbers;
  for (const FramePath& frame : sequence.frames)
    numbers.push_back(by_name ? *frame.number : static_cast<std::int64_t>(numbers.size()));
  return numbers;
}

void check_output(const FrameSequence& sequence, const SequenceOptions& options) {
  check(OutputTarget(options.output), shots_of(sequence, options.turntable).size());
}

void check_output_name(const FrameSequence& sequence, const SequenceOptions& options) {
  check_name(OutputTarget(options.output), shots_of(sequence, options.turntable).size());
}

SequenceReport render_sequence(const FrameSequence& sequence, const Survey& survey, const PictureOptions& picture,
                               const SequenceOptions& options,
                               FunctionRef<void(const FrameReport&, std::size_t, std::size_t)>* on_frame) {
  return SequenceRun(sequence, survey, picture, options).run(shots_of(sequence, options.turntable), on_frame);
}

SequenceReport render_files(std::span<const std::string> what, const std::string& output,
                            const PictureOptions& picture) {
  SequenceOptions options;
  options.output = output;
  const FrameSequence sequence = find_frames(what);
  SurveyOptions wanted;
  wanted.colour = picture.colour;
  if (picture.surface.spacing > 0) wanted.spacing = picture.surface.spacing;
  return render_sequence(sequence, survey_frames(sequence, wanted), picture, options);
}

}  // namespace meniscus
