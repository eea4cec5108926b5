#include "meniscus/scene.h"
namespace meniscus {
Mesh read_mesh(const std::string& path) { throw Error(ErrorCode::unsupported, path); }
}  // namespace meniscus
