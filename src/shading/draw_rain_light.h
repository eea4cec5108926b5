/// What balls and jets of water show of their surroundings.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "meniscus/formulas/optics.h"
#include "shading/surroundings_parts.h"

namespace meniscus {

/// A ball of water in air in closed form. A ray that meets it at the angle of incidence i, at sin i radii beside its
/// centre, leaves it turned towards the axis by D = 2 (i - r), sin r = sin i / ior; its mirror image by pi - 2 i. The
/// light that is left after the first mirror is all given to the ray that goes on: fainter inner images are not
/// followed, none of their light is lost.
class BallOptics {
 public:
  explicit BallOptics(float ior);

  struct Bend {
    float sine, cosine;  ///< of D
    float mirrored;      ///< Fresnel reflectance
  };
  /// @param cos_i  in [0, 1]
  Bend at(float cos_i) const {
    const float sin2 = std::max(0.0f, 1.0f - cos_i * cos_i), sin_i = std::sqrt(sin2);
    const float sin_r = sin_i / ior_, cos_r = std::sqrt(std::max(0.0f, 1.0f - sin_r * sin_r));
    // Of i - r, then of twice that.
    const float sine = sin_i * cos_r - cos_i * sin_r, cosine = cos_i * cos_r + sin_i * sin_r;
    return {2.0f * sine * cosine, cosine * cosine - sine * sine, formulas::fresnel_reflectance(cos_i, ior_)};
  }
  /// Mean radiance over the ball's disc for an irradiance of one, 1/sr; integrates to one over all directions.
  /// @param cosine  between the ray from the eye and the direction towards the light
  float phase(float cosine) const;

 private:
  static constexpr int kSteps = 128;
  float ior_;
  std::array<float, kSteps> phase_{};
};

/// Where a body of water sends the ray that meets it at one place of its surface.
struct BodyRays {
  vec3 exit{0.0f};              ///< unit, where the refracted ray goes
  vec3 mirror_direction{0.0f};  ///< unit
  float straight = 1;           ///< cosine between `exit` and the viewing ray
  float mirrored = 0;           ///< Fresnel reflectance
};

/// The same of a jet, which bends light less than a ball: it is flat and bumpy.
struct JetRays {
  BodyRays body;
  float scattered = 0;  ///< part of what is not mirrored that comes from in_jets() instead of `exit`
};
/// Part of the slope of their sides that jets are lit with: in the mean they are round, and small ones drawn as such.
constexpr float kLeanOfPiles = 0.3f;

/// Light on the pieces of one picture. What small balls and jets show in the mean over their width hardly changes
/// across a picture and is looked up in a coarse grid of it.
class RainLight {
 public:
  RainLight(const View& view, const Surroundings& surroundings, float ior);

  const BallOptics& ball_optics() const { return optics_; }
  const Surroundings::Parts& parts() const { return *parts_; }
  /// Mean over a ball's disc without sun and lamps. @param place  px
  vec3 ball(vec2 place) const;
  /// Mean over the width of a jet whose axis has this direction in the picture (px, y downwards, any length).
  vec3 jet(vec2 place, vec2 axis) const;
  /// Sun and lamps in a ball or jet, in the mean over its disc.
  /// @param direction  unit, from the eye to the point
  vec3 lamps(vec3 point, vec3 direction) const;
  bool has_lamps() const { return !parts_->lamps.empty() || parts_->sun_irradiance != vec3{0.0f}; }

  /// Rays at a place whose unit normal is `normal`; turned to the eye if it looks away.
  BodyRays rays(vec3 direction, vec3 normal) const;
  JetRays jet_rays(vec3 direction, vec3 normal) const;
  /// Light that jets scatter: half from everywhere, half from where their tips point, as it comes down in them.
  vec3 in_jets(vec3 up) const { return 0.5f * (parts_->mean + parts_->radiance(up, 0.9f)); }
  /// Sun and lamps at a point through the body and in its mirror. @param variance  rad^2, of the rays of a pixel
  vec3 glare(const BodyRays& body, vec3 point, float variance) const;

 private:
  static constexpr int kColumns = 7, kRows = 5, kAngles = 8;
  struct Node {
    vec3 ball{0.0f};
    std::array<vec3, kAngles> jets{};
  };
  struct Corner {
    std::size_t node;
    float weight;
  };
  std::array<Corner, 4> corners(vec2 place) const;

  BallOptics optics_;
  const Surroundings* surroundings_;
  const Surroundings::Parts* parts_;
  float width_, height_;
  std::vector<Node> nodes_;
};

}  // namespace meniscus
