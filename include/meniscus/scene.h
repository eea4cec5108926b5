/// What surrounds the water: the sky or an environment map, the sun, lamps, the ground, a tank, solid bodies.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <vector>

#include "meniscus/base.h"

namespace meniscus {

/// The light that comes from infinitely far: an analytic sky, or a map read from a .hdr file.
///
/// The analytic sky is scaled so that a white diffuse plane that faces `up` has the radiance 1 in the sky's and
/// the sun's light together. The radiances of a map are taken as they are.
struct EnvironmentOptions {
  std::string hdr_path;  ///< Radiance .hdr, equirectangular; empty: the analytic sky
  vec3 up{0, 1, 0};      ///< the sky's zenith and the upper edge of a map; need not be unit
  /// Towards the sun, world space; need not be unit. A map that holds a sun overrides it.
  vec3 sun_direction{0.4f, 0.8f, 0.45f};
  float sun_radiance_scale = 1.0f;  ///< >= 0
  bool sun_visible = true;          ///< the disc itself in the background; its light comes in any case
  /// Of the analytic sky, 0 .. 1: 0 clear, 1 the CIE standard overcast sky, which has no sun; between, both mixed.
  float cloud_cover = 0;
  float radiance_scale = 1;  ///< of all of it, >= 0: what stays when lamps take over at night
};

// Many rays side by side; see scene/ray_block.h.
struct BlockVectors;
struct BlockBeams;
struct RayBlock;

/// Light from all directions. A cheap handle: copies share the tables.
class Environment {
 public:
  /// @throws Error not_found, malformed_file, unsupported, limit_exceeded for the .hdr;
  ///               invalid_argument: a direction without length, a negative scale, a cover outside [0, 1]
  explicit Environment(const EnvironmentOptions& options);
  /// Linear radiance that arrives from `direction` (unit, away from the eye), without the sun's disc.
  vec3 radiance(vec3 direction) const;
  /// The same blurred over a cone: `roughness` 0 is radiance(), 1 nearly diffuse. The cone is a Gaussian of
  /// standard deviation 0.8 roughness^2 radians.
  vec3 radiance(vec3 direction, float roughness) const;
  /// Irradiance on a surface with this unit normal from the sky without the sun.
  vec3 irradiance(vec3 normal) const;
  /// Both for `count` vectors side by side, to rounding.
  /// @param wanted  not zero for those that are; the radiance of others is zero or their own
  void radiance(const BlockVectors& directions, const float* roughness, const std::int32_t* wanted, int count,
                BlockVectors& radiance) const;
  void irradiance(const BlockVectors& normals, int count, BlockVectors& irradiance) const;
  /// Unit vector towards the sun; irradiance of the sun on a surface that faces it. A map without a sun has a sun
  /// without light.
  vec3 sun_direction() const;
  vec3 sun_irradiance() const;
  /// Radiance of the sun's disc blurred into a Gaussian of `variance` rad^2 (the disc's own, 5e-6, is added): what a
  /// reflection shows whose normals vary. It integrates to sun_irradiance() over the sphere.
  vec3 sun_glare(vec3 direction, float variance) const;
  bool sun_visible() const;
  /// rad^2, of the sun's disc, half of whose width is 0.267 degrees: a quarter of the radius squared.
  static constexpr float kSunVariance = 5.4e-6f;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

/// A horizontal plane, plain or chequered; seen from above only.
struct Ground {
  bool visible = true;
  vec3 up{0, 1, 0};           ///< unit normal
  float height = 0;           ///< of the plane along up, m
  vec3 albedo{0.5f};          ///< linear
  vec3 second_albedo{0.35f};  ///< of the other squares
  float square = 0;           ///< edge of a square, m; 0: plain
  vec3 centre{0};             ///< where the fading into the horizon is centred, m
  float fade_radius = 0;      ///< m from the centre at which the plane has faded into the horizon; 0: never
};

/// What the water does to the light that falls on the solids under and beside it; made by shading/.
class WaterLight {
 public:
  struct Light {
    vec3 sun{1.0f};  ///< fraction of the sun's light that arrives unbent: 0 behind water that is drawn as caustics
    vec3 sky{1.0f};  ///< fraction of the sky's light, in [0, 1]
    vec3 refracted{0.0f};  ///< irradiance of light bent by the water on a surface with the normal asked for
    vec3 lamps{1.0f};      ///< fraction of the point lights' light that arrives unbent
  };
  virtual ~WaterLight() = default;
  /// @param normal  unit, of the lit side
  virtual Light at(vec3 point, vec3 normal) const = 0;
  /// The same at many points that lie close together; lists of one length. By default one after the other.
  virtual void at_each(std::span<const vec3> points, std::span<const vec3> normals, std::span<Light> lights) const;
};

struct SolidHit;

/// What covers the ground: its grain, how wet it is. Made by shading/.
class GroundCover {
 public:
  virtual ~GroundCover() = default;
  /// Changes what rays have met on the ground plane and on covered solids: albedo, coat, normal.
  /// @param points      of the hits, world space
  /// @param directions  of the rays, unit, towards the hits
  /// @param widths      of the beams there, m, across the rays; lists of one length
  virtual void cover(std::span<const vec3> points, std::span<const vec3> directions, std::span<const float> widths,
                     std::span<SolidHit> hits) const = 0;
};

/// A ray with a width: `width` m at its origin, growing by `spread` m per metre of its length.
struct Beam {
  float width = 0;
  float spread = 0;
};

// --- Solid bodies --------------------------------------------------------------------------------------------

/// What a solid body is made of: a diffuse body, under a clear coat where roughness < 1.
struct SolidMaterial {
  vec3 albedo{0.6f};    ///< linear; factor of the texture where there is one
  std::string texture;  ///< a PNG, JPEG, TGA or BMP file; empty: none
  float roughness = 1;  ///< of the coat's mirror image, 0 a mirror .. 1 no coat at all
  float ior = 1.5f;     ///< of the coat, > 1

  bool operator==(const SolidMaterial&) const = default;
};

/// Triangles, as read from a file or made.
struct Mesh {
  std::vector<vec3> positions;           ///< m
  std::vector<vec3> normals;             ///< unit, one a position; empty: flat faces
  std::vector<vec2> texture_points;      ///< one a position, (0, 0) the lower left corner of the texture; may be empty
  std::vector<std::uint32_t> corners;    ///< three a triangle, each < positions.size()
  std::vector<SolidMaterial> materials;  ///< empty: one default material
  std::vector<std::uint32_t> material_of;  ///< one a triangle, each < materials.size(); empty: all the first
  /// Pictures that the file held itself, still encoded; a material whose texture is "*2" wears number 2.
  std::vector<std::vector<unsigned char>> pictures;
};

/// Reads OBJ, PLY, glTF and what else Assimp knows; nodes' transforms are applied, polygons cut into triangles.
/// @throws Error not_found, malformed_file, unsupported (a kind of file), limit_exceeded
Mesh read_mesh(const std::string& path);
/// Simple shapes, closed, normals outwards.
Mesh box_mesh(vec3 low, vec3 high);
Mesh sphere_mesh(vec3 centre, float radius, int segments = 48);
Mesh cylinder_mesh(vec3 bottom, vec3 top, float radius, int segments = 48);

/// A mesh made ready for rays: immutable, its textures loaded, its acceleration structure built. Bodies that do not
/// change are made once and placed anew in each frame.
class Solid {
 public:
  virtual ~Solid() = default;
  virtual const Mesh& mesh() const = 0;
  virtual Bounds bounds() const = 0;
};
/// @throws Error  invalid_argument: indices out of range, lists of the wrong length, positions that are not finite;
///                not_found, malformed_file: a texture
std::shared_ptr<const Solid> make_solid(Mesh mesh);

struct PlacedSolid {
  std::shared_ptr<const Solid> solid;
  glm::mat4 world_from_solid{1.0f};       ///< affine, invertible
  std::optional<SolidMaterial> material;  ///< instead of the mesh's own
  bool covered = false;                   ///< it is ground: Scene's ground cover lies on it
};

enum class TankStyle {
  none,
  glass,  ///< clear panes on four sides, seen through, with rims
  tiled,  ///< walls and floor with tiles; a wall is seen from inside only, so that it does not hide the water
};
/// @throws Error invalid_argument
TankStyle tank_style_of(std::string_view name);

/// A box around the water, open at the top.
struct Tank {
  TankStyle style = TankStyle::none;
  Bounds inside;                         ///< m, of the space for the water
  vec3 up{0, 1, 0};                      ///< one of the axes, positive
  float thickness = 0;                   ///< of the walls, m; 0: a hundredth of the longest edge
  vec3 albedo{0.55f, 0.72f, 0.78f};      ///< of the tiles
  vec3 joint_albedo{0.85f};              ///< of the joints between them
  float tile = 0;                        ///< edge of a tile, m; 0: a twelfth of the longest edge
  vec3 glass_tint{0.93f, 0.97f, 0.95f};  ///< what white light becomes through one pane, straight on
};

/// A lamp without extent.
struct PointLight {
  vec3 position{0.0f};   ///< m
  vec3 intensity{1.0f};  ///< radiant intensity: irradiance times m^2 on a surface that faces it
};

/// What a ray meets first of all solids: meshes, tank, ground.
struct SolidHit {
  float distance = std::numeric_limits<float>::infinity();  ///< m along the ray; infinity: nothing
  vec3 normal{0.0f};                                        ///< unit, interpolated, towards the ray's origin
  vec3 face_normal{0.0f};                                   ///< unit, of the flat face, towards the ray's origin
  vec3 albedo{0.0f};                                        ///< linear, textures and tiles averaged over the beam
  float roughness = 1;
  float ior = 1.5f;
  float presence = 1;    ///< less than 1 where the ground fades into the horizon
  bool covered = false;  ///< it is ground: the scene's ground cover lies on it

  bool found() const { return distance < std::numeric_limits<float>::infinity(); }
};

/// What many rays meet first, field by field; lists as long as that of the rays.
struct FaceHits {
  static constexpr std::int32_t kNothing = -1, kOther = 6;
  std::span<float> distance;     ///< m; infinity: nothing
  std::span<std::int32_t> face;  ///< of a dull plane: twice the axis of its normal, and one more where that points
                                 ///< along the axis; else kOther or kNothing
  std::span<vec3> albedo;        ///< of planes, as in SolidHit
  std::span<float> presence;     ///< of planes
  std::span<SolidHit> others;    ///< written where `face` is kOther
};

/// What of the solids is seen through a view. All images have the view's size, or N x 1 for N picture points.
struct SceneBuffers {
  Image<vec3> radiance;  ///< linear; the environment, without the sun's disc, where there is nothing
  Image<float> depth;    ///< distance along the ray, m; +infinity where there is nothing
  Image<vec3> normal;    ///< unit, world space, towards the eye; zero where there is nothing
  Image<vec3> albedo;    ///< linear; zero where there is nothing
};

/// What is done to light on its way through the tank's panes: radiance = before * transmittance + added.
struct GlassPane {
  vec3 transmittance{1.0f};
  vec3 added{0.0f};
};

/// What is seen behind and around the water. A cheap handle of what does not change: copies share it.
class Scene {
 public:
  Scene(Environment environment, Ground ground);
  void set_water_light(std::shared_ptr<const WaterLight> light);
  /// @throws Error invalid_argument: a transform that is not invertible
  void set_solids(std::vector<PlacedSolid> solids);
  void set_tank(const Tank& tank);
  void set_lamps(std::vector<PointLight> lamps);
  /// Lies on the ground plane and on solids that are `covered`; null: nothing.
  void set_ground_cover(std::shared_ptr<const GroundCover> cover);
  const Environment& environment() const;
  const Ground& ground() const;
  const Tank& tank() const;
  const std::vector<PointLight>& lamps() const;
  const std::vector<PlacedSolid>& solids() const;
  /// Box of meshes and tank, without the ground; empty if there are none.
  Bounds solid_bounds() const;

  /// What of the solids is seen through a view (perspective, orthographic, cube), lit with shadows.
  SceneBuffers see(const View& view, std::span<const vec2> points = {}, StageTimes* times = nullptr) const;
  /// The first solid along the ray, `from` m from its origin or farther, nothing beyond `limit`.
  SolidHit hit(const Ray& ray, Beam beam = {}, float from = 0,
               float limit = std::numeric_limits<float>::infinity()) const;
  /// Distance to the first solid along the ray; infinity if there is none.
  float distance(const Ray& ray, float from = 0) const;
  /// hit(), radiance() and distance() for many rays at once, several times as fast where neighbours in the list are
  /// neighbours in space. The same values to rounding, whatever else is in the list.
  /// @param beam      of every ray
  /// @param distance  as in distance(); may be empty
  /// @throws Error    invalid_argument: lists of different lengths
  void hits(std::span<const Ray> rays, Beam beam, std::span<SolidHit> hits) const;
  /// hits() with less to copy where planes are met.
  void face_hits(std::span<const Ray> rays, Beam beam, const FaceHits& hits) const;
  void radiance(std::span<const Ray> rays, Beam beam, std::span<vec3> radiance, std::span<float> distance = {}) const;
  void distances(std::span<const Ray> rays, std::span<float> distance) const;
  /// radiance() and distances() of a block, on this thread; a beam of its own for each ray. `distance` may be null.
  void block_radiance(const RayBlock& rays, const BlockBeams& beams, BlockVectors& radiance,
                      float* distance = nullptr) const;
  void block_distances(const RayBlock& rays, float* distance) const;
  /// Whether a solid stands between two points; their own surfaces do not count.
  bool blocked(vec3 from, vec3 to) const;
  /// Whether a solid stands between a point and the environment in this direction (unit).
  bool shadowed(vec3 from, vec3 direction) const;

  /// Radiance along a ray, from the nearest solid or the environment, without the sun's disc, without glass panes.
  /// @param roughness  the environment is blurred by it, as in Environment::radiance
  vec3 radiance(const Ray& ray, Beam beam, float roughness = 0) const;
  /// Narrow beam: `footprint` m of width per metre of its length.
  vec3 radiance(const Ray& ray, float footprint) const;
  /// Light that leaves a point on a solid towards the ray's origin.
  vec3 lit(const SolidHit& hit, const Ray& ray, Beam beam) const;
  /// Irradiance on a solid's point from sun, sky and lamps, with shadows and what the water brings.
  vec3 irradiance(vec3 point, vec3 normal, vec3 face_normal) const;

  /// The panes of a glass tank between the ray's origin and `distance`.
  GlassPane glass(const Ray& ray, float distance) const;

  /// Distance to the ground along the ray; infinity if the ray misses it. Zero for a ray that starts below the
  /// ground and goes down.
  float ground_distance(const Ray& ray) const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace meniscus
