/// Writers of binary formats. Each writes a temporary file beside the target and renames it when it is whole.
#pragma once

#include "meniscus/io.h"

namespace meniscus::io {

/// Classic BGEO, version 5, as it is or, where the name ends in .gz, as a gzip stream. Positions are 32-bit floats
/// (from zero: an origin is added and costs digits). Attributes of three values are floats, but velocity, v, N and
/// normal vectors; one called id is of integers where all its values are whole.
/// @throws Error  io_failed; invalid_argument: arrays of different lengths; limit_exceeded: more than the format counts
void write_bgeo(const std::string& path, const Particles& particles);
/// Binary little-endian PLY: x, y, z as floats, or doubles where there is an origin, then a property a component
/// (vx, vy, vz; NAME_0, NAME_1 ...); time, spacing and up in comments.
void write_ply(const std::string& path, const Particles& particles);
/// NumPy's NPZ, not compressed: "positions" of N x 3 float32, or float64 where there is an origin, each attribute under
/// its name, and "time", "spacing", "up" where they are known.
void write_npz(const std::string& path, const Particles& particles);

/// @throws Error  invalid_argument: arrays of different lengths
void check_lengths(const std::string& path, const Particles& particles);
/// Whether positions are written as doubles: counted from an origin that is not zero.
bool has_origin(const Particles& particles);

}  // namespace meniscus::io
