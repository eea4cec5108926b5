/// Water surfaces: whatever represents the water, it answers what of it is seen through a view.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "meniscus/base.h"

namespace meniscus {

/// What of the water is seen through a view. All images have the view's size, or N x 1 when a list of N
/// picture points was asked for.
struct SurfaceBuffers {
  Image<float> depth;         ///< distance along the ray to the surface, m; +infinity where there is no water
  Image<vec3> normal;         ///< unit, world space, out of the water; zero where there is no water
  Image<float> thickness;     ///< water along the ray, m; >= 0, may be > 0 beside the surface's silhouette
  Image<vec3> colour;         ///< linear; an empty image unless the particles carry colours
  Image<float> coverage;      ///< 1 where there is water, 0 elsewhere; fractions only after averaging
  bool eye_in_water = false;  ///< rays start inside: depth is where they leave the water
  /// Where each pixel's ray may first and last meet water, m along the ray; what refine() starts from. Empty where that
  /// does not need them.
  Image<float> entry, exit;
  /// Normals as they were before small waves bent them: what refine() starts from instead of `normal`. Empty where
  /// nothing bent them.
  Image<vec3> unbent_normal;
};

/// Where a ray crosses a surface.
struct Crossing {
  float distance = std::numeric_limits<float>::infinity();  ///< m along the ray; infinity: nowhere
  vec3 normal{0.0f};                                        ///< unit, out of the water; zero: nowhere
};

struct HeightField;

/// A water surface.
class Surface {
 public:
  virtual ~Surface() = default;

  /// What is seen through the view: at the pixel centres, or at `points` (picture coordinates, px), when the
  /// list is not empty. Sixteen consecutive points are cheapest when they lie close together.
  virtual SurfaceBuffers see(const View& view, std::span<const vec2> points = {},
                             StageTimes* times = nullptr) const = 0;

  /// The same at `points` of a view that has been seen already: cheaper than see(), for points near the
  /// silhouettes of `coarse`, which is what see(view) returned. N x 1 buffers.
  virtual SurfaceBuffers refine(const View& view, const SurfaceBuffers& coarse, std::span<const vec2> points,
                                StageTimes* times = nullptr) const {
    static_cast<void>(coarse);
    return see(view, points, times);
  }

  /// Only the thickness of what see() returns: water along the ray, m.
  virtual Image<float> thickness(const View& view, std::span<const vec2> points = {},
                                 StageTimes* times = nullptr) const = 0;

  /// Edge of the cube of water that one particle stands for, m: the surface is not known more closely. 0: not made of
  /// particles, or not known.
  virtual float spacing() const { return 0; }

  /// Whether rays in any direction can be followed through the water, by crossings().
  virtual bool can_march() const { return false; }

  /// The first place, `from[i]` m from its origin or farther and no farther than `limit[i]`, where ray i crosses the
  /// surface: into the water, or out of it where inside[i] != 0. A ray that is not where `inside` says (by rounding
  /// near the surface) crosses at the first true change if it comes to that side soon, within about a spacing of the
  /// particles, else where it starts. Consecutive rays are cheapest when they lie close together.
  /// All spans have the same length.
  /// @throws Error unsupported: a surface that cannot march
  virtual void crossings(std::span<const Ray> rays, std::span<const float> from, std::span<const float> limit,
                         std::span<const std::uint8_t> inside, std::span<Crossing> found) const;

  /// A box that holds all of the surface; empty when there is no water.
  virtual Bounds bounds() const = 0;

  /// The columns that the surface is made of, if it is a height field; else null.
  virtual const HeightField* height_field() const { return nullptr; }
};

// --- Ray-cast surfaces [Xiao2017] --------------------------------------------------------------------------

enum class Kernel { cubic_spline, poly6, wyvill };
enum class NormalMethod { gradient, pca, blend };
enum class Refinement { secant, bisection };

/// Names as on the command line. @throws Error invalid_argument listing the known ones
Kernel kernel_of(std::string_view name);
NormalMethod normal_method_of(std::string_view name);
Refinement refinement_of(std::string_view name);

/// How the iso-surface of the particles' density is found and smoothed. Lengths of 0 mean the default.
struct RaycastOptions {
  float spacing = 0;           ///< m; edge of the cube of water that one particle stands for; required, > 0
  float smoothing_length = 0;  ///< m; support of the kernel; default 2 spacings
  Kernel kernel = Kernel::cubic_spline;
  float iso = 0.5f;    ///< density of the surface as a fraction of that inside the water, in (0, 1)
  float step = 0.25f;  ///< of the march, in smoothing lengths, in (0, 1]
  Refinement refinement = Refinement::secant;
  int refinement_steps = 2;  ///< evaluations after the crossing has been bracketed, 0 .. 32
  NormalMethod normals = NormalMethod::blend;
  float normal_radius = 0;         ///< m; R of eq. 2 to 4; default 3 spacings
  float blend_sharpness = 10;      ///< d of eq. 6
  float blend_agreement = 0.998f;  ///< k of eq. 6
  int filter_radius = 4;           ///< px; the bilateral filter of the normals has (2 n + 1)^2 taps; 0 switches it off
  /// Particles with few neighbours (drops, jets, torn sheets) stand for more than their kernel shows: their
  /// mass in eq. 1 grows until a lone particle is a drop of its own volume. Off: unit masses as in the paper.
  bool keep_thin = true;
  bool cull_interior = true;  ///< do not splat particles that cannot be seen; the picture is the same
  bool want_thickness = true;
  bool want_normals = true;
};

/// Sizes of single particles, for clouds of unequal ones. Either may be empty.
struct ParticleSizes {
  /// m, one a particle, > 0: edge of the cube of water that it stands for (twice its radius); else that of the options.
  std::span<const float> spacing;
  /// m, one a particle: support of its kernel; else its spacing times that of the options by theirs.
  std::span<const float> smoothing_length;

  bool empty() const { return spacing.empty() && smoothing_length.empty(); }
};

/// The iso-surface of the particles' density, cast along rays.
/// @param colours  one linear colour a particle, or empty
/// @param sizes    read during the call only; the radius of the normals follows a particle's spacing
/// @throws Error   invalid_argument: an option outside its range, colours or sizes of another number than the
/// particles,
///                 sizes outside their range
std::unique_ptr<Surface> make_raycast_surface(const Particles& particles, const RaycastOptions& options,
                                              std::span<const vec3> colours = {}, StageTimes* times = nullptr,
                                              const ParticleSizes& sizes = {});

/// The same surface by the plain method: every particle splatted, every sum by one scalar loop over the cells
/// around a sample, one ray after another on the calling thread. What the fast one is checked and timed against.
std::unique_ptr<Surface> make_plain_raycast_surface(const Particles& particles, const RaycastOptions& options,
                                                    std::span<const vec3> colours = {}, StageTimes* times = nullptr,
                                                    const ParticleSizes& sizes = {});

/// What a ray-cast surface would take, before it is made.
struct RaycastEstimate {
  std::uint64_t build_bytes = 0;  ///< at most held at once while it is made, beside the particles
  std::uint64_t kept_bytes = 0;   ///< by the finished surface
  std::uint64_t view_bytes = 0;   ///< more, while it is seen through a view of `pixels`, its buffers included
  /// Operations in units that a machine's speed can be set against: particles gone through, particles kept, pixels.
  double particles = 0, kept = 0, pixels = 0;
};
/// @param count   particles
/// @param bounds  m, of them
/// @param pixels  of the view
RaycastEstimate estimate_raycast(std::uint64_t count, const Bounds& bounds, const RaycastOptions& options,
                                 std::uint64_t pixels);

// --- Point-sampled surfaces [Iwasaki2008] --------------------------------------------------------------------

/// Points of a regular grid: point (i, j, k) is low + (i, j, k) * step.
struct DensityGrid {
  vec3 low{0.0f};   ///< m
  vec3 step{0.0f};  ///< m between neighbouring points along each axis, > 0
  int nx = 0, ny = 0, nz = 0;
  std::size_t size() const {
    return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz);
  }
};

/// Particles as the density is summed from: relative density rho(x) = spacing^3 sum_j m_j W(|x - p_j|, h), which is
/// one inside a lattice of that spacing.
struct DensityOptions {
  float spacing = 0;           ///< m, > 0
  float smoothing_length = 0;  ///< m; 0: 2 spacings
  Kernel kernel = Kernel::wyvill;
  bool keep_thin = true;  ///< masses as in RaycastOptions
  float iso = 0.5f;       ///< of the surface that those masses are made for; no matter else
};

/// The density at every point of a grid, x fastest, then y, then z: metaball discs splatted slab by slab, four planes
/// at a time, over particles clustered by z.                                             [Iwasaki2008] 4.1, 4.2
/// @param on_slab  called for k = 0, 4, 8, ... in rising order with up to four planes of nx * ny values each, one after
///                 another; the memory is used again for later slabs
/// @param working_bytes  if not null: the largest memory that was held for slabs and clusters at once
/// @throws Error   invalid_argument: sizes < 2, steps <= 0; limit_exceeded: more than 2^31 points in a plane
void splat_density(const Particles& particles, const DensityOptions& options, const DensityGrid& grid,
                   FunctionRef<void(int k, int planes, std::span<const float> values)> on_slab,
                   StageTimes* times = nullptr, std::size_t* working_bytes = nullptr);
/// The whole field at once.
std::vector<float> splat_density(const Particles& particles, const DensityOptions& options, const DensityGrid& grid,
                                 StageTimes* times = nullptr);
/// The plain sum in double precision, one thread, one particle after another: what the fast one is checked against.
std::vector<double> plain_density(const Particles& particles, const DensityOptions& options, const DensityGrid& grid);

/// A disc on the surface.
struct Surfel {
  vec3 position;  ///< on the iso-surface, m
  vec3 normal;    ///< unit, out of the water
  float radius;   ///< m; neighbours' discs overlap, so that no gap remains
  /// 1/m, mean curvature: 0 for a flat disc, > 0 where the water bulges. The disc is drawn bent, so that it does not
  /// stick out of drops: as the cap of a ball of radius 1 / curvature where bend is zero.
  float curvature = 0;
  /// 1/m, half the difference of the two principal curvatures, in the tangent direction of the larger one: on a
  /// cylinder across its axis and as long as curvature. Zero where the surface is bent alike in all directions.
  vec3 bend{0.0f};
};

struct SurfelOptions {
  float spacing = 0;           ///< m; required, > 0
  float smoothing_length = 0;  ///< m; 0: 2 spacings
  Kernel kernel = Kernel::wyvill;
  float iso = 0.5f;         ///< as in RaycastOptions
  float grid_step = 0;      ///< m between points of the grid; 0: half a spacing
  float gap_threshold = 0;  ///< m between neighbours beyond which points are added; 0: 1.5 grid steps
  float epsilon = 0;        ///< m; discs this close in depth are blended; 0: one spacing
  bool keep_thin = true;
  bool want_thickness = true;
  /// What a surface made of surfels is shaded with: normals of [Xiao2017] at the surfels, blended by eq. 2 and filtered
  /// in the picture. `gradient` and a filter of 0 px: the surfels' own normals, as in the paper, with all ripple.
  NormalMethod normals = NormalMethod::blend;
  int filter_radius = 4;  ///< px; as in RaycastOptions
};

/// Surfels on the iso-surface of the particles' density.                                 [Iwasaki2008] 4.3
/// @throws Error invalid_argument, limit_exceeded
std::vector<Surfel> extract_surfels(const Particles& particles, const SurfelOptions& options,
                                    StageTimes* times = nullptr);

/// The surface splatted from surfels: back faces culled, a depth pass with the offset epsilon, Gaussian-weighted
/// normals and depths.                                                                  [Iwasaki2008] 5.1.1, 5.2
/// @param colours  one linear colour a particle, or empty
std::unique_ptr<Surface> make_surfel_surface(const Particles& particles, const SurfelOptions& options,
                                             std::span<const vec3> colours = {}, StageTimes* times = nullptr);
/// The same from surfels that are there already; it has no thickness and cannot be marched.
std::unique_ptr<Surface> make_surfel_surface(std::vector<Surfel> surfels, float epsilon);

// --- Height fields [Cords2008] -------------------------------------------------------------------------------

/// Water as columns over a floor: heights at the points of a regular horizontal grid, between them bilinear.
///
/// Point (i, j) lies at low + step * (i a + j b) of the plane, a and b being the horizontal axes in the order x, y, z
/// (x and z where y is up). Points of the border lie on the border: the field ends at its outermost points.
struct HeightField {
  Axis up = Axis::y;
  vec2 low{0.0f};   ///< m along a and b, of point (0, 0)
  vec2 step{0.0f};  ///< m between points along a and b, > 0
  float floor = 0;  ///< m along up; water stands on it
  /// m along up, width points along a, height points along b; -infinity where there is no water.
  Image<float> height;
  Image<vec3> normal;  ///< unit, out of the water, world space; up where there is no water
  Image<vec3> colour;  ///< linear; empty unless the particles carry colours
  float spacing = 0;   ///< m, of the particles it is made of; 0: none

  bool empty() const { return height.empty(); }
  /// Box of the water, m.
  Bounds bounds() const;
  /// A point of the grid in the world at height `level`.
  vec3 point(float i, float j, float level) const;
  /// Coordinates of a world point in grid steps: (i, j).
  vec2 grid_point(vec3 point) const;
  /// Height and normal between the points of the grid; a hole where all four points around are holes or the place lies
  /// beyond the border by more than 1e-3 steps.
  struct Sample {
    float height = -std::numeric_limits<float>::infinity();
    vec3 normal{0.0f};
    bool water() const { return height > -std::numeric_limits<float>::infinity(); }
  };
  Sample at(float i, float j) const;
};

/// How a height field is found in particles. Lengths of 0 mean the default.
struct HeightFieldOptions {
  float spacing = 0;     ///< m; required, > 0
  float iso_radius = 0;  ///< m; h of eq. 5, reach of a particle's potential
  float iso = 0;         ///< of the potential at the surface; default so that still water keeps its level
  float step = 0;        ///< m between columns; default half a spacing
  float smoothing = -1;  ///< m, standard deviation of a Gaussian over the heights; negative: default; 0: none
  float drop = 0;        ///< m; water thinner than this with air under it is left out; default 4 spacings
  Axis up = Axis::y;
  Bounds region;  ///< m; where there can be water: the tank's inside; empty: the particles' own bounds
  /// Columns that a solid fills at the water's level: the field goes on through it, so that there is no gap around it.
  /// Called with points of the raw surface; null: there are no solids.
  std::function<bool(vec3)> in_solid;
  bool want_normals = true;
};

/// Heights where the potential of eq. 5 falls below the iso-value, column by column from above, without a grid in
/// space.                                                                               [Cords2008] eq. 5, 6
/// @param colours  one linear colour a particle, or empty
/// @throws Error invalid_argument, limit_exceeded: more columns than the region can justify
HeightField height_field(const Particles& particles, const HeightFieldOptions& options,
                         std::span<const vec3> colours = {}, StageTimes* times = nullptr);

/// What is seen of any surface from straight above.
/// @param region  m; of the columns; floor: its lower end along up
/// @throws Error invalid_argument
HeightField height_field_of(const Surface& surface, Axis up, const Bounds& region, float step);

/// One train of waves.
struct WaveTrain {
  enum class Kind { sine, gerstner } kind = Kind::sine;
  float amplitude = 0.02f;  ///< m, >= 0
  float wavelength = 0.5f;  ///< m, > 0
  float direction_deg = 0;  ///< the way it runs, from a towards b
  float phase_deg = 0;      ///< at time 0
  float speed = 0;          ///< m/s; 0: of gravity waves over the depth, omega^2 = g k tanh(k depth)
  float steepness = 0.8f;   ///< gerstner: 0 a sine, 1 the sharpest crests that do not fold
};

/// Superposed waves on still water.
struct WaveFieldOptions {
  std::vector<WaveTrain> waves;
  Axis up = Axis::y;
  Bounds region{{0, 0, 0}, {2, 0.5f, 2}};  ///< m, of the still water: its upper end is the level
  float step = 0;                          ///< m; 0: an eighth of the shortest wave, at least 256th of the longer side
};
/// @throws Error invalid_argument: a wave outside its range; limit_exceeded
HeightField height_field(const WaveFieldOptions& options, double time);

/// Heights from a picture: 0 is the region's lower end along up, 1 its upper. The first row is the far end of b.
/// @throws Error invalid_argument
HeightField height_field(const Image<float>& picture, Axis up, const Bounds& region, float smoothing = 0);

/// Normals anew from the heights, where these have been changed.
void find_normals(HeightField& field);

/// A part of a field that is bent towards a plane.                                      [Cords2008] 2.2
struct PlaneAdaptation {
  vec3 point{0.0f};      ///< of the plane, m
  vec3 normal{0, 1, 0};  ///< of the plane, unit
  /// Horizontal outline, a convex polygon in grid-free coordinates along a and b, m: inside it the surface is the
  /// plane.
  std::vector<vec2> outline;
  float width = 0;  ///< m beyond the outline over which the field returns linearly to itself, > 0
};
/// Heights and normals of the field, bent. Where several reach, they are weighted.
void adapt(HeightField& field, std::span<const PlaneAdaptation> planes);

/// The water between floor and heights as a surface; it can be marched.
/// @param sides  whether the water's vertical sides at the border of the field and of holes are surface too: false only
///               where solid walls stand there that are never seen through
/// @param want_thickness  false: see() leaves the thickness zero; thickness() still tells it
std::unique_ptr<Surface> make_height_field_surface(HeightField field, bool sides = true, bool want_thickness = true);

// --- Water in the rain ---------------------------------------------------------------------------------------

/// A surface whose normals are bent as small waves on it would bend them, where it looks up.
/// @param ripples  `height` is m over the surface, 0 at rest; `floor` does not matter; nothing beyond its border
std::unique_ptr<Surface> make_rippled_surface(std::unique_ptr<Surface> water, HeightField ripples);

/// Water and, apart from it, puddles: whichever is nearer is seen. Either may be without water.
/// @param puddles  without sides: solid ground stands around them
std::unique_ptr<Surface> make_joint_surface(std::unique_ptr<Surface> water, HeightField puddles);

// --- Particles as they are ---------------------------------------------------------------------------------

/// One ball a particle, no surface between them: a look at the raw particles.
/// @param radius   m, > 0
/// @param colours  one linear colour a particle, or empty
/// @throws Error   invalid_argument: radius <= 0, colours of another number than the particles
std::unique_ptr<Surface> make_sphere_surface(const Particles& particles, float radius,
                                             std::span<const vec3> colours = {});

// --- Instruction sets --------------------------------------------------------------------------------------

/// Names of the instruction sets that this processor can run, best first ("avx3", "avx2", "sse4", ...).
std::vector<std::string> instruction_sets();
/// Makes the vectorised loops use one of them from now on; "best" goes back to the best one.
/// @throws Error invalid_argument listing those that there are
void use_instruction_set(std::string_view name);

}  // namespace meniscus
