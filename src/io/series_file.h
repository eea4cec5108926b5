/// Files that list a series of frames and their times: .pvd, .vtk.series, .vtu.series.
#pragma once

#include "io/bytes.h"
#include "meniscus/io.h"

namespace meniscus::io {

/// Whether a name has the ending of such a file.
bool is_series_name(std::string_view path);
/// Whether the start of a file is of ParaView's JSON form. (.pvd files are recognised as VTK XML.)
bool is_json_series(const Source& start);

/// The frames that a file lists, in its order, with their times. Several parts of one time are one frame where they
/// are parts of one thing; of different things the one is taken that its name or size makes most likely the water.
/// Frames of which a file is missing are left out with a note.
/// @throws Error  malformed_file: damaged, or names another list; not_found: none of its files is there;
///                invalid_argument: a name leads out of its directory and options.allow_outside is not set
FrameSequence frames_of_series(const std::string& path, const ReadOptions& options);

/// Throws unsupported: a series is no frame.
Particles refuse_series(const Source& source, const ReadOptions& options);

}  // namespace meniscus::io
