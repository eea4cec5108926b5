/// One reader a format. Each gives positions, attributes under the file's own names and notes; what is common
/// to all formats (names, NaN) is done by finish().
#pragma once

#include "io/bytes.h"
#include "io/gzip.h"

namespace meniscus::io {

/// Houdini classic BGEO, version 5, big-endian, as Partio and SPlisHSPlasH write it.
Particles read_bgeo(const Source& source);
/// The same from a gzip stream, decompressing no more than the header asks for.
Particles read_bgeo(const std::string& path, Gunzip& stream);
/// Legacy VTK, versions 1 to 5.1, ASCII and binary.
Particles read_vtk(const Source& source);
/// PLY 1.0, ASCII and binary of both byte orders.
Particles read_ply(const Source& source);
/// Numbers in text, one particle a line.
Particles read_xyz(const Source& source);
/// HDF5 with PySPH's layout. Reads the file itself.
Particles read_hdf5(const std::string& path);

/// Gives attributes their common names, joins components that stand in arrays of their own, and leaves out
/// particles whose positions are NaN or infinite.
void finish(Particles& particles);

}  // namespace meniscus::io
