/// Rain as it falls on one sequence: what its settings leave open is found in what there is to rain on.
#pragma once

#include <memory>

#include "meniscus/render.h"

namespace meniscus {

/// The region, heights and axes of the rain, its ground and its ripples.
/// @param options  options.rain is set
RainSettings rain_over(const Survey& survey, const PictureOptions& options);

/// Rain that begins; null without options.rain.
/// @throws Error  as RainyScene; not_found: no body of the ground's name
std::shared_ptr<RainyScene> rain_of(const Survey& survey, const PictureOptions& options);

/// Whether the rain has cells of its own to fall on, which take the place of the ground's pattern.
bool has_rain_ground(const PictureOptions& options);

/// Height of the scene's plane around the rain's cells, m along up: just under the lowest of them.
/// @param rain  with cells
float plane_under(const RainyScene& rain);

}  // namespace meniscus
