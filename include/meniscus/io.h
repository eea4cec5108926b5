/// Particle frames on disk: one reader a format, and sequences of frames.
#pragma once

#include <functional>
#include <glm/mat4x4.hpp>

#include "meniscus/base.h"

namespace meniscus {

/// Reads one frame. The format is told from the content first and the file name second.
/// Particles with NaN or infinite positions are left out and counted. An empty frame is not an error.
/// @throws Error  not_found, malformed_file, unsupported, io_failed; the message names file and position
Particles read_particles(const std::string& path);

/// One frame of a sequence that has been found but not read.
struct FramePath {
  std::string path;
  std::optional<std::int64_t> number;  ///< the frame number in its name, if it has one
  std::optional<std::size_t> place;    ///< from 0, in the sequence that it was picked from; none: it was not picked
};

/// What is known of a sequence that stands in no files before any of its frames is made.
struct Foreseen {
  std::size_t particles = 0;  ///< of the first frame
  Bounds bounds;              ///< of the water in all frames, m
  float spacing = 0;          ///< m; between columns where there are no particles
  Axis up = Axis::y;
  float fastest = 0;                    ///< m/s, about: what a colour map of the velocity may end at
  std::vector<std::string> attributes;  ///< of the particles
  std::string reasoning;                ///< one line for the user: where all this is from
};

/// A sequence of frames in natural order (9 before 10).
struct FrameSequence {
  std::vector<FramePath> frames;
  std::vector<std::string> notes;  ///< missing numbers, files left out, and why
  /// Where the particles of a frame come from when they are not in a file: made up, or out of a simulation.
  std::function<Particles(const FramePath&)> source;
  /// Frames that are expensive to make are not looked at beforehand: this is what is known of them.
  std::optional<Foreseen> foreseen;
  /// Where the solid bodies are in the frame that `source` gave last, as BodyOptions::frames, one a body; those that
  /// are not there have none. Null: the bodies move by themselves.
  std::function<std::vector<std::optional<glm::mat4>>()> body_transforms;
};

/// The particles of one frame of a sequence.
/// @throws Error  what read_particles() or the sequence's source throws
Particles read_frame(const FrameSequence& sequence, const FramePath& frame);

/// Finds the frames that the arguments name: files, directories (every particle file in them), globs
/// (`*`, `?`, `[...]`), and patterns with `{}` for the frame number. Natural order within an argument.
/// A directory that holds several kinds of series (fluid and foam, say) gives the one that is most likely the
/// water, and a note on the others.
/// @throws Error  not_found: an argument that names nothing, a directory without frames
FrameSequence find_frames(std::span<const std::string> arguments);

}  // namespace meniscus
