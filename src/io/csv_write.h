/// Particles as comma-separated values.
#pragma once

#include "meniscus/io.h"

namespace meniscus::io {

/// A header with x, y, z and the names of the attributes (components as NAME:0, NAME:1 ...), then a line a particle.
/// Each number is the shortest that reads back to the same bits: floats, or doubles where positions have an origin.
/// @throws Error  io_failed
void write_csv(const std::string& path, const Particles& particles);

}  // namespace meniscus::io
