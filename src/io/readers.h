/// One reader a format. Each gives positions, attributes under the file's own names and notes; what is common
/// to all formats (names, NaN, which particles are kept, units) is done by finish().
#pragma once

#include "io/bytes.h"
#include "io/gzip.h"
#include "meniscus/io.h"

namespace meniscus::io {

struct FrameHead;

/// Houdini classic BGEO, version 5, big-endian, as Partio and SPlisHSPlasH write it.
Particles read_bgeo(const Source& source, const ReadOptions& options);
/// The same from a gzip stream, decompressing no more than the header asks for.
Particles read_bgeo(const std::string& path, Gunzip& stream, const ReadOptions& options);
/// Houdini's geometry of version 12 and later: JSON as text, and its binary encoding.
Particles read_houdini(const Source& source, const ReadOptions& options);
void look_at_houdini(const Source& start, FrameHead& head);
/// Houdini's classic geometry as text, "PGEOMETRY V5".
Particles read_geo(const Source& source, const ReadOptions& options);
void look_at_geo(const Source& start, FrameHead& head);
/// Maya's particles, PDB, with pointers of 32 or 64 bits, in both byte orders.
Particles read_pdb(const Source& source, const ReadOptions& options);
void look_at_pdb(const Source& start, FrameHead& head);
bool is_pdb(const Source& start);
/// RealFlow's particles, BIN, versions 1 to 15.
Particles read_realflow(const Source& source, const ReadOptions& options);
void look_at_realflow(const Source& start, FrameHead& head);
bool is_realflow(const Source& start);
/// Adds a note that primitives were left out, if there are any.
void note_primitives(std::uint64_t count, Particles& particles);
/// Legacy VTK, versions 1 to 5.1, ASCII and binary.
Particles read_vtk(const Source& source, const ReadOptions& options);
/// PLY 1.0, ASCII and binary of both byte orders.
Particles read_ply(const Source& source, const ReadOptions& options);
/// Numbers in text, one particle a line.
Particles read_xyz(const Source& source, const ReadOptions& options);
/// HDF5 with PySPH's layout. Reads the file itself.
Particles read_hdf5(const Source& start, const ReadOptions& options);

/// NumPy's NPY: an array of N x 3, or a structured one.
Particles read_npy(const Source& source, const ReadOptions& options);
/// NumPy's NPZ: a zip archive of such arrays.
Particles read_npz(const Source& source, const ReadOptions& options);
void look_at_npy(const Source& start, FrameHead& head);
void look_at_npz(const Source& start, FrameHead& head);

/// Gives attributes their common names, joins components that stand in arrays of their own, and leaves out
/// particles whose positions are NaN or infinite, and those that are not asked for.
/// @param particles  dropped_non_finite is not zero if one of their coordinates is, as set_positions() leaves it
void finish(const ReadOptions& options, Particles& particles);

}  // namespace meniscus::io
