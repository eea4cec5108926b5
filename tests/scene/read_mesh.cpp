#include <gtest/gtest.h>
#include <unistd.h>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>

#include "scene/picture_files.h"
#include "scene/scene_of.h"

namespace meniscus {
namespace {

/// A folder that goes with the test.
class ReadMesh : public ::testing::Test {
 protected:
  ReadMesh() {
    std::string name = (std::filesystem::temp_directory_path() / "meniscus_mesh_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~ReadMesh() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  std::filesystem::path folder_;
};

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

Bounds bounds_of(const Mesh& mesh) {
  Bounds box;
  for (const vec3& p : mesh.positions) box.add(p);
  return box;
}

void expect_box(const Mesh& mesh, vec3 low, vec3 high) {
  EXPECT_LT(glm::length(bounds_of(mesh).low - low), 1e-5f);
  EXPECT_LT(glm::length(bounds_of(mesh).high - high), 1e-5f);
}

const char* const kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

std::string binary_stl(int triangles) {
  std::string bytes(80, ' ');
  put(bytes, static_cast<std::uint32_t>(triangles));
  for (int t = 0; t < triangles; ++t) {
    for (const float value : {0.f, 0.f, 1.f, 0.f, 0.f, 2.f, 3.f, 0.f, 2.f, 0.f, 4.f + static_cast<float>(t), 2.f})
      put(bytes, value);
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string ply(bool binary) {
  std::string bytes = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
                      " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  if (!binary) return bytes + "0 0 0\n2 0 0\n2 3 0\n0 3 0\n4 0 1 2 3\n";
  for (const float value : {0.f, 0.f, 0.f, 2.f, 0.f, 0.f, 2.f, 3.f, 0.f, 0.f, 3.f, 0.f}) put(bytes, value);
  bytes.push_back(4);
  for (const std::int32_t index : {0, 1, 2, 3}) put(bytes, index);
  return bytes;
}

/// A triangle under two nodes: moved by (10, 0, 0), the child turned by 90 degrees around z.
std::string gltf_json(const std::string& buffer) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"translation":[10,0,0],"children":[1]},{"mesh":0,"rotation":[0,0,0.70710678,0.70710678]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.25,0.5,0.75,1],"roughnessFactor":0.3,
                  "baseColorTexture":{"index":0}}}],
    "textures":[{"source":0}],"images":[{"bufferView":2,"mimeType":"image/png"}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,1,0]},
                 {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6},
                   {"buffer":0,"byteOffset":44,"byteLength":PICTURE}],
    "buffers":[{BUFFER"byteLength":LENGTH}]})" +
         buffer;
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

std::string gltf_buffer() {
  std::string bytes;
  for (const float value : {0.f, 0.f, 0.f, 2.f, 0.f, 0.f, 0.f, 1.f, 0.f}) put(bytes, value);
  for (std::uint16_t index = 0; index < 3; ++index) put(bytes, index);
  put(bytes, std::uint16_t{0});
  Image<Texel> picture(2, 2, Texel{255, 0, 0});
  return bytes + tests::png_bytes(picture);
}

std::string filled_json(const std::string& uri) {
  const std::string buffer = gltf_buffer();
  std::string json = replaced(gltf_json(""), "LENGTH", std::to_string(buffer.size()));
  json = replaced(json, "PICTURE", std::to_string(buffer.size() - 44));
  return replaced(json, "BUFFER", uri.empty() ? "" : "\"uri\":\"" + uri + "\",");
}

std::string glb() {
  std::string json = filled_json(""), buffer = gltf_buffer();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  std::string bytes = "glTF";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(28 + json.size() + buffer.size()));
  put(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  put(bytes, static_cast<std::uint32_t>(buffer.size()));
  return bytes + std::string("BIN\0", 4) + buffer;
}

TEST_F(ReadMesh, OfAnObjIsItsPolygonsCutIntoTriangles) {
  const Mesh mesh = read_mesh(write("cube.obj", kCube));
  EXPECT_EQ(mesh.corners.size(), 36u);
  expect_box(mesh, {0, 0, 0}, {1, 1, 1});
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  // Right angles are edges: every triangle's normals are its own, outwards.
  for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
    const vec3 a = mesh.positions[mesh.corners[t]], b = mesh.positions[mesh.corners[t + 1]],
               c = mesh.positions[mesh.corners[t + 2]];
    const vec3 face = glm::normalize(glm::cross(b - a, c - a));
    EXPECT_GT(glm::dot(face, (a + b + c) / 3.0f - vec3{0.5f}), 0);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(glm::length(mesh.normals[mesh.corners[t + k]] - face), 1e-5f);
  }
  EXPECT_NO_THROW(make_solid(mesh));
}

TEST_F(ReadMesh, OfAnObjHasItsMaterialsAndTexturesBesideIt) {
  const std::string picture = write("wood.png", tests::png_bytes(Image<Texel>(2, 2, Texel{255, 255, 0})));
  write("look.mtl", "newmtl a\nKd 0.2 0.4 0.6\nmap_Kd wood.png\nnewmtl b\nKd 0.5 0.5 0.5\nPr 0.25\n");
  const Mesh mesh = read_mesh(write("look.obj",
                                    "mtllib look.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 5\nv 1 0 5\nv 0 1 5\n"
                                    "vt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 4/1 5/2 6/3\n"));
  ASSERT_EQ(mesh.corners.size(), 6u);
  ASSERT_EQ(mesh.texture_points.size(), mesh.positions.size());
  for (std::size_t t = 0; t < 2; ++t) {
    const SolidMaterial& material = mesh.materials[mesh.material_of[t]];
    const bool first = mesh.positions[mesh.corners[3 * t]].z < 1;
    EXPECT_LT(glm::length(material.albedo - (first ? vec3{0.2f, 0.4f, 0.6f} : vec3{0.5f})), 1e-6f) << "as they are";
    EXPECT_EQ(material.texture, first ? picture : "");
    EXPECT_FLOAT_EQ(material.roughness, first ? 1.0f : 0.25f);
  }
  EXPECT_NEAR(scene_of({{make_solid(mesh), glm::mat4(1.0f), {}}}).hit({{0.2f, 0.2f, 1}, {0, 0, -1}}).albedo.y, 0.4f,
              1e-4f);
}

TEST_F(ReadMesh, OfARoundObjIsSmooth) {
  const Mesh ball = sphere_mesh({0, 0, 0}, 1, 40);
  std::string text = "g default\n";
  for (const vec3& p : ball.positions)
    text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  for (std::size_t t = 0; t < ball.corners.size(); t += 3)
    text += "f " + std::to_string(ball.corners[t] + 1) + " " + std::to_string(ball.corners[t + 1] + 1) + " " +
            std::to_string(ball.corners[t + 2] + 1) + "\n";
  const Mesh mesh = read_mesh(write("ball.obj", text));
  EXPECT_EQ(mesh.corners.size(), ball.corners.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_GT(glm::dot(mesh.normals[i], glm::normalize(mesh.positions[i])), 0.99f);
}

TEST_F(ReadMesh, OfAPlyIsTheSameInTextAndBytes) {
  for (const bool binary : {false, true}) {
    const Mesh mesh = read_mesh(write("square.ply", ply(binary)));
    EXPECT_EQ(mesh.corners.size(), 6u);
    expect_box(mesh, {0, 0, 0}, {2, 3, 0});
    EXPECT_EQ(mesh.materials.at(mesh.material_of.at(0)).roughness, 1.0f);
  }
}

TEST_F(ReadMesh, OfAnStlIsItsTriangles) {
  Mesh mesh = read_mesh(write("two.stl", binary_stl(2)));
  EXPECT_EQ(mesh.corners.size(), 6u);
  expect_box(mesh, {0, 0, 2}, {3, 5, 2});
  mesh =
      read_mesh(write("text.STL",
                      "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                      "endfacet\nendsolid one\n"));
  EXPECT_EQ(mesh.corners.size(), 3u);
}

TEST_F(ReadMesh, OfAGltfHasItsNodesTransformsAndItsPictures) {
  write("buffer.bin", gltf_buffer());
  for (const std::string& path : {write("a.gltf", filled_json("buffer.bin")), write("a.glb", glb())}) {
    const Mesh mesh = read_mesh(path);
    ASSERT_EQ(mesh.corners.size(), 3u);
    expect_box(mesh, {9, 0, 0}, {10, 2, 0});
    const SolidMaterial& material = mesh.materials.at(mesh.material_of.at(0));
    EXPECT_LT(glm::length(material.albedo - vec3{0.25f, 0.5f, 0.75f}), 1e-6f);
    EXPECT_FLOAT_EQ(material.roughness, 0.3f);
    ASSERT_EQ(mesh.pictures.size(), 1u);
    EXPECT_EQ(material.texture, "*0");
    EXPECT_NO_THROW(make_solid(mesh));
  }
}

TEST_F(ReadMesh, DropsTrianglesWithoutAreaAndPointsWithoutTriangles) {
  const Mesh mesh =
      read_mesh(write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 99 99 99\nf 1 2 3\nf 1 2 4\nf 1 1 3\n"));
  EXPECT_EQ(mesh.corners.size(), 3u);
  expect_box(mesh, {0, 0, 0}, {1, 1, 0});
}

ErrorCode code_of(const std::string& path) {
  try {
    read_mesh(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
    EXPECT_FALSE(error.detail().problem.empty());
    return error.code();
  }
  ADD_FAILURE() << path << " was read";
  return ErrorCode::io_failed;
}

TEST_F(ReadMesh, SaysWhatIsWrongWithAFile) {
  EXPECT_EQ(code_of((folder_ / "none.obj").string()), ErrorCode::not_found);
  EXPECT_EQ(code_of(write("film.mp4", "x")), ErrorCode::unsupported);
  EXPECT_EQ(code_of(write("name_without_ending", "x")), ErrorCode::unsupported);
  for (const char* name : {"a.obj", "a.ply", "a.stl", "a.gltf", "a.glb"}) {
    EXPECT_EQ(code_of(write(name, "")), ErrorCode::malformed_file) << name;
    EXPECT_EQ(code_of(write(name, "no mesh at all\n")), ErrorCode::malformed_file) << name;
    EXPECT_EQ(code_of(write(name, std::string(5000, '\xEE'))), ErrorCode::malformed_file) << name;
  }
  EXPECT_EQ(code_of(write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")), ErrorCode::malformed_file);
  std::filesystem::create_directory(folder_ / "folder.obj");
  EXPECT_EQ(code_of((folder_ / "folder.obj").string()), ErrorCode::io_failed);
}

TEST_F(ReadMesh, BelievesNoHeaderThatPromisesMoreThanTheFileHolds) {
  EXPECT_EQ(code_of(write("a.ply", replaced(ply(true), "vertex 4", "vertex 4000000000"))), ErrorCode::malformed_file);
  EXPECT_EQ(code_of(write("b.ply", replaced(ply(false), "face 1", "face 99999999"))), ErrorCode::malformed_file);
  EXPECT_EQ(code_of(write("c.ply", replaced(ply(true), "vertex 4", "vertex 99999999999999999999999"))),
            ErrorCode::malformed_file);
  std::string stl = binary_stl(2);
  stl[83] = 0x7F;
  EXPECT_EQ(code_of(write("a.stl", stl)), ErrorCode::malformed_file);
  write("buffer.bin", gltf_buffer());
  const std::string json = filled_json("buffer.bin");
  EXPECT_EQ(code_of(write("a.gltf", replaced(json, "\"count\":3", "\"count\":3000000000"))), ErrorCode::malformed_file);
  EXPECT_EQ(code_of(write("b.gltf", replaced(json, "buffer.bin", "other.bin"))), ErrorCode::not_found);
  EXPECT_EQ(code_of(write("c.gltf", replaced(json, "\"children\":[1]", "\"children\":[0]"))),
            ErrorCode::malformed_file);
}

/// Whether it is read or refused is the importer's choice; that it ends, in good order, is what counts.
void expect_no_harm(const std::string& path) {
  try {
    const Mesh mesh = read_mesh(path);
    for (const std::uint32_t corner : mesh.corners) ASSERT_LT(corner, mesh.positions.size());
  } catch (const Error& error) {
    EXPECT_EQ(error.detail().path, path);
  }
}

TEST_F(ReadMesh, SurvivesEveryCutAndManyFlippedBytes) {
  write("buffer.bin", gltf_buffer());
  const std::pair<const char*, std::string> files[] = {{"x.obj", kCube},      {"x.ply", ply(true)},
                                                       {"y.ply", ply(false)}, {"x.stl", binary_stl(2)},
                                                       {"x.glb", glb()},      {"x.gltf", filled_json("buffer.bin")}};
  std::uint32_t state = 1;
  for (const auto& [name, whole] : files) {
    const std::size_t step = std::max<std::size_t>(1, whole.size() / 12);
    for (std::size_t size = 0; size < whole.size(); size += step) expect_no_harm(write(name, whole.substr(0, size)));
    for (int i = 0; i < 12; ++i) {
      std::string flipped = whole;
      for (int k = 0; k < 2; ++k) {
        state = state * 1664525u + 1013904223u;
        flipped[(state >> 8) % flipped.size()] ^= static_cast<char>(1u << (state >> 29));
      }
      expect_no_harm(write(name, flipped));
    }
  }
}

}  // namespace
}  // namespace meniscus
