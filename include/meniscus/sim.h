/// Water that is simulated: smoothed particles or position based fluids in a tank, with obstacles that can be moved.
///
/// World space is the tank's own space: a tank that is tilted stays where it is and gravity turns.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

// --- What is simulated ---------------------------------------------------------------------------------------

enum class Solver {
  sph,  ///< smoothed particle hydrodynamics with a gas pressure [Muller2003]: small tanks, small steps
  pbf,  ///< position based fluids [Macklin2013]: large tanks, large steps
};
/// @throws Error invalid_argument
Solver solver_of(std::string_view name);

/// The liquid and how it is solved. Numbers of 0 mean the default.
struct FluidOptions {
  Solver solver = Solver::sph;
  float spacing = 0;           ///< m; edge of the cube of water that one particle stands for; required, > 0
  float smoothing_length = 0;  ///< m; support of the kernels; default 2 spacings
  float step = 0;              ///< s; default 0.003 for sph (less for small spacings), 1/120 for pbf
  float rest_density = 1000;   ///< kg/m^3
  float stiffness = 0;         ///< sph: k of p = k (rho - rho_0), m^2/s^2; default as stiff as the step allows
  float viscosity = -1;        ///< sph: Pa s (of the model); pbf: c of XSPH, 0 .. 1; negative: default
  float surface_tension = -1;  ///< sph: N/m (of the model); negative: default
  int iterations = 4;          ///< pbf: of the density constraint in each step, 1 .. 64; one is taken as two
  float vorticity = -1;        ///< pbf: of the vorticity confinement; negative: default
  vec3 gravity{0, -9.81f, 0};  ///< m/s^2
};

/// Place and turn of a rigid body: world = rotation * body + position.
struct Pose {
  vec3 position{0.0f};                         ///< m
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};  ///< unit; w, x, y, z
};

/// A solid's shape around its own origin, its centre of mass.
struct ObstacleShape {
  enum class Kind { box, sphere, cylinder, mesh } kind = Kind::box;
  vec3 size{1.0f};  ///< m; box: edges; sphere: x is the diameter; cylinder along y: x is the diameter, y the length
  std::vector<vec3> positions;         ///< mesh: a closed surface, normals outwards, m
  std::vector<std::uint32_t> corners;  ///< mesh: three a triangle
};

struct PoseKey {
  double time = 0;  ///< s
  Pose pose;
};

struct ObstacleOptions {
  ObstacleShape shape;
  Pose pose;                  ///< at the start
  std::vector<PoseKey> path;  ///< scripted: rising times, smooth between; still before the first and after the last
  bool dynamic = false;       ///< moved by water and gravity; boxes, spheres and upright cylinders
  float density = 500;        ///< kg/m^3, of dynamic ones, > 0
  double appears = 0;         ///< s; not there before: how an object is dropped in
};

// --- Interaction ---------------------------------------------------------------------------------------------

/// A jet of water that comes out of a disc.
struct Pour {
  double from = 0, until = 0;  ///< s
  vec3 at{0.0f};               ///< centre of the disc, m
  vec3 velocity{0, -1, 0};     ///< m/s; the disc faces this way
  float radius = 0.05f;        ///< m
};
/// Water within a cylinder is driven around its axis.
struct Stir {
  double from = 0, until = 0;  ///< s
  vec3 centre{0.0f};           ///< m
  vec3 axis{0, 1, 0};
  float radius = 0.1f;  ///< m
  float speed = 1;      ///< m/s at the radius that the water is drawn towards; either sign
};
/// The tank leans over about an axis, and comes back.
struct Tilt {
  double from = 0, until = 0;  ///< s; upright before and after
  vec3 axis{0, 0, 1};
  float angle = 0.2f;  ///< radians, at the middle; sin^2 in time
};
/// An obstacle is drawn to a place and let stand there.
struct Drag {
  double from = 0, until = 0;  ///< s
  std::size_t obstacle = 0;    ///< a dynamic one is held meanwhile, and let go afterwards
  vec3 to{0.0f};               ///< m; of its origin
};

struct SimulationOptions {
  FluidOptions fluid;
  Bounds tank;  ///< m; its walls go up without end, so that nothing escapes
  Axis up = Axis::y;
  std::vector<Bounds> blocks;  ///< m; of water at the start, on a lattice; obstacles are left out
  std::vector<ObstacleOptions> obstacles;
  std::vector<Pour> pours;
  std::vector<Stir> stirs;
  std::vector<Tilt> tilts;
  std::vector<Drag> drags;
  std::size_t most_particles = 10'000'000;  ///< a jet stops there
};

// --- The simulation --------------------------------------------------------------------------------------------

/// A live tank. The same options and calls give the same bits on any number of threads.
class Simulation {
 public:
  /// @throws Error  invalid_argument: an option outside its range, a mesh that cannot be an obstacle, a tank without
  ///                room; limit_exceeded: more particles than most_particles
  explicit Simulation(SimulationOptions options);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// One step of step_size() seconds.
  void step(StageTimes* times = nullptr);
  /// As many steps as bring the time nearest to `seconds` later than it is; with most_steps > 0 no more than those: the
  /// water is slowed rather than the picture.                                                   [Cords2008] 4
  void advance(double seconds, int most_steps = 0, StageTimes* times = nullptr);

  double time() const;      ///< s
  float step_size() const;  ///< s
  std::size_t steps() const;
  std::size_t size() const;  ///< particles
  /// Positions with the attribute "velocity" (m/s), in the order in which they were made; spacing, up and time are set.
  Particles particles() const;
  std::size_t obstacles() const;
  Pose pose(std::size_t obstacle) const;
  bool present(std::size_t obstacle) const;  ///< it has appeared
  float mean_neighbours() const;             ///< of a particle within the smoothing length, itself not counted
  double kinetic_energy() const;             ///< J, of the water
  double potential_energy() const;           ///< J, of the water over the tank's floor

  /// Interaction at any time; what lies in the past is over already.
  void pour(const Pour& pour);
  void stir(const Stir& stir);
  void tilt(const Tilt& tilt);
  void drag(const Drag& drag);
  /// An obstacle is at `pose` from the next step on and moves there within it: what follows a mouse.
  void move(std::size_t obstacle, const Pose& pose);
  /// Another obstacle; its index.
  std::size_t add(const ObstacleOptions& obstacle);
  void add_water(const Bounds& block);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace meniscus
