#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "meniscus/render.h"
#include "render/body_shapes.h"
#include "render/numbered_path.h"

namespace meniscus {
namespace {

/// After the last frame of its list, a body is there or not as in that.
bool is_absent(const BodyOptions& body, std::size_t index) {
  return !body.absent.empty() && body.absent[std::min(index, body.absent.size() - 1)];
}

}  // namespace

Bodies::Bodies(std::vector<BodyOptions> bodies) : bodies_(std::move(bodies)) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const BodyOptions& body = bodies_[i];
    if (body.path.empty() == body.shape.empty())
      throw Error(ErrorCode::invalid_argument, {fmt::format("body {} needs either a file or a shape", i),
                                                "one of them",
                                                body.path.empty() ? "neither" : "both",
                                                {},
                                                {},
                                                {},
                                                {}});
    const NumberedPath path(body.path);
    if (!path.understood())
      throw Error(ErrorCode::invalid_argument, {"the pattern of a body's files cannot be understood",
                                                "{} or {:04} for the frame's number",
                                                body.path,
                                                {},
                                                {},
                                                {},
                                                {}});
    Read& read = read_.emplace_back();
    if (path.is_numbered()) continue;
    // One mesh that stands in several places is read once.
    for (std::size_t j = 0; j < i && !read.solid; ++j)
      if (bodies_[j].path == body.path && bodies_[j].shape == body.shape) read.solid = read_[j].solid;
    if (!read.solid) read.solid = make_solid(mesh_of(body));
  }
}

std::vector<PlacedSolid> Bodies::at(std::size_t index, std::int64_t number, std::vector<std::string>& notes,
                                    std::span<const std::optional<glm::mat4>> moved) const {
  if (!moved.empty() && moved.size() != bodies_.size())
    throw Error(ErrorCode::invalid_argument,
                fmt::format("{} bodies are moved by {} transforms", bodies_.size(), moved.size()));
  std::vector<PlacedSolid> placed;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const BodyOptions& body = bodies_[i];
    if (moved.empty() ? is_absent(body, index) : !moved[i]) continue;
    const NumberedPath pattern(body.path);
    Read& read = read_[i];
    if (pattern.is_numbered()) {
      const std::string path = pattern.of(number);
      std::error_code ignored;
      if (!std::filesystem::exists(path, ignored)) {
        notes.push_back(fmt::format("the body {} is left out: there is no such file", path));
        continue;
      }
      if (read.path != path || !read.solid) {
        read = {};  // one mesh in memory, not two
        read.solid = make_solid(read_mesh(path));
        read.path = path;
      }
    }
    PlacedSolid solid{read.solid, body.world_from_body, body.material};
    if (!moved.empty())
      solid.world_from_solid *= *moved[i];
    else if (!body.frames.empty())
      solid.world_from_solid *= body.frames[std::min(index, body.frames.size() - 1)];
    placed.push_back(std::move(solid));
  }
  return placed;
}

bool Bodies::still() const {
  return std::all_of(bodies_.begin(), bodies_.end(), [](const BodyOptions& body) {
    return !NumberedPath(body.path).is_numbered() &&
           std::find(body.absent.begin(), body.absent.end(), true) == body.absent.end() &&
           std::all_of(body.frames.begin(), body.frames.end(),
                       [&](const glm::mat4& frame) { return frame == body.frames.front(); });
  });
}

}  // namespace meniscus
