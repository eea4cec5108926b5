/// Particle frames on disk: one reader a format, and sequences of frames.
#pragma once

#include <functional>
#include <glm/mat4x4.hpp>
#include <map>
#include <set>

#include "meniscus/base.h"

namespace meniscus {

/// Where the particles are in a file, which of them are wanted, and their units. The defaults suit what the known
/// simulators write.
struct ReadOptions {
  /// Path of the array of positions inside the file (HDF5, NPZ): one of N x 3 ("/PartType0/Coordinates"), or three
  /// separated by commas; empty: found by the usual names.
  std::string positions;
  /// Columns of x, y and z in text, by name or by number from 1; empty: found by the usual names, else the first three.
  std::vector<std::string> columns;
  /// A file without any header: type and number of values a particle, "f32x3", "f64x4" ...; the first three are the
  /// position. Empty: the file tells.
  std::string raw;
  /// Which particles are kept: "type==3", "density>=900"; several joined by "&&". Empty: the fluid, where the file
  /// tells it from boundaries.
  std::string where;
  bool boundaries = false;     ///< keep particles of boundaries, too
  double scale = 1;            ///< m that a unit of the file's lengths has
  bool allow_outside = false;  ///< files that name others may name some outside of their own directory
  /// What positions are counted from, m, after scaling. None: zero, unless they lie so far from it that floats would
  /// lose what the file knows; then a round number amidst them.
  std::optional<glm::dvec3> origin;
};

/// Reads one frame. The format is told from the content first and the file name second.
/// Particles with NaN or infinite positions are left out and counted. An empty frame is not an error.
/// @throws Error  not_found, malformed_file, unsupported, io_failed, limit_exceeded; invalid_argument: an option that
///                is out of range or does not fit the file. The message names file and position
Particles read_particles(const std::string& path, const ReadOptions& options = {});

/// Writes one frame; the format follows from the ending of the name: .vtp, .ply, .npz, .bgeo, .csv. Positions are
/// those of the file that was read (with Particles::origin added, in double where there is one and the format can).
/// Nothing is left behind where writing fails.
/// @throws Error  invalid_argument: an unknown ending; io_failed
void write_particles(const std::string& path, const Particles& particles);

/// One frame of a sequence that has been found but not read.
struct FramePath {
  std::string path;
  std::optional<std::int64_t> number;  ///< the frame number in its name, if it has one
  std::optional<std::size_t> place;    ///< from 0, in the sequence that it was picked from; none: it was not picked
  std::optional<double> time;          ///< s, where a file that lists the series tells
  std::vector<std::string> further{};  ///< files that hold the rest of the frame, in order; empty: `path` holds all
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
  ReadOptions reading;             ///< how its files are read
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
/// (`*`, `?`, `[...]`), patterns with `{}` for the frame number, and files that list a series (.pvd, .vtk.series).
/// Natural order within an argument.
/// A directory that holds several kinds of series (fluid and foam, say) gives the one that is most likely the
/// water, and a note on the others.
/// @throws Error  not_found: an argument that names nothing, a directory without frames
FrameSequence find_frames(std::span<const std::string> arguments, const ReadOptions& options = {});

/// Frames that a running simulation writes, found one after another as they become whole.
class FrameFollower {
 public:
  struct Options {
    double settle = 1;     ///< s that a file must not have changed for, before it is taken as whole
    double patience = 10;  ///< s that a damaged one may take to change, before it counts as damaged
    double poll = 0.25;    ///< s between two looks at the disk
    /// s without a new frame after which the sequence has ended; none: it goes on until `stopped`.
    std::optional<double> end_after;
    std::function<bool()> stopped;  ///< asked at every look; may be null
  };
  /// @param arguments  as of find_frames(); they need not name anything yet
  FrameFollower(std::vector<std::string> arguments, ReadOptions reading, Options options);

  /// The frames that are there, at least one; waits for it.
  /// @throws Error  not_found: it has ended before there was one; as find_frames(), but for names that are not there
  /// yet
  FrameSequence first();
  /// Frames that were not given before, in natural order; waits for one. None: it has ended.
  std::vector<FramePath> further();
  /// Waits until a file that could not be read has changed and settled again. False: it does not change any more.
  bool wait_for_change(const FramePath& frame);

 private:
  struct Seen {
    std::uintmax_t bytes = 0;
    std::int64_t changed = 0;  ///< by the file's own clock
    double since = 0;          ///< s, by ours
  };
  double now() const;
  bool stopped() const { return options_.stopped && options_.stopped(); }
  bool settled(const std::string& path);
  std::optional<FrameSequence> look();

  std::vector<std::string> arguments_;
  ReadOptions reading_;
  Options options_;
  std::map<std::string, Seen> seen_;
  std::set<std::string> given_;
};

}  // namespace meniscus
