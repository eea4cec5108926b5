#include "scene/mesh_guard.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "meniscus/base.h"

namespace meniscus {
namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(const std::string& path, std::string problem, std::string expected = {},
                       std::string found = {}) {
  throw Error(ErrorCode::malformed_file,
              {std::move(problem), std::move(expected), std::move(found), path, {}, {}, "write the mesh again"});
}

std::size_t bytes_of_type(std::string_view type) {
  for (const std::string_view name : {"char", "uchar", "int8", "uint8"})
    if (type == name) return 1;
  for (const std::string_view name : {"short", "ushort", "int16", "uint16"})
    if (type == name) return 2;
  for (const std::string_view name : {"double", "float64"})
    if (type == name) return 8;
  return 4;
}

/// Every element of a PLY file takes at least so many bytes: what its properties are wide, or a digit and a space each.
void check_ply(std::string_view text, const std::string& path) {
  if (!text.starts_with("ply")) fail(path, "this is not a PLY file", "ply", "other bytes");
  std::size_t position = 0, least = 0, count = 0;
  std::size_t each = 0;
  bool ascii = true, ended = false;
  const auto close_element = [&] {
    // Sizes are bounded by the file's, so that nothing overflows.
    if (each > 0 && count > text.size() / each + 1)
      least = text.size() + 1;
    else
      least += each * count;
    each = 0;
    count = 0;
  };
  while (position < text.size() && !ended) {
    const std::size_t end = std::min(text.find('\n', position), text.size());
    std::string_view line = text.substr(position, end - position);
    position = end + 1;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (line.starts_with("format ")) ascii = line.starts_with("format ascii");
    if (line.starts_with("element ")) {
      close_element();
      const std::string_view number = line.substr(line.rfind(' ') + 1);
      if (std::from_chars(number.data(), number.data() + number.size(), count).ec != std::errc{})
        fail(path, "an element of the PLY header has no usable number", "element vertex 8",
             std::string(line.substr(0, 80)));
      if (count > text.size()) least = text.size() + 1;
    } else if (line.starts_with("property list ")) {
      each += ascii ? 2 : 1;
    } else if (line.starts_with("property ")) {
      const std::string_view rest = line.substr(9);
      each += ascii ? 2 : bytes_of_type(rest.substr(0, rest.find(' ')));
    } else if (line == "end_header") {
      close_element();
      ended = true;
    }
  }
  if (!ended) fail(path, "the file ends inside its PLY header");
  const std::size_t left = text.size() - std::min(position, text.size());
  // The last line of a text may lack its end.
  if (least > left + 1)
    fail(path, "the file is too short for what its PLY header promises", fmt::format("at least {} bytes", least),
         fmt::format("{} bytes after the header", left));
}

std::uint32_t word(std::span<const char> bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Numbers in the glTF description that are sizes must fit into the buffers that there are.
void check_gltf(std::span<const char> json, std::size_t file_bytes, const std::string& path) {
  Json root;
  try {
    root = Json::parse(json.begin(), json.end());
  } catch (const Json::exception&) {
    fail(path, "the description in the glTF file is not JSON");
  }
  if (!root.is_object() || !root.contains("asset")) fail(path, "this is not a glTF file", "an asset", "other JSON");
  const auto list = [&](const char* name) -> const Json& {
    static const Json none = Json::array();
    const auto found = root.find(name);
    if (found == root.end()) return none;
    if (!found->is_array()) fail(path, fmt::format("{} of the glTF file is no list", name));
    for (const Json& entry : *found)
      if (!entry.is_object()) fail(path, fmt::format("an entry of {} of the glTF file is no object", name));
    return *found;
  };
  const auto number = [&](const Json& in, const char* name) -> std::uint64_t {
    const auto found = in.find(name);
    if (found == in.end()) return 0;
    if (!found->is_number_unsigned())
      fail(path, fmt::format("{} in the glTF file is no size", name), {}, found->dump());
    return found->get<std::uint64_t>();
  };
  // Buffers are other files, text in this one or the rest of a .glb.
  std::uint64_t available = file_bytes;
  for (const Json& buffer : list("buffers")) {
    const auto uri = buffer.find("uri");
    std::error_code status;
    if (uri != buffer.end() && uri->is_string() && !uri->get_ref<const std::string&>().starts_with("data:")) {
      const auto name = std::filesystem::path(path).parent_path() / uri->get_ref<const std::string&>();
      const auto size = std::filesystem::file_size(name, status);
      if (status)
        throw Error(ErrorCode::not_found,
                    {"a buffer of the glTF file is not there", {}, name.string(), path, {}, {}, {}});
      available += size;
      if (number(buffer, "byteLength") > size)
        fail(path, "a buffer of the glTF file is too short", fmt::format("{} bytes", number(buffer, "byteLength")),
             fmt::format("{} bytes", size));
    } else if (number(buffer, "byteLength") > file_bytes) {
      fail(path, "a buffer of the glTF file is longer than the file", fmt::format("at most {} bytes", file_bytes),
           fmt::format("{} bytes", number(buffer, "byteLength")));
    }
  }
  for (const char* name : {"bufferViews", "accessors"})
    for (const Json& entry : list(name))
      for (const char* field : {"count", "byteLength", "byteOffset", "byteStride"})
        if (number(entry, field) > available)
          fail(path, "a size in the glTF file is larger than its buffers", fmt::format("at most {}", available),
               fmt::format("{} {}", field, number(entry, field)));
  // A node that is its own descendant would never end.
  const Json& nodes = list("nodes");
  std::vector<std::uint8_t> has_parent(nodes.size(), 0);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto children = nodes[i].find("children");
    if (children == nodes[i].end()) continue;
    if (!children->is_array()) fail(path, "the children of a node are no list");
    for (const Json& child : *children) {
      if (!child.is_number_unsigned() || child.get<std::uint64_t>() >= nodes.size())
        fail(path, "a node of the glTF file has a child that is not there", {}, child.dump());
      std::uint8_t& taken = has_parent[child.get<std::size_t>()];
      if (taken || child.get<std::uint64_t>() == i) fail(path, "the nodes of the glTF file are no tree");
      taken = 1;
    }
  }
  // Nodes that all have one parent at most and are reached from one without make trees; rings have no such entrance.
  for (const Json& scene : list("scenes"))
    if (const auto roots = scene.find("nodes"); roots != scene.end()) {
      if (!roots->is_array()) fail(path, "the nodes of a scene are no list");
      for (const Json& node : *roots)
        if (!node.is_number_unsigned() || node.get<std::uint64_t>() >= nodes.size() ||
            has_parent[node.get<std::size_t>()])
          fail(path, "a scene of the glTF file starts at a node that is no root", {}, node.dump());
    }
}

void check_glb(std::span<const char> bytes, const std::string& path) {
  if (bytes.size() < 20 || std::string_view(bytes.data(), 4) != "glTF")
    fail(path, "this is not a binary glTF file", "glTF", bytes.size() < 20 ? "too few bytes" : "other bytes");
  const std::size_t length = word(bytes, 12);
  if (word(bytes, 8) > bytes.size() || length > bytes.size() - 20)
    fail(path, "the file is too short for what its glTF header promises",
         fmt::format("{} bytes", std::max<std::size_t>(word(bytes, 8), length + 20)),
         fmt::format("{} bytes", bytes.size()));
  check_gltf(bytes.subspan(20, length), bytes.size(), path);
}

/// A text that starts with "solid", or 84 bytes and 50 a triangle.
void check_stl(std::span<const char> bytes, const std::string& path) {
  const std::string_view text(bytes.data(), bytes.size());
  const bool fits = bytes.size() >= 84 && bytes.size() >= 84 + std::size_t{50} * word(bytes, 80);
  if (!fits && !(text.starts_with("solid") && text.find("facet") != std::string_view::npos))
    fail(path, "the file is too short for the triangles that its STL header promises",
         bytes.size() >= 84 ? fmt::format("{} bytes", 84 + std::size_t{50} * word(bytes, 80)) : "at least 84 bytes",
         fmt::format("{} bytes", bytes.size()));
}

}  // namespace

MeshKind mesh_kind_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (ending == ".obj") return MeshKind::obj;
  if (ending == ".ply") return MeshKind::ply;
  if (ending == ".gltf") return MeshKind::gltf;
  if (ending == ".glb") return MeshKind::glb;
  if (ending == ".stl") return MeshKind::stl;
  throw Error(ErrorCode::unsupported, {"meshes are not read from this kind of file",
                                       ".obj, .ply, .gltf, .glb or .stl",
                                       ending,
                                       path,
                                       {},
                                       {},
                                       "convert the mesh"});
}

void check_promises(MeshKind kind, std::span<const char> bytes, const std::string& path) {
  if (bytes.empty()) fail(path, "the mesh file is empty");
  switch (kind) {
    case MeshKind::obj:
      break;
    case MeshKind::ply:
      check_ply({bytes.data(), bytes.size()}, path);
      break;
    case MeshKind::gltf:
      check_gltf(bytes, bytes.size(), path);
      break;
    case MeshKind::glb:
      check_glb(bytes, path);
      break;
    case MeshKind::stl:
      check_stl(bytes, path);
      break;
  }
}

}  // namespace meniscus
