/// Light on the planes of a scene, as tables: floor and walls of a tiled tank, the ground around the water.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "meniscus/scene.h"

namespace meniscus {

/// Irradiance with shadows and caustics at the points of regular grids, bilinear between them. Squares of kTile x kTile
/// points are filled when they are first looked at, by whichever thread comes first; what they hold does not depend on
/// that. Colours and patterns of the planes are not in it, so that they stay as sharp as they are.
class PlaneLight {
 public:
  static constexpr int kTile = 16;  ///< points along a square; neighbours share those of their edge

  /// @param region  m; the part of the ground that is held
  /// @param step    m between points, > 0; there are at most 512 along an edge of a plane
  PlaneLight(const Scene& scene, const Bounds& region, float step);
  ~PlaneLight();
  PlaneLight(const PlaneLight&) = delete;
  PlaneLight& operator=(const PlaneLight&) = delete;

  /// Irradiance at a point on one of the planes; false where it is on none of them.
  /// @param face  0 .. 5, as in FaceHits: the plane's normal
  bool at(std::int32_t face, vec3 point, vec3& irradiance) const;

 private:
  using Square = std::array<vec3, static_cast<std::size_t>(kTile) * kTile>;
  struct Plane {
    int axis = 0;
    float sign = 1, level = 0;                  ///< of the normal along the axis; of the plane, m
    vec2 low{0.0f}, step{1.0f}, inverse{1.0f};  ///< m, m, cells a metre
    int width = 0, height = 0;                  ///< cells
    int across = 0;                             ///< squares
    std::vector<std::atomic<const Square*>> squares;
  };

  void add(int axis, float sign, float level, const Bounds& region, float step);
  const Square& square(const Plane& plane, int x, int y) const;
  void fill(const Plane& plane, int x, int y, Square& square) const;

  Scene white_;  ///< with a white tank
  std::vector<std::unique_ptr<Plane>> planes_;
  std::array<std::vector<const Plane*>, 6> by_face_;  ///< by twice the axis, and one more for normals along it
  float tolerance_ = 0;                               ///< m
};

}  // namespace meniscus
