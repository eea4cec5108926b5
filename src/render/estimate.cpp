// What a run would take, from the frames' headers and sizes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "io/frame_head.h"
#include "render/frame_memory.h"
#include "render/frame_time.h"
#include "render/guessed.h"

namespace meniscus {
namespace {

constexpr std::size_t kMostHeads = 64;  ///< headers that are looked at, evenly spread, beside the largest file's
constexpr std::size_t kSurveyed = 64;   ///< frames that are read beforehand, as SurveyOptions::most_frames
constexpr double kBinaryRate = 0.4e9;   ///< bytes a second of binary files
constexpr double kTextRate = 90e6, kInflateRate = 150e6;
constexpr double kFindingBox = 50e-9;            ///< s a particle
constexpr std::uint64_t kLibraries = 11u << 20;  ///< what the program grows by when all of its parts have been used

/// What is known of the frames before they are read.
struct Frames {
  io::FrameHead largest;
  double mean_particles = 0;
  std::uint64_t files_bytes = 0;
  double reading_s = 0;  ///< of all frames, once
  bool counted = true;
  Bounds bounds;
  std::vector<std::string> notes;
};

double reading_seconds(const io::FrameHead& head) {
  const double rate = head.text ? kTextRate : head.plain_bytes != head.file_bytes ? kInflateRate : kBinaryRate;
  return static_cast<double>(head.plain_bytes) / rate;
}

std::uint64_t file_size(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return error ? 0 : size;
}

/// Of all files of a frame.
std::uint64_t file_size(const FramePath& frame) {
  std::uint64_t size = file_size(frame.path);
  for (const std::string& path : frame.further) size += file_size(path);
  return size;
}

Frames frames_in_files(const FrameSequence& sequence) {
  Frames frames;
  std::vector<std::uint64_t> sizes;
  for (const FramePath& frame : sequence.frames) sizes.push_back(file_size(frame));
  const auto biggest = static_cast<std::size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  const std::size_t count = sizes.size(), looked_at = std::min(count, kMostHeads);
  std::vector<std::size_t> places{biggest};
  for (std::size_t i = 0; i < looked_at; ++i) places.push_back(looked_at > 1 ? i * (count - 1) / (looked_at - 1) : 0);
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());

  double particles = 0, bytes = 0, seconds = 0;
  std::exception_ptr first_error;
  std::size_t failed = 0, understood = 0;
  for (const std::size_t place : places) {
    try {
      const io::FrameHead head = io::look_at_frame(sequence.frames[place], sequence.reading);
      ++understood;
      particles += static_cast<double>(head.particles);
      bytes += static_cast<double>(head.file_bytes);
      seconds += reading_seconds(head);
      frames.counted &= head.counted;
      if (head.reading_bytes() >= frames.largest.reading_bytes()) frames.largest = head;
    } catch (const Error&) {
      if (!first_error) first_error = std::current_exception();
      ++failed;
    }
  }
  if (understood == 0 && first_error) std::rethrow_exception(first_error);
  for (const std::uint64_t size : sizes) frames.files_bytes += size;
  // The frames whose headers were not looked at have as many particles a byte.
  const double all = bytes > 0 ? static_cast<double>(frames.files_bytes) / bytes : 0;
  frames.mean_particles = particles * all / static_cast<double>(count);
  frames.reading_s = seconds * all;
  if (failed > 0) frames.notes.push_back(fmt::format("{} of {} headers cannot be understood", failed, places.size()));
  if (places.size() < count) frames.counted = false;
  return frames;
}

Frames frames_of(const FrameSequence& sequence, std::uint64_t made_particles) {
  Frames frames;
  if (sequence.foreseen) {
    frames.largest.particles = sequence.foreseen->particles;
    frames.largest.values = 6;
    frames.largest.spacing = sequence.foreseen->spacing;
    frames.bounds = sequence.foreseen->bounds;
    frames.mean_particles = static_cast<double>(frames.largest.particles);
    if (sequence.body_transforms) frames.notes.emplace_back("the simulation's own time and memory are not in it");
    return frames;
  }
  if (!sequence.source) return frames_in_files(sequence);
  frames.largest.particles = made_particles;
  frames.largest.values = 6;
  frames.mean_particles = static_cast<double>(made_particles);
  frames.counted = false;
  return frames;
}

std::uint64_t output_bytes(const PictureOptions& picture, PictureFormat format, std::size_t pictures,
                           const SequenceOptions& options, const Frames& frames) {
  const double pixels = static_cast<double>(picture.width) * picture.height;
  double a_picture = 0;
  switch (format) {
    case PictureFormat::png:
      a_picture = 0.9 * pixels;
      break;
    case PictureFormat::exr:
      a_picture = 10 * pixels * (options.layers.empty() ? 1.0 : static_cast<double>(options.layers.size()) / 5);
      break;
    case PictureFormat::mp4:  // halved by six steps of the quality
      a_picture = 0.04 * pixels * std::exp2((18 - options.video.quality_crf) / 6.0);
      break;
    case PictureFormat::ply:
      a_picture = 28 * std::min(frames.mean_particles, 40 * std::pow(frames.mean_particles, 2.0 / 3));
      break;
  }
  return static_cast<std::uint64_t>(a_picture * static_cast<double>(pictures));
}

float spacing_or_one(const Frames& frames, const PictureOptions& picture) {
  if (picture.surface.spacing > 0) return picture.surface.spacing;
  return frames.bounds.empty() || !frames.largest.spacing ? 1.0f : *frames.largest.spacing;
}

/// The program itself. What it has grown by since it was asked first, by measuring times, is not counted twice.
std::uint64_t program_bytes() {
  static const std::uint64_t at_first = resident_bytes();
  return std::max(resident_bytes(), at_first + kLibraries);
}

/// Of the largest frame, without a surface.
RunMemory memory_without_surface(const Frames& frames, const PictureOptions& picture, PictureFormat format) {
  RunMemory memory;
  memory.program = program_bytes();
  memory.reading = frames.largest.reading_bytes();
  memory.particles = frames.largest.particle_bytes();
  if (picture.colour) memory.particles += 3 * sizeof(float) * frames.largest.particles;
  memory.picture = picture_bytes(picture, format);
  return memory;
}

std::uint64_t peak_with(const RunMemory& memory, std::uint64_t surface) {
  return memory.program + std::max(memory.reading, memory.particles + surface + memory.picture);
}

/// Memory of the largest frame, in slabs if that keeps it to the limit.
void estimate_memory(const Frames& frames, const PictureOptions& picture, PictureFormat format, RunEstimate& run) {
  RunMemory& memory = run.memory;
  const float spacing = spacing_or_one(frames, picture);
  memory = memory_without_surface(frames, picture, format);
  // A spacing that was given says nothing of the water's shape: it has the shape of a tank, of that spacing.
  const auto surface = [&](int slabs) { return surface_bytes(run.particles, frames.bounds, spacing, picture, slabs); };
  const auto total = [&](std::uint64_t made) { return peak_with(memory, made); };
  memory.surface = surface(1);
  if (picture.memory_limit > 0 && total(memory.surface) > picture.memory_limit) {
    // The surface is made when the file's bytes are gone.
    const std::uint64_t rest = memory.program + memory.particles + memory.picture;
    const int slabs = picture.memory_limit > std::max(rest, total(0))
                          ? slabs_for(picture.memory_limit - rest, run.particles, frames.bounds, spacing, picture)
                          : 0;
    if (slabs > 1) {
      run.slabs = slabs;
      memory.surface = surface(slabs);
    }
  }
  memory.peak = total(memory.surface);
}

void estimate_times(const Frames& frames, const PictureOptions& picture, PictureFormat format, bool one_frame,
                    RunEstimate& run) {
  const auto reads = static_cast<double>(std::min(run.pictures, kSurveyed));
  const auto pictures = static_cast<double>(run.pictures);
  const FrameTime time = measure_frame(picture, static_cast<std::uint64_t>(frames.mean_particles), format);
  const double pixels = static_cast<double>(picture.width) * picture.height;
  const double read = frames.reading_s / std::max(1.0, one_frame ? 1.0 : pictures);
  // Nearly nothing is done for particles in the midst of the water but counting them.
  const double n = frames.mean_particles, kept = std::min(n, 66 * std::pow(n, 2.0 / 3));
  const double made = time.a_particle * (kept + 0.12 * (n - kept));
  const double drawn =
      made * (run.slabs > 1 ? 1.3 : 1.0) + time.fixed + time.a_pixel * pixels + time.write_a_pixel * pixels;
  // The spacing is found from half a million particles at most; the box from all.
  const double looked_at = kFindingBox * n + time.survey_a_particle * std::min(n, 5e5);
  run.survey_s = one_frame ? read + looked_at : reads * (read + kFindingBox * n) + looked_at;
  run.frame_s = drawn + (one_frame ? 0 : read);
  run.total_s = run.survey_s + pictures * run.frame_s;
}

RunEstimate estimate_of(const Frames& frames, const FrameSequence& sequence, const PictureOptions& picture,
                        const SequenceOptions& options, bool with_times) {
  RunEstimate run;
  const PictureFormat format = OutputTarget(options.output).format();
  const bool one_frame = sequence.frames.size() == 1;
  run.pictures = one_frame && options.turntable > 0 ? options.turntable : sequence.frames.size();
  run.particles = frames.largest.particles;
  run.all_particles =
      static_cast<std::uint64_t>(std::llround(frames.mean_particles * static_cast<double>(sequence.frames.size())));
  run.counted = frames.counted;
  run.input_bytes = frames.files_bytes;
  run.output_bytes = output_bytes(picture, format, run.pictures, options, frames);
  run.notes = frames.notes;
  estimate_memory(frames, picture, format, run);
  if (with_times) estimate_times(frames, picture, format, one_frame, run);
  if (picture.rain) run.notes.emplace_back("rain and its ground are not in the times");
  if (!picture.bodies.empty()) run.notes.emplace_back("the reading of meshes is not in the times");
  return run;
}

}  // namespace

RunEstimate estimate_run(const FrameSequence& sequence, const PictureOptions& picture, const SequenceOptions& options,
                         std::uint64_t made_particles, bool with_times) {
  return estimate_of(frames_of(sequence, made_particles), sequence, picture, options, with_times);
}

void check_memory(const FrameSequence& sequence, const PictureOptions& picture, const SequenceOptions& options,
                  std::uint64_t made_particles) {
  const std::uint64_t limit = picture.memory_limit;
  if (limit == 0) return;
  if (!sequence.source && !sequence.foreseen)
    for (const FramePath& frame : sequence.frames)
      if (const std::uint64_t size = file_size(frame); size > limit)
        throw Error(ErrorCode::limit_exceeded, {"the frame's file is larger than the memory that may be used",
                                                fmt::format("no more than the limit of {}", size_text(limit)),
                                                size_text(size),
                                                frame.path,
                                                {},
                                                {},
                                                "raise --memory-limit, or use fewer particles a frame"});
  const Frames frames = frames_of(sequence, made_particles);
  const RunEstimate run = estimate_of(frames, sequence, picture, options, false);
  if (run.memory.peak <= limit) return;
  const PictureFormat format = OutputTarget(options.output).format();
  throw does_not_fit(picture, limit, {},
                     run.memory.program + run.memory.reading > limit
                         ? fmt::format("a frame of {} particles cannot be read within the limit", run.particles)
                         : "the run does not fit into the memory that may be used",
                     [&](const PictureOptions& other) {
                       return peak_with(
                           memory_without_surface(frames, other, format),
                           least_surface_bytes(run.particles, frames.bounds, spacing_or_one(frames, other), other));
                     });
}

}  // namespace meniscus
