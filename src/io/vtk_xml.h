/// VTK's XML formats of particles: .vtu, .vtp and what lists pieces of them.
#pragma once

#include "io/frame_head.h"
#include "meniscus/io.h"

namespace meniscus::io {

/// Unstructured grids and polygonal data, of one piece or several, which are joined.
/// Also .pvtu and .pvtp, whose pieces stand in files of their own.
Particles read_vtk_xml(const Source& source, const ReadOptions& options);
void look_at_vtk_xml(const Source& start, FrameHead& head);

}  // namespace meniscus::io
