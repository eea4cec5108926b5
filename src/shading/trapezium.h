/// Where on the surface an object can be seen: a trapezium laid around it, towards the eye.   [Cords2008] 2.3, fig. 8
#pragma once

#include "meniscus/shading.h"

namespace meniscus {

class Trapezium {
 public:
  /// @param eye  projected onto the surface, along the horizontal axes
  Trapezium(const WaterObject& object, vec2 eye, Axis up, const VirtualEyeOptions& options);
  /// How much the map with the object counts at a place m of the surface: 1 around the centreline, 0 outside.
  float weight(vec2 m) const;
  float half_width_at_object() const { return a_; }
  float half_width_at_eye() const { return b_; }

 private:
  vec2 start_{0.0f};         ///< x', behind the object's centre x
  vec2 towards_{1, 0};       ///< unit vector r from it to the eye; the sides run perpendicular to it
  float length_ = 0;         ///< m from x' to the eye
  float a_ = 0, b_ = 0;      ///< half widths, m
  float soft_ = 0;           ///< m beyond x' over which the weight fades
  bool everywhere_ = false;  ///< the eye stands over the object
};

}  // namespace meniscus
