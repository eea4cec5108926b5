/// Series of frames among the files of a directory: which belong together, which are the water.
#pragma once

#include "io/frame_name.h"
#include "meniscus/io.h"

namespace meniscus::io {

/// Files whose names differ in the frame number only, in natural order.
struct Series {
  std::string name;       ///< "fluid_{}.bgeo"
  std::string stem;       ///< the same without extension: equal for the same frames in two formats
  std::string extension;  ///< ".bgeo"
  std::vector<FramePath> frames;
  std::uint64_t bytes = 0;  ///< of all files
};

/// Groups paths (of one directory) into series, in natural order of their names.
std::vector<Series> series_of(const std::vector<std::string>& paths);

/// Of what a directory or a wildcard offers, the series that is most likely the water; notes say what was left
/// out. Kinds of files that are not read are ignored. Names without any series of several files are frames
/// one by one. Empty if nothing is left.
FrameSequence most_likely_water(const std::vector<std::string>& paths);

/// Of paths that are different things at one time (fluid, boundary), the one that is most likely the water.
std::string likeliest_water(const std::vector<std::string>& paths);
/// 0 for names that speak of water, 2 for those of something else (foam, boundary), 1 for all others.
int water_class(std::string_view name);

/// "frame 450 is missing (frames come every 90)", or nothing. The step is the most common difference.
std::optional<std::string> missing_note(const std::vector<FramePath>& frames);

}  // namespace meniscus::io
