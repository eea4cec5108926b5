#include "render/body_shapes.h"

namespace meniscus {
namespace {

Mesh shape_of(const std::string& name) {
  if (name == "box") return box_mesh(vec3(-0.5f), vec3(0.5f));
  if (name == "sphere") return sphere_mesh(vec3(0), 0.5f);
  if (name == "cylinder") return cylinder_mesh({0, -0.5f, 0}, {0, 0.5f, 0}, 0.5f);
  throw Error(ErrorCode::invalid_argument, {"there is no such shape", "box, sphere or cylinder", name, {}, {}, {}, {}});
}

}  // namespace

Mesh mesh_of(const BodyOptions& body) { return body.path.empty() ? shape_of(body.shape) : read_mesh(body.path); }

}  // namespace meniscus
