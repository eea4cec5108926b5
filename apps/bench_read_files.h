/// Frames as other programs write them, for `bench read`.
#pragma once

#include <string>

#include "meniscus/base.h"

namespace meniscus::apps {

constexpr const char* kRawForm = "f32x3";  ///< of "raw", as ReadOptions::raw has it

/// Writes positions and the attribute velocity, of three components; without it: npy, raw.
/// @param format  vtk, hdf5, npy, raw, or an ending that write_particles() knows
/// @throws Error  io_failed
void write_for_bench(const std::string& format, const std::string& path, const Particles& particles);

}  // namespace meniscus::apps
