/// From what is seen of the water and of the scene to radiance.
#pragma once

#include "meniscus/base.h"
#include "meniscus/scene.h"
#include "meniscus/surface.h"

namespace meniscus {

/// What the liquid looks like.
struct Material {
  std::string name = "water";
  bool transparent = true;  ///< false: an opaque body of `body` colour
  float ior = 1.333f;       ///< index of refraction, > 1
  vec3 extinction{0.0f};    ///< absorption, 1/m per channel (Beer-Lambert)
  vec3 scattering{0.0f};    ///< turbidity, 1/m per channel: what is scattered shows `body`
  vec3 body{0.8f};          ///< linear colour of the diffuse part
  float roughness = 0.0f;   ///< of the reflection, 0 mirror .. 1
  float specular = 1.0f;    ///< factor of the Fresnel reflection; 0 switches it off (clay)
};

/// A preset: water, milk, oil, ink, clay, plastic (opaque and coloured), ...
/// @param scale  m: a depth over which clear water of this scene should be seen to be tinted
/// @throws Error invalid_argument naming the presets
Material material_preset(std::string_view name, float scale);
std::vector<std::string> material_names();

// --- How rays go on from the surface ------------------------------------------------------------------------

/// How it is found what the refracted and the reflected ray of a point of the surface meet.
enum class RefractionMethod {
  thickness,    ///< one interface, then rays into the scene; the far side is guessed from the water's thickness
  image_space,  ///< one interface, then iteration in what is seen of the scene without water [Iwasaki2008] 5.1.2
  ray_traced,   ///< rays through the water: out at its far side, total reflection, into the next sheet or drop
};
/// @throws Error invalid_argument
RefractionMethod refraction_method_of(std::string_view name);

struct OpticsOptions {
  RefractionMethod refraction = RefractionMethod::thickness;
  int iterations = 8;   ///< image_space: projections onto the ray at most, 1 .. 256
  float threshold = 0;  ///< image_space: m between a point on the ray and the scene that counts as met; 0: from pixels
  int bounces = 8;      ///< ray_traced: interfaces in one path at most, 1 .. 64; 1 is a single interface
};

/// What shade() may look up besides the scene itself.
struct OpticsInputs {
  OpticsOptions options;
  const SceneBuffers* behind = nullptr;  ///< image_space: Scene::see() of the same whole view
  const Surface* surface = nullptr;      ///< ray_traced: the water itself; one that can be marched
};

/// Radiance, linear, of every picture point: water over scene. Where coverage is fractional both are mixed.
/// @param points  as given to Surface::see; empty: pixel centres
/// @throws Error  invalid_argument: images of the wrong size, a material or an option outside its range, a method
///                without what it needs
Image<vec3> shade(const View& view, std::span<const vec2> points, const SurfaceBuffers& water, const Scene& scene,
                  const Material& material, const OpticsInputs& optics = {}, StageTimes* times = nullptr);

// --- Light under the water ------------------------------------------------------------------------------------

/// The water's soft shadow: the surface's thickness seen from the sun, with Fresnel and Beer-Lambert losses, blurred
/// by the sun's size, and the sky light that the water takes away around it. For liquids that light does not pass, and
/// for clear ones where caustics are not wanted.
/// @param region     where the water mostly is, m, so that a few drops far away do not coarsen it; empty: all of it
/// @param on_bodies  there are bodies that stand out of the water: what is before it, as the sun sees it, is in full
///                   light. Else only what is under the water is asked for
std::shared_ptr<const WaterLight> soft_shadow(const Surface& surface, const Environment& environment,
                                              const Ground& ground, const Material& material,
                                              StageTimes* times = nullptr, const Bounds& region = {},
                                              bool on_bodies = false);

/// Where the virtual screen that light is cast from stands.
enum class ScreenDirection {
  light,  ///< perpendicular to the light: every pixel is the same part of the light
  up,     ///< horizontal, as published
};

struct CausticsOptions {
  int screen_width = 0;   ///< px of the virtual screen; 0: by the water's extent, 512 along the longer side
  int screen_height = 0;  ///< px; 0: square pixels
  ScreenDirection screen = ScreenDirection::light;
  int iterations = 8;       ///< of the intersection with the geometry map, 1 .. 256
  float threshold = 0;      ///< m; 0: half a pixel of the geometry map
  bool exact_hits = false;  ///< refracted light meets the scene by ray, not in the geometry map
  /// Light that has entered the water stays in it, as published. Else light that leaves drops, sheets and the sides of
  /// the water is followed through the air, where the surface can be marched.
  bool single_interface = false;
  /// Texels along the longer side of the map that the triangles are drawn into; 0: five to four points of the screen,
  /// 128 .. 1024.
  int map_size = 0;
  int most_lights = 4;  ///< sun and lamps that make caustics, the brightest first
};

/// Light that water bends onto the solids, drawn as caustics triangles.                  [Iwasaki2008] 5.1
/// Includes the water's shadow in the unbent light, so that none is counted twice.
/// @param scene  its solids and lights; its own water light is not looked at
/// @throws Error invalid_argument: an option outside its range
std::shared_ptr<const WaterLight> caustics(const Surface& surface, const Scene& scene, const Material& material,
                                           const CausticsOptions& options = {}, StageTimes* times = nullptr,
                                           const Bounds& region = {});

/// What is drawn for the brightest light, for measurements.
struct CausticsReport {
  std::size_t triangles = 0;
  double entered = 0, absorbed = 0, landed = 0;  ///< power of all channels together, W
  double mirrored = 0;                           ///< lost at later interfaces or not followed further, W
  double psnr_db = 0;       ///< of the first map against photons; white is four times the photons' mean
  double reference_ms = 0;  ///< of the photons
};
/// @param finer  photons along a side of a point of the screen; 0: no reference
CausticsReport measure_caustics(const Surface& surface, const Scene& scene, const Material& material,
                                const CausticsOptions& options, StageTimes* times, int finer = 0);

}  // namespace meniscus
