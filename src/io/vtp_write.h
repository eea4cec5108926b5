/// The writer of .vtp, VTK's XML format of polygonal data.
#pragma once

#include "meniscus/io.h"

namespace meniscus::io {

/// Particles as vertices, with all attributes and the time. Arrays are appended raw; positions are float where the
/// origin is zero, else double with the origin added.
/// @throws Error  invalid_argument: arrays of different lengths; io_failed
void write_vtp(const std::string& path, const Particles& particles);

}  // namespace meniscus::io
