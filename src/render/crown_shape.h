/// The shape of the made-up water crown: heights of its pool, its sheet, and the balls that rim, jets and drops are
/// made of. Lengths in m, y up, the crown's axis through the origin.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace meniscus {

constexpr float kPoolHalf = 1.0f;  ///< m: the pool is the square |x|, |z| <= kPoolHalf over the floor y = 0

/// Height of the pool's surface at a place: a crater inside the crown, a swell under it, rings around it.
float crown_pool_height(float x, float z);

/// A ball of water.
struct CrownBall {
  glm::vec3 centre;  ///< m
  float radius;      ///< m
};

/// The crown at one spacing of the particles. What would be thinner than they can show is made thicker.
class CrownShape {
 public:
  /// @param spacing  m, of the particles: the sheet is three spacings thick at least, a ball 0.7 in radius
  /// @param seed     of the jets and drops
  CrownShape(float spacing, std::uint64_t seed);

  /// A point of the sheet's middle: its distance from the axis, its height, and the part of the way up, v in [0, 1].
  struct Profile {
    float r, y;    ///< m
    float nr, ny;  ///< unit normal of the sheet in the plane of r and y, away from the axis
  };
  Profile profile(float v) const;
  /// m of the way up along the middle of the sheet, from v = 0 to 1.
  float length() const { return length_; }
  float thickness(float v) const;  ///< m
  /// How far up the sheet goes at an angle (radians, any), v in (0, 1).
  float end(float angle) const;
  /// Whether a point belongs to the sheet, or is within half a spacing of it.
  bool near_sheet(glm::vec3 point) const;
  /// Rim, jets and drops; they overlap.
  const std::vector<CrownBall>& balls() const { return balls_; }

 private:
  struct Lobe {
    float angle;   ///< radians, where a jet rises from the rim
    float height;  ///< that it adds to the sheet, v
  };
  float end_by_lobes(float angle) const;
  void add_rim(std::uint64_t seed);
  void add_jets(std::uint64_t seed);
  void add_ball(glm::vec3 centre, float radius);

  float spacing_;
  float length_ = 0;
  std::vector<Lobe> lobes_;  ///< by rising angle
  std::vector<float> ends_;  ///< at equal angles from 0 to 2 pi, both included
  std::vector<CrownBall> balls_;
};

}  // namespace meniscus
