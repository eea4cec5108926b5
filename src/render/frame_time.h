/// What a frame's drawing takes in time, measured on this machine with a small one.
#pragma once

#include "meniscus/render.h"

namespace meniscus {

/// Seconds of the parts of a frame by what they grow with.
struct FrameTime {
  double a_particle = 0;         ///< s for each particle, of the surface's making
  double a_pixel = 0;            ///< s for each pixel that a ray is cast for
  double fixed = 0;              ///< s of light and scene, about the same in all frames
  double survey_a_particle = 0;  ///< s for each of the first half a million particles that are looked at beforehand
  double write_a_pixel = 0;      ///< s
};

/// Draws a small tank and a small crown of water with the same options and as many pixels a spacing, and takes the
/// mean: the outlines of drops and sheets take most of a crown's time.
/// @param particles  in the frame that is meant
FrameTime measure_frame(const PictureOptions& picture, std::uint64_t particles, PictureFormat format);

}  // namespace meniscus
