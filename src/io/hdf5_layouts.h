/// Where the particles are in an HDF5 file: groups of arrays that have positions.
#pragma once

#include "io/hdf5_handles.h"

namespace meniscus::io {

/// A group whose arrays are particles.
struct Hdf5Particles {
  std::string name;  ///< for messages: "fluid" of /particles/fluid/arrays, "PartType0"; "" for the root
  Hdf5Group group;
  std::vector<NumberArray> arrays;  ///< of it, without their values
  PositionArrays found;
  bool is_boundary = false;  ///< by its name
};

/// Every group that has positions, water before others before boundaries, many particles before few.
/// Known are PySPH's (/particles/NAME/arrays with x, y, z), Gadget's and SWIFT's (/PartType0/Coordinates), and any
/// group, or the root, with arrays of the names that find_positions() knows.
/// @throws Error  unsupported: there is none; the message lists the arrays that there are.
///                invalid_argument: options.positions names none
std::vector<Hdf5Particles> particles_in(const Hdf5Group& file, const ReadOptions& options, const std::string& path);

}  // namespace meniscus::io
