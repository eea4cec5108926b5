/// The formats that particles are read from and written to: one table, from which files are recognised.
#pragma once

#include <span>

#include "io/bytes.h"
#include "io/frame_head.h"
#include "meniscus/io.h"

namespace meniscus::io {

struct Format {
  std::string_view name;                  ///< as Particles::format: "vtk"
  std::string_view title;                 ///< for messages and documents: "legacy VTK"
  std::vector<std::string_view> endings;  ///< of names in lower case, ".gz" taken off; the usual one first
  /// Whether the first bytes of a file (some thousands, or all) are this format's; null: nothing in them tells, the
  /// ending of the name or the options do.
  bool (*recognises)(const Source& start) = nullptr;
  Particles (*read)(const Source& source, const ReadOptions& options) = nullptr;
  /// What the first bytes tell of the frame; head.file_bytes and plain_bytes are set. Null: only the size is known.
  void (*look)(const Source& start, FrameHead& head) = nullptr;
  /// Who fetches the bytes of a file (Source::need()).
  enum class Fetching { all_before, reader, library };  ///< library: it reads the file by its path
  Fetching fetching = Fetching::all_before;
};

/// In the order in which they are tried.
std::span<const Format> formats();

/// The format of some bytes, by content first and by the name second.
/// @throws Error  unsupported: none of them; malformed_file: the name says one that the content is not
const Format& format_of(const Source& start);

struct Writer {
  std::string_view ending;  ///< ".vtp"
  void (*write)(const std::string& path, const Particles& particles);
};
std::span<const Writer> writers();

}  // namespace meniscus::io
