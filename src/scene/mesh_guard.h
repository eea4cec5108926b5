/// What a mesh file promises against what it can hold: looked at before anything is made of the promise.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace meniscus {

/// The kinds of file that are read.
enum class MeshKind { obj, ply, gltf, glb, stl };
/// By the name's ending, whatever its case. @throws Error unsupported
MeshKind mesh_kind_of(const std::string& path);

/// @throws Error malformed_file: a header that promises more than the bytes after it can hold; not the file's kind
void check_promises(MeshKind kind, std::span<const char> bytes, const std::string& path);

}  // namespace meniscus
