/// Water surfaces: whatever represents the water, it answers what of it is seen through a view.
#pragma once

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
  /// Where each pixel's ray may first and last meet water, m along the ray; what refine() starts from.
  Image<float> entry, exit;
};

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

  /// A box that holds all of the surface; empty when there is no water.
  virtual Bounds bounds() const = 0;
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

/// The iso-surface of the particles' density, cast along rays.
/// @param colours  one linear colour a particle, or empty
/// @throws Error   invalid_argument: an option outside its range, colours of another number than the particles
std::unique_ptr<Surface> make_raycast_surface(const Particles& particles, const RaycastOptions& options,
                                              std::span<const vec3> colours = {}, StageTimes* times = nullptr);

/// The same surface by the plain method: every particle splatted, every sum by one scalar loop over the cells
/// around a sample, one ray after another on the calling thread. What the fast one is checked and timed against.
std::unique_ptr<Surface> make_plain_raycast_surface(const Particles& particles, const RaycastOptions& options,
                                                    std::span<const vec3> colours = {}, StageTimes* times = nullptr);

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
