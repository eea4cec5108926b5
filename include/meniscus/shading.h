/// From what is seen of the water and of the scene to radiance.
#pragma once

#include "meniscus/base.h"
#include "meniscus/scene.h"
#include "meniscus/sim.h"
#include "meniscus/surface.h"

namespace meniscus {

/// What the liquid looks like.
struct Material {
  std::string name = "water";
  bool transparent = true;  ///< false: an opaque body of `body` colour
  float ior = 1.333f;       ///< index of refraction, > 1
  vec3 dispersion{0.0f};    ///< added to the index of refraction per channel, where OpticsOptions::dispersion
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
  virtual_eye,  ///< one interface, then maps of the objects drawn from virtual eyes [Cords2008] 2.1 to 2.3
};
/// @throws Error invalid_argument
RefractionMethod refraction_method_of(std::string_view name);

enum class FresnelFormula { exact, schlick };
/// @throws Error invalid_argument
FresnelFormula fresnel_formula_of(std::string_view name);

/// How objects are drawn into maps from virtual eyes. Each switch turns one part of the method off.
struct VirtualEyeOptions {
  int map_size = 0;              ///< px, edge of a face of the cube maps; 0: by the picture
  bool displaced_eye = true;     ///< off: maps are drawn from the eye itself, as games do       [Cords2008] fig. 10 b
  bool scale_correction = true;  ///< of the refracted part's length along its main axis         [Cords2008] fig. 3
  bool adaptation = true;        ///< of the surface to the plane around an object               [Cords2008] fig. 6
  bool trapezium = true;         ///< objects are seen only in a trapezium towards the eye       [Cords2008] fig. 8
  float trapezium_a = 0;         ///< m; half width at the object; 0: by its size
  float trapezium_b = 0;         ///< m; half width at the eye's end; 0: by its size
  bool per_point = false;        ///< each point from its own virtual eye: for wide objects, beyond the paper
  /// Objects are looked up where the ray passes them, not by its direction alone: they keep together under waves.
  /// Beyond the paper; needs neither scale_correction nor per_point, which then do nothing. Off: by direction, as
  /// published.
  bool object_position = true;
  /// What stands still is found where the ray meets it. Off: looked up in a map by direction alone, as published.
  bool static_position = true;
  float adaptation_width = 0;   ///< m beyond an object's outline; 0: by its size
  float combine_distance = -1;  ///< m; objects nearer to each other share an eye; negative: default
};

struct OpticsOptions {
  RefractionMethod refraction = RefractionMethod::thickness;
  FresnelFormula fresnel = FresnelFormula::exact;
  bool dispersion = false;  ///< each channel by its own index of refraction
  VirtualEyeOptions eyes{};
  int iterations = 8;   ///< image_space: projections onto the ray at most, 1 .. 256
  float threshold = 0;  ///< image_space: m between a point on the ray and the scene that counts as met; 0: from pixels
  int bounces = 8;      ///< ray_traced: interfaces in one path at most, 1 .. 64; 1 is a single interface
};

/// Objects in the water that share a virtual eye, with the plane that approximates the water around them.
struct WaterObject {
  std::vector<std::size_t> solids;      ///< indices in Scene::solids()
  Bounds bounds;                        ///< of all of them, m
  vec3 plane_point{0.0f};               ///< from the mean of the heights around it, m
  vec3 plane_normal{0, 1, 0};           ///< unit, from the mean of the normals
  vec3 axis_top{0.0f}, axis_end{0.0f};  ///< ends of the main axis, m; axis_end is the one under water
  /// Oriented bounding box: from box_centre to the middle of three faces, m. The first lies along the main axis, which
  /// is the one along which the object goes deepest.
  vec3 box_centre{0.0f};
  std::array<vec3, 3> half_axes{};
  std::vector<vec2> outline;  ///< convex, horizontal, m, as in PlaneAdaptation
  bool pierces = false;       ///< stands through the surface
  bool under = false;         ///< some of it is under the surface
};
/// Solids of the scene that are seen in or through the water, close ones combined.    [Cords2008] 2.2, 2.3
std::vector<WaterObject> water_objects(const HeightField& field, const Scene& scene, const VirtualEyeOptions& options);
/// How the field is to be bent around them; none with options.adaptation off.
std::vector<PlaneAdaptation> adaptations(std::span<const WaterObject> objects, const VirtualEyeOptions& options);

/// Maps of the objects and of what stands still, drawn from virtual eyes for one view.   [Cords2008] 2.1
class VirtualEyes;
/// @param field  after adaptation
/// @throws Error invalid_argument: an option outside its range; unsupported: a view that is not perspective
std::shared_ptr<const VirtualEyes> make_virtual_eyes(const View& view, const HeightField& field, const Scene& scene,
                                                     std::span<const WaterObject> objects, const Material& material,
                                                     const VirtualEyeOptions& options, StageTimes* times = nullptr);

/// What shade() may look up besides the scene itself.
struct OpticsInputs {
  OpticsOptions options;
  const SceneBuffers* behind = nullptr;  ///< image_space: Scene::see() of the same whole view
  const Surface* surface = nullptr;      ///< ray_traced: the water itself; one that can be marched
  const VirtualEyes* eyes = nullptr;     ///< virtual_eye: made for the same view
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

enum class CausticsMethod {
  triangles,  ///< light followed through triangles of the surface [Iwasaki2008] 5.1
  simple,     ///< brightness made up from heights and gradients [Cords2008] eq. 4
  light_map,  ///< a plane map traced backwards through the surface, projected from the light [Cords2008] 2.4
  combined,   ///< simple and light_map superposed [Cords2008] fig. 9 c
};
/// @throws Error invalid_argument
CausticsMethod caustics_method_of(std::string_view name);

struct CausticsOptions {
  CausticsMethod method = CausticsMethod::triangles;
  /// simple: I = a (z - z_min) / (z_max - z_min) + b |n_x + n_y| + c                      [Cords2008] eq. 4
  /// With b < 0 crests and troughs are bright lines, as caustics are.
  float simple_a = 1.5f, simple_b = -0.8f, simple_c = 0.35f;
  /// simple: I scaled so that the floor gets as much light as under still water; off: I as published.
  bool simple_keeps_mean = true;
  /// Light of the sun that the water mirrors onto the walls above it and onto bodies; triangles: where the surface is a
  /// height field.
  bool on_walls = true;
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
  /// 128 .. 1024. light_map and combined: of the light map; 0: as many as the field has points, 128 .. 512.
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

// --- Rain ------------------------------------------------------------------------------------------------------

/// What wet ground looks like.
struct WetLook {
  float film_full = 0.0005f;  ///< m of water from which on the film is smooth
  float bumpiness = 1;        ///< factor of the grain's bumps
  std::uint64_t seed = 1;     ///< of the grain
  /// Albedos of dry concrete, asphalt, steel; linear.
  std::array<vec3, 3> albedo{vec3{0.34f, 0.33f, 0.31f}, vec3{0.11f, 0.11f, 0.115f}, vec3{0.20f, 0.205f, 0.21f}};
};

/// The ground's grain by its materials; soaked it is darker [LeknerDorf1988], a film of water on it shines. Beyond the
/// cells the ground goes on as their mirror image.
/// @param ground  looked at now; later changes do not matter
std::shared_ptr<const GroundCover> wet_ground_cover(const WetGround& ground, const WetLook& look = {});

/// Light from everything around a place, as far as drops of water care: they show it small and upside down.
class Surroundings {
 public:
  /// @param centre  where the splashes are, m, above the ground
  /// @param size    px, of a cube map's face
  Surroundings(const Scene& scene, vec3 centre, int size = 64, StageTimes* times = nullptr);
  /// Linear radiance from this direction (unit, away from the drop), blurred over about `cone` radians.
  vec3 radiance(vec3 direction, float cone = 0) const;
  vec3 mean() const;  ///< over all directions
  /// Back light: the sun and lamps, as Gaussians of `variance` rad^2.
  vec3 glare(vec3 point, vec3 direction, float variance) const;

  struct Parts;
  const Parts& parts() const { return *parts_; }

 private:
  std::shared_ptr<const Parts> parts_;
};

struct RainLook {
  float ior = 1.333f;
  float pile_opacity = 0.85f;   ///< of splashes: what is not them shows through, as foam and film do not refract alike
  bool level_of_detail = true;  ///< pieces smaller than a pixel are drawn as what they cover of it
  float streak_strength = 1;    ///< factor of the opacity of streaks, >= 0
  float haze = 0;               ///< 1/m: extinction by rain too far away to be seen drop by drop
  vec3 haze_radiance{0.0f};     ///< of the light that it scatters instead
};

/// Draws pieces of splashes and streaks of rain over a shaded picture: nearer over farther, behind what is nearer yet.
/// Each shows the mirror image of its surroundings (Fresnel), what is behind it refracted, and the light from behind.
/// @param depth     distance along each pixel's ray, m, to what is solid or water in the picture; infinity: nothing
/// @param radiance  linear, of the same size; changed
/// @throws Error    invalid_argument: images of other sizes than the view; unsupported: a cube view
void draw_rain(const View& view, std::span<const WaterPiece> pieces, const Surroundings& surroundings,
               const RainLook& look, const Image<float>& depth, Image<vec3>& radiance, StageTimes* times = nullptr);

// --- Foam ---------------------------------------------------------------------------------------------------

struct FoamLook {
  float radius = 0;      ///< m, of a particle's disc; > 0
  float opacity = 0.6f;  ///< in the middle of a disc, 0 .. 1; it falls off as (1 - r^2)^2
  vec3 albedo{0.9f};     ///< linear
};

/// Draws particles of spray, foam and bubbles over a shaded picture, from far to near: white discs, lit by the sky and
/// by the sun as balls are. Those behind the water's surface are seen where that refracts them to, less what it
/// reflects and what the water absorbs on the way down and back. Shadows on them are left out.
/// @param places    m
/// @param up        unit
/// @param water     what is seen of the surface in this view
/// @param solids    distance along each pixel's ray to what is solid, m; infinity: nothing
/// @param radiance  linear, of the view's size; changed
/// @throws Error    invalid_argument: sizes that differ, a radius or opacity out of range; unsupported: a cube view
void draw_foam(const View& view, std::span<const vec3> places, const FoamLook& look, const Environment& environment,
               const Material& material, vec3 up, const SurfaceBuffers& water, const Image<float>& solids,
               Image<vec3>& radiance, StageTimes* times = nullptr);

}  // namespace meniscus
