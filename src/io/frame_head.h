/// What the start of a file tells of the frame in it, without reading the frame.
#pragma once

#include <optional>

#include "io/bytes.h"
#include "meniscus/io.h"

namespace meniscus::io {

struct FrameHead {
  std::string format;             ///< as Particles::format
  std::uint64_t file_bytes = 0;   ///< of the file
  std::uint64_t plain_bytes = 0;  ///< that the reader holds while it reads: decompressed ones where it decompresses
  std::uint64_t particles = 0;
  bool counted = false;          ///< by the header; false: judged from the file's size
  double values = 3;             ///< numbers kept a particle: its position and attributes
  std::optional<float> spacing;  ///< m, if the header tells
  bool text = false;             ///< numbers in text, which take longer to read

  /// Bytes of the particles in memory.
  std::uint64_t particle_bytes() const;
  /// Bytes held at once while the frame is read, the particles among them.
  std::uint64_t reading_bytes() const;
};

/// @throws Error  as read_particles(), where the start of the file is enough to see it
FrameHead look_at_frame(const std::string& path, const ReadOptions& options = {});
/// Of all files that hold the frame.
FrameHead look_at_frame(const FramePath& frame, const ReadOptions& options = {});

// One a format, from the first bytes; `file_bytes` are those of the whole file after decompression.
void look_at_bgeo(const Source& start, FrameHead& head);
void look_at_vtk(const Source& start, FrameHead& head);
void look_at_ply(const Source& start, FrameHead& head);
void look_at_xyz(const Source& start, FrameHead& head);
/// Reads the file itself.
void look_at_hdf5(const std::string& path, FrameHead& head);

}  // namespace meniscus::io
