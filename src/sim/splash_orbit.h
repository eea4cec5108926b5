/// Orbits of droplets through air: how strongly it brakes them, when they leave and land, and the same orbit step by
/// step.
#pragma once

#include "meniscus/sim.h"

namespace meniscus {

/// Air and water at 20 degrees C and 1013 hPa.
inline constexpr float kAirDensity = 1.204f;       ///< kg/m^3
inline constexpr float kAirViscosity = 1.825e-5f;  ///< Pa s
inline constexpr float kWaterDensity = 998.2f;     ///< kg/m^3

/// F / (m V) of a drop, 1/s: what eq. 1 calls F / m.                                    [Mizukami2013] eq. 2 to 4
float air_drag(float speed, float diameter);

/// Speed at which a drop falls when it no longer gets faster, m/s: F = m g by eq. 2 to 4. Lift by the air is left out
/// as in the paper (0.06 % of the speed).
/// @param diameter  > 0, m
/// @param gravity   > 0, m/s^2
float terminal_speed(float diameter, float gravity = 9.81f);

/// What moves a droplet.
struct Orbit {
  vec3 velocity{0.0f};         ///< m/s, at the start
  vec3 wind{0.0f};             ///< m/s
  vec3 gravity{0, -9.81f, 0};  ///< m/s^2
  float drag = 0;              ///< 1/s
};

/// First time after the start at which the droplet is back on the plane through its start, s; `latest` if that is
/// later or never.
/// @param normal  unit, of the plane; the velocity along it > 0
float landing_time(const Orbit& orbit, vec3 normal, float latest);

/// First time at which the droplet is `distance` m from its start, s; `latest` if that is later.
float leaving_time(const Orbit& orbit, float distance, float latest);

/// A droplet at a moment of its stepped orbit.
struct OrbitState {
  vec3 offset{0.0f};    ///< m, from the start
  vec3 velocity{0.0f};  ///< m/s
};

/// How the drag of a stepped orbit is found.
enum class SteppedDrag {
  anew,  ///< C_d by eq. 3 and 4 from each step's own speed
  held,  ///< F / (m V) of the start, as in the closed form
};

/// The orbit by eq. 5, 6 and 7 in steps of dt.
///
/// As printed, eq. 5, a = -C_d rho S V / (2 m), is 1/m times m/s; a force by eq. 2 goes as V^2, so it is read as
/// a = -C_d rho S |V| V / (2 m) with V against the wind, and gravity, which it leaves out, is added.
/// @param diameter  > 0, m
/// @param time, dt  > 0, s; the last step is cut to end at `time`
OrbitState stepped_orbit(const Orbit& orbit, float diameter, double time, double dt,
                         SteppedDrag drag = SteppedDrag::anew);

}  // namespace meniscus
