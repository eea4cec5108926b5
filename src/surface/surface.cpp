#include "meniscus/surface.h"

namespace meniscus {

void Surface::crossings(std::span<const Ray>, std::span<const float>, std::span<const float>,
                        std::span<const std::uint8_t>, std::span<Crossing>) const {
  throw Error(ErrorCode::unsupported, "rays cannot be followed through this surface");
}

}  // namespace meniscus
