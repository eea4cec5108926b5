/// Tables over directions, looked up for many directions at once.
#pragma once

#include "scene/direction_map.h"
#include "scene/ray_block.h"

namespace meniscus {

/// A table and copies of it that are blurred more and more, each by a fifth of the roughness.
struct DirectionLevels {
  static constexpr int kBlurred = 5;
  const DirectionMap* maps[kBlurred + 1] = {};
};

/// DirectionMap::at() of 1 .. BlockVectors::kLanes directions, times `scale`; between two levels where a roughness asks
/// for it, as Environment::radiance() does.
/// @param frame      the tables' directions are local in it
/// @param roughness  null: the first table alone
/// @param wanted     not zero for those that are; null: all. Others become zero
void look_up(const DirectionLevels& levels, const UpFrame& frame, float scale, const BlockVectors& directions,
             const float* roughness, const std::int32_t* wanted, int count, BlockVectors& result);

}  // namespace meniscus
