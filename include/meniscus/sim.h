/// Water that is simulated: smoothed particles or position based fluids in a tank, with obstacles that can be moved;
/// rain and what it does to the ground.
///
/// World space is the tank's own space: a tank that is tilted stays where it is and gravity turns.
#pragma once

#include <cstdint>
#include <functional>
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

// --- Ground in the rain [Mizukami2013] -----------------------------------------------------------------------

enum class GroundMaterial : std::uint8_t { concrete, asphalt, steel };
/// @throws Error invalid_argument
GroundMaterial ground_material_of(std::string_view name);
std::string_view name_of(GroundMaterial material);

/// How much water is on a place, as the splashes are chosen by it.                       [Mizukami2013] table 1
enum class Wetness {
  dry,          ///< it still soaks up water; steel: drops stand apart on it, less than 0.02 mm
  wet,          ///< saturated, less than 3 mm of water on it
  puddle_3mm,   ///< 3 mm and more
  puddle_5mm,   ///< 5 mm and more
  puddle_10mm,  ///< 10 mm and more, and any deep water
};
std::string_view name_of(Wetness wetness);

/// Ground as square cells. a and b are the horizontal axes in the order x, y, z, as in HeightField.
struct GroundOptions {
  Axis up = Axis::y;
  vec2 low{0.0f}, high{0.0f};  ///< m along a and b; required; the cells cover at least this
  float cell = 0.02f;          ///< m, edge of a cell, > 0
  float level = 0;             ///< m along up, of cells of height 0
  GroundMaterial material = GroundMaterial::asphalt;
  /// Stretched over low .. high, pixel beside pixel; the nearest counts. The first row is the far end of b. Empty:
  /// `material`.
  Image<GroundMaterial> materials;
  /// m above `level`, stretched alike: a pixel's height is that of its middle, bilinear between, constant beyond the
  /// outermost middles. May be empty.
  Image<float> heights;
  /// m, standard deviation of noise on the heights; negative: that of each material, concrete 0.3 mm, asphalt 1 mm,
  /// steel 0.02 mm.
  float roughness = -1;
  float roughness_length = 0.1f;  ///< m, of the largest bumps of that noise
  std::uint64_t seed = 1;         ///< of the noise
};

/// Where all the water has gone, m^3. fallen = soaked + standing + drained, to rounding.
struct WaterBudget {
  double fallen = 0;    ///< given by add() and rain()
  double soaked = 0;    ///< in the ground
  double standing = 0;  ///< on it
  double drained = 0;   ///< over the border
};

/// Which cells are how wet, and how water goes from one to the next.                     [Mizukami2013] 3.1.2, 4.6.1
///
/// A cell's water stands at the level H = bed + depth. Concrete soaks up 0.5 mm, asphalt 0.8 mm, steel nothing; what
/// comes to a cell soaks in first. docs/rain.md says more.
class WetGround {
 public:
  /// @throws Error  invalid_argument: an option outside its range; limit_exceeded: more than 2^26 cells
  explicit WetGround(GroundOptions options);
  const GroundOptions& options() const { return options_; }
  int width() const { return width_; }    ///< cells along a
  int height() const { return height_; }  ///< cells along b
  std::size_t size() const { return bed_.size(); }
  /// Index i + width() * j of the cell that holds the point's place; none outside.
  std::optional<std::size_t> cell_at(vec3 point) const;
  /// Middle of a cell at the ground's height, m.
  vec3 place(std::size_t cell) const;
  GroundMaterial material(std::size_t cell) const { return material_[cell]; }
  float bed(std::size_t cell) const { return bed_[cell]; }         ///< m along up, of the ground
  double depth(std::size_t cell) const { return depth_[cell]; }    ///< m, of the water on it
  double soaked(std::size_t cell) const { return soaked_[cell]; }  ///< m of water in it
  double capacity(std::size_t cell) const;                         ///< m that it can soak up
  Wetness wetness(std::size_t cell) const;
  /// Water of one hit: soaks in; what is left, w m on one cell, is shared with the four neighbours by their levels
  /// before the hit.                                                                  [Mizukami2013] 4.6.1, fig. 7
  ///
  /// Of k neighbours that are lower than the cell, each gets w / k and the cell nothing, if the cell stands higher than
  /// all of them then would: H_0 > max(H_n) + w / k. Else the water fills the cell and its neighbours from the lowest
  /// up to one level, and those above it get nothing; five equal levels make fifths. With two neighbours these are the
  /// rules of fig. 7 b and a. Over the border lies ground as high as the cell's own, from which water is drained.
  /// @param volume  m^3, finite, >= 0
  /// @throws Error  invalid_argument
  void add(std::size_t cell, double volume);
  /// Water on all cells alike, m, finite, >= 0; soaks in first. Does not flow yet.
  /// @throws Error invalid_argument
  void rain(double depth);
  /// Water runs to lower neighbours for this long, s, as a sheet on rough ground does [Bates2010]; a film of 0.2 mm
  /// stays. In steps that are short enough for the deepest water that moves; where nothing moves costs next to nothing.
  /// After an hour, if it still moves, it is settled.
  /// @param seconds  finite, >= 0
  /// @throws Error   invalid_argument
  void flow(double seconds);
  /// Where water comes to rest: hollows filled level, the rest over the border; a film stays.  [Barnes2020]
  void settle();
  WaterBudget budget() const;

 private:
  /// Lets a cell soak up what it can of `depth` m and returns the rest.
  double soak(std::size_t cell, double depth);
  void share(std::size_t cell, double depth);
  void stir(std::size_t cell);
  void stir_all();
  double flow_step(double left);

  GroundOptions options_;
  int width_ = 0, height_ = 0;
  std::vector<float> bed_;
  std::vector<GroundMaterial> material_;
  std::vector<double> depth_, soaked_;
  double fallen_ = 0, drained_ = 0;
  // Of the flow: m^2/s through the sides of the cells, (width + 1) x height and width x (height + 1); the part of it
  // that the water of a cell can give; by tiles of cells: whether water has moved since, the deepest water, m.
  std::vector<double> along_a_, along_b_, part_;
  std::vector<std::uint8_t> stirred_;
  std::vector<double> deepest_;
};

// --- Splashes [Mizukami2013] ---------------------------------------------------------------------------------

enum class SplashKind {
  none,
  scattering,  ///< piles that fly out and let droplets go                                [Mizukami2013] 4.1
  crown_cone,  ///< a crown, then a cone that lets one drop go upwards                     [Mizukami2013] 4.2
  disk,        ///< the drop stays, flat                                                  [Mizukami2013] 4.3
};
std::string_view name_of(SplashKind kind);
/// By section 2.2 and table 1.
SplashKind splash_kind(GroundMaterial material, Wetness wetness);

enum class DropSize { small, medium, large };
DropSize drop_size_of(float diameter);  ///< m

/// What table 1 allows for a splash. Values are drawn from normal distributions cut off at the ends.
struct SplashRanges {
  int fewest = 0, most = 0;                                   ///< droplets that leave
  float lowest_deg = 0, highest_deg = 0;                      ///< shooting-out angle above the ground
  float slowest = 0, fastest = 0;                             ///< initial velocity, m/s
  float number_mean = 0, angle_mean_deg = 0, speed_mean = 0;  ///< of the distributions before they are cut
  float number_sigma = 0, angle_sigma_deg = 0, speed_sigma = 0;
};
/// @throws Error invalid_argument: a pair without droplets
SplashRanges splash_ranges(GroundMaterial material, Wetness wetness, DropSize size);

/// A drop that hits something.
struct Impact {
  std::uint64_t id = 0;     ///< all random numbers of its splash come from it
  double time = 0;          ///< s
  vec3 point{0.0f};         ///< m
  vec3 normal{0, 1, 0};     ///< unit, of what is hit
  vec3 velocity{0.0f};      ///< m/s, of the drop
  float diameter = 0.002f;  ///< m
  vec3 wind{0.0f};          ///< m/s, over the place
  GroundMaterial material = GroundMaterial::asphalt;
  Wetness wetness = Wetness::dry;
};

/// A droplet of a splash on its orbit: eq. 1 with the drag of its first moment, relative to the wind.
struct Droplet {
  vec3 start{0.0f};     ///< m
  vec3 velocity{0.0f};  ///< m/s, at its start
  float radius = 0;     ///< m; 0: a pile of a crown, which falls back whole
  float drag = 0;       ///< 1/s, F / (m V) at its start: F / m of eq. 1
  float leaves = 0;     ///< s after the impact: before, it is the tip of a pile
  float lands = 0;      ///< s after the impact: back on the plane of what was hit, or given up (most_time)
};

/// A splash as it goes on.
struct Splash {
  Impact impact;  ///< with a unit normal
  SplashKind kind = SplashKind::none;
  std::size_t first = 0, count = 0;  ///< of the droplets; by the time when they land; crown_cone: the cone's drop first
  float circle = 0;                  ///< m, radius of the initial circle; of the disk
  float width = 0;                   ///< m, half a diagonal of a pile's base
  float cone_starts = 0;             ///< s after the impact
  float ends = 0;                    ///< s after the impact
  float fastest = 0;                 ///< m/s, of any droplet on any part of its orbit, no less
  float reach = 0;                   ///< m from the point, of any of its pieces at any time, no less
};

/// A piece of a splash or of the rain, as it is drawn.
struct WaterPiece {
  enum class Kind : std::uint8_t {
    /// Quadrangular: `from` the middle of its square base, `to` its tip, `across` half a diagonal of the base; half the
    /// other one is the cross product of the unit vector from `from` to `to` and `across`.
    pyramid,
    sphere,  ///< `from` its centre, `radius`
    disk,    ///< `from` its centre, `across` its unit normal, `radius`
    streak,  ///< a drop that goes from `from` to `to` while the shutter is open, `radius`
  } kind = Kind::sphere;
  vec3 from{0.0f}, to{0.0f}, across{0.0f};  ///< m
  float radius = 0;                         ///< m
  float opacity = 1;                        ///< 0 .. 1: how much of it is there; nothing appears or goes at once
};

struct SplashOptions {
  vec3 up{0, 1, 0};             ///< unit
  vec3 gravity{0, -9.81f, 0};   ///< m/s^2
  float growth_time = 0.03f;    ///< s after which a pile lets its droplet go
  float growth_length = 0.02f;  ///< m from its start after which it does, whichever comes first
  float most_time = 2;          ///< s after which a splash is over in any case, >= 0.1; so long a disk stays
  float size = 1;          ///< factor of the lengths of piles, crowns and droplets as drawn; their water is the same
  bool secondary = false;  ///< droplets that land on water splash themselves, once: the caller adds their impacts
  std::uint64_t seed = 1;
};

/// A droplet that has come down.
struct Landing {
  double time = 0;  ///< s
  vec3 point{0.0f};
  double volume = 0;  ///< m^3
  float radius = 0;   ///< m
  float speed = 0;    ///< m/s
};

/// All splashes that are going on. What they look like at a time depends on impacts and time only, not on when it is
/// asked.
class Splashes {
 public:
  /// @throws Error invalid_argument
  explicit Splashes(const SplashOptions& options);
  /// Nothing where splash_kind() is none.
  /// @return m^3 that fly away from the place; they come down again as landings
  double add(const Impact& impact);
  /// The same for many, on all threads. @param flies  m^3, one an impact
  void add(std::span<const Impact> impacts, std::span<double> flies);
  /// What comes down after `from` and not after `until`, in order of time. Landings are dropped with their splash: ask
  /// up to a time before you retire it. What has not come down after most_time, because it was blown or fell from a
  /// wall, is handed back where it is then.
  std::vector<Landing> landings(double from, double until) const;
  /// Forgets splashes that are over at `time`.
  void retire(double time);
  std::size_t size() const { return splashes_.size(); }
  std::size_t droplets() const { return flying_; }
  /// The pieces at `time`, in the order in which the impacts were added.
  /// @param view    splashes that are smaller than a pixel of it become one sphere that covers as much of it; those out
  ///                of it are left out; null: all, whole
  /// @param pieces  they are put behind what is there
  void pieces(double time, const View* view, std::vector<WaterPiece>& pieces) const;

 private:
  SplashOptions options_;
  std::vector<Splash> splashes_;
  std::vector<Droplet> droplets_;
  std::size_t flying_ = 0;  ///< droplets of splashes_; droplets_ holds those of forgotten ones for a while as well
};

// --- Rain ------------------------------------------------------------------------------------------------------

struct WindOptions {
  vec3 velocity{0.0f};    ///< m/s, the mean
  float gust = 0;         ///< m/s, standard deviation of the speed along the mean (half of it across)
  float gust_period = 4;  ///< s, of the slowest gusts
  Axis up = Axis::y;      ///< gusts go along the two others
  std::uint64_t seed = 1;
  /// Points with the attribute "velocity", m/s, instead of `velocity`; between them interpolated, beyond them held.
  std::shared_ptr<const Particles> field;
};

/// The wind; gusts are the same everywhere, the field stands still.
class Wind {
 public:
  /// @throws Error invalid_argument: values that are not finite, a field without velocities
  explicit Wind(const WindOptions& options);
  vec3 at(vec3 point, double time) const;  ///< m/s
  bool still() const;                      ///< the same everywhere at all times
  bool uniform() const;                    ///< the same everywhere: without a field
  /// m that uniform wind carries what it carries from one time to another, either way round.
  glm::dvec3 carried(double from, double until) const;
  float gust_acceleration() const;  ///< m/s^2, standard deviation of that of the gusts
  float finest() const;             ///< m over which a field changes; infinity without one

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

/// How fast a drop of this diameter, m, falls in still air at sea level, m/s; >= 0.               [GunnKinzer1949]
float fall_speed(float diameter);

/// A drop of the rain, known by where and when it would reach the level if nothing stood in its way.
struct RainDrop {
  std::uint64_t id = 0;
  float diameter = 0;  ///< m
  double time = 0;     ///< s, at `place`
  vec3 place{0.0f};    ///< m, at the level
  float weight = 1;    ///< it brings the water of so many drops like it
};

struct RainOptions {
  float rate_mm_h = 10;      ///< mm of water an hour; 0: only `drops`
  float smallest_mm = 0.5f;  ///< diameters of the drops that are made one by one; smaller ones fall as mist
  float largest_mm = 6;
  Axis up = Axis::y;
  vec2 low{0.0f}, high{0.0f};                                 ///< m along a and b: where the drops reach `level`
  float level = 0;                                            ///< m along up
  float top = 8;                                              ///< m above `level` from which on drops are followed
  double start = 0;                                           ///< s
  double duration = std::numeric_limits<double>::infinity();  ///< s
  WindOptions wind;                                           ///< its `up` is that of the rain
  /// Part of the drops that is made; each of them brings the water of 1 / share. 0: as much as most_per_second allows.
  float share = 0;
  double most_per_second = 200000;
  /// Where it is looked at from at a time, s. Around that place all drops are made, farther away fewer, and of those
  /// the large ones first; each brings the water of those that are left out. Null: the same share everywhere.
  std::function<vec3(double)> eye;
  float whole_within = 4;       ///< m from the eye, horizontally
  std::vector<RainDrop> drops;  ///< beside the rain: single ones, by time and place; ids are given by Rain
  std::uint64_t seed = 1;
};

/// Rain with the sizes of [MarshallPalmer1948] that falls as fast as [GunnKinzer1949] measured, carried by the wind.
/// Any time can be asked for in any order.
class Rain {
 public:
  /// @throws Error  invalid_argument
  explicit Rain(const RainOptions& options);
  const RainOptions& options() const { return options_; }
  float share() const { return share_; }  ///< part of the drops that is made
  double drops_per_second()
      const;  ///< made ones, over the region, while it rains; with an eye: over its middle, in still air
  double rate_of_mist() const;  ///< m/s of water that falls in drops that are not made
  /// Drops that reach the level after `from` and not after `until`, in order of time; ids are theirs for ever.
  std::vector<RainDrop> arriving(double from, double until) const;
  /// Where the drop is at a time before (or after) it reaches the level.
  vec3 position(const RainDrop& drop, double time) const;
  vec3 velocity(const RainDrop& drop, double time) const;  ///< m/s
  /// The drop's way from the top down to the level as a chain of points with times, at least two; straight between.
  struct Way {
    std::vector<vec3> points;
    std::vector<double> times;
  };
  Way way(const RainDrop& drop) const;
  /// Water that the drop brings, m^3: its own times its weight.
  double volume(const RainDrop& drop) const;
  /// Fraction of light that all drops together take from a metre of a ray, 1/m.
  float extinction() const;
  const Wind& wind() const { return wind_; }

 private:
  struct Parts;
  RainOptions options_;
  Wind wind_;
  float share_ = 1;
  std::shared_ptr<const Parts> parts_;
};

// --- Ripples ---------------------------------------------------------------------------------------------------

struct RippleOptions {
  Axis up = Axis::y;
  vec2 low{0.0f}, high{0.0f};  ///< m along a and b
  float step = 0.01f;          ///< m between points
  float wavelength = 0.03f;  ///< m, of the waves whose speed is right at any depth; infinity: shallow water, c^2 = g h
  float surface_tension = 0.0728f;  ///< N/m
  float damping = 2;                ///< 1/s, of the waves' heights
  float strength = 1;               ///< factor of what a hit does
};

/// Small waves on thin water: u_tt = div(c^2 grad u) - 2 damping u_t - damping^2 u on points over water, mirrored at
/// its shores, let out at the border of the grid.
class Ripples {
 public:
  /// @throws Error invalid_argument; limit_exceeded: more than 2^26 points
  explicit Ripples(const RippleOptions& options);
  const RippleOptions& options() const { return options_; }
  int width() const { return width_; }    ///< points along a, the first at low
  int height() const { return height_; }  ///< points along b
  vec3 place(int i, int j, float level) const;
  /// m of water under each point, i + width() j; none where <= 0. Waves that stood on what is dry now are lost.
  void set_depths(std::vector<float> depths);
  /// A drop falls in: a crater with a rim around it, without water made or lost on whole water.
  /// @param speed  m/s, downwards
  void hit(vec3 point, float diameter, float speed);
  void advance(double seconds);
  /// m over the still level, of each point.
  std::span<const float> heights() const { return {now_.data() + 1, now_.size() - 2}; }
  /// m/s, of rings on water of this depth.
  float speed(float depth) const;
  double energy() const;  ///< m^4/s^2: potential and kinetic together, per rho; only falls without hits
  double inner_step() const { return step_; }  ///< s, that advance() has gone by; 0: there is no water

 private:
  void set_step(double seconds);
  void step(double seconds, double decay, bool border);
  std::size_t padded(int i, int j) const {  ///< index of a point in speeds2_
    return static_cast<std::size_t>(i + 1) + static_cast<std::size_t>(width_ + 2) * static_cast<std::size_t>(j + 1);
  }
  RippleOptions options_;
  int width_ = 0, height_ = 0;
  std::vector<float> depths_;
  std::vector<float> speeds2_;       ///< m^2/s^2; 0 around the grid, where they have a point more
  std::vector<float> now_, before_;  ///< m, after one unused; before: one inner step ago
  std::vector<float> keeps_;         ///< part of a step's change that damping near the border lets through
  std::vector<std::uint8_t> wet_tiles_, moving_tiles_;
  double limit_ = 0;  ///< s, that an inner step may last
  double step_ = 0;   ///< s, of the last inner steps
  double left_ = 0;   ///< s not yet advanced
};

}  // namespace meniscus
