/// From frames to pictures: the order of the stages, and what nobody has to say because it can be guessed.
///
///   find_frames -> survey_frames -> settings_of, view_of -> for each frame: read_particles -> render_frame -> write
///
/// render_files() does all of it in one call.
#pragma once

#include <functional>
#include <glm/mat4x4.hpp>
#include <memory>

#include "meniscus/base.h"
#include "meniscus/image.h"
#include "meniscus/io.h"
#include "meniscus/output.h"
#include "meniscus/particles.h"
#include "meniscus/scene.h"
#include "meniscus/shading.h"
#include "meniscus/sim.h"
#include "meniscus/surface.h"

namespace meniscus {

// --- One frame ---------------------------------------------------------------------------------------------

enum class Antialias {
  off,
  edges,  ///< 16 rays in the pixels where the water's outline or a fold of it passes
  full,   ///< the whole picture at twice its width and height, then halved ("2x2")
};
/// "off", "edges" or "2x2". @throws Error invalid_argument
Antialias antialias_of(std::string_view name);

/// How the water is found in the particles.
enum class SurfaceMethod {
  raycast,       ///< the iso-surface of their density, cast along rays [Xiao2017]
  surfels,       ///< the iso-surface of their density, sampled by points [Iwasaki2008]
  height_field,  ///< columns of water under the potential of eq. 5, 6 [Cords2008]
  spheres,       ///< not at all: one ball a particle, to look at the raw data
};
/// @throws Error invalid_argument
SurfaceMethod surface_method_of(std::string_view name);

/// What a picture shows.
enum class Show {
  water,      ///< the shaded scene
  normals,    ///< the surface's normals as colours: (n + 1) / 2 in camera axes (right, up, towards the eye)
  thickness,  ///< m of water along each ray through the colour map, up to the largest in the picture
  depth,      ///< distance, near bright, far dark
};
/// @throws Error invalid_argument
Show show_of(std::string_view name);

class RainyScene;

/// Foam in files beside those of the water.
struct FoamOptions {
  std::vector<std::string> files;  ///< with {} for the frame's number
  FoamLook look;                   ///< a radius of 0 is 0.3 spacings
};

/// Attributes that the particles of a ray-cast surface have their sizes from; empty names: they are alike.
struct SizesBy {
  std::string radius;            ///< m, half of each particle's spacing
  std::string smoothing_length;  ///< m
  bool empty() const { return radius.empty() && smoothing_length.empty(); }
};

/// Everything that one frame is drawn by. settings_of() fills it from guesses; or set what you like.
struct FrameSettings {
  View view;
  SurfaceMethod method = SurfaceMethod::raycast;
  Show show = Show::water;
  RaycastOptions surface;          ///< spacing > 0 is required
  SizesBy sizes;                   ///< of SurfaceMethod::raycast
  std::optional<ColourBy> colour;  ///< none: the material's own colour
  Material material;
  Environment environment{EnvironmentOptions{}};
  Ground ground;
  Tank tank;
  std::vector<PlacedSolid> solids;
  std::vector<PointLight> lamps;
  OpticsOptions optics;
  bool caustics = true;  ///< of transparent materials; else their soft shadow
  CausticsOptions caustics_options;
  SurfelOptions surfels;            ///< of SurfaceMethod::surfels; what is 0 is taken from `surface`
  HeightFieldOptions height_field;  ///< of SurfaceMethod::height_field; what is 0 is taken from `surface`
  /// SurfaceMethod::height_field: the water itself instead of particles, at a frame's time (s); may be null.
  std::function<HeightField(double)> heights;
  Bounds water;        ///< where the water is, m: what light and shadow are fitted to; empty: found in each frame
  bool shadow = true;  ///< the water's soft shadow on the ground
  ToneOptions tone;
  Antialias antialias = Antialias::edges;
  bool legend = false;               ///< a colour bar, where `colour` is set
  int drop_isolated = 0;             ///< leave out particles with fewer neighbours than this; 0: none
  std::shared_ptr<RainyScene> rain;  ///< goes on to `time`; may be null
  double time = 0;                   ///< s of the film, for rain; never less than in the frame before
  std::vector<vec3> foam;            ///< places of spray, foam and bubbles, m
  FoamLook foam_look;                ///< a radius of 0 is 0.3 spacings
  /// Bytes that a ray-cast surface may take while it is made and seen, beside the particles: one that would take more
  /// is drawn in slabs, one after another. 0: no limit.
  std::uint64_t surface_memory = 0;
};

/// The surfels that SurfaceMethod::surfels draws.
std::vector<Surfel> surfels_of(const Particles& particles, const FrameSettings& settings, StageTimes* times = nullptr);

/// One drawn frame, with everything that led to it.
struct FramePicture {
  Image<Rgb8> picture;                     ///< developed, with the legend
  Image<vec3> radiance;                    ///< linear
  SurfaceBuffers buffers;                  ///< at the pixel centres; coverage and thickness averaged where antialiased
  StageTimes times;                        ///< one row a stage
  std::size_t particles = 0;               ///< drawn ones
  std::size_t far_away = 0;                ///< left out, because they are hundreds of thousands of spacings away
  std::pair<float, float> colour_range{};  ///< what the ends of the colour map stand for
};

/// Draws one frame. No particles give the scene without water.
/// @throws Error  invalid_argument: a setting outside its range; not_found: no such attribute to colour by
FramePicture render_frame(const Particles& particles, const FrameSettings& settings);

/// The layers of a drawn frame as an EXR file holds them, in this order: radiance (R, G, B), depth (Z: m along
/// the viewing direction), normal (X, Y, Z), thickness (m), coverage, colour (only where particles are coloured).
std::vector<std::string> layer_names();
/// @param layers  which of them; empty: all that there are
/// @throws Error  invalid_argument: an unknown name; io_failed
void write_layers(const std::string& path, const FramePicture& frame, const View& view,
                  std::span<const std::string> layers = {});

// --- The camera --------------------------------------------------------------------------------------------

/// Where the picture is taken from. What is not set is fitted so that the whole water is in the picture.
/// Azimuth turns about the up axis: at 0 the camera stands on the negative side of the second horizontal axis of
/// (right, back), which is +z where y is up and -y where z is up; at 90 it stands on the side of +x.
struct CameraOptions {
  std::optional<vec3> eye;                   ///< m
  std::optional<vec3> target;                ///< m; default the middle of the water
  std::optional<float> azimuth_deg;          ///< default 30 off the water's longer horizontal side
  std::optional<float> elevation_deg;        ///< above the horizon; default 16
  std::optional<float> distance;             ///< m from the target
  std::optional<float> orthographic_height;  ///< m; parallel rays, a picture of this height
  float fov_deg = 35;                        ///< full vertical field of view
  float margin = 0.06f;                      ///< of the picture's half size, left free at each side
  float orbit_deg = 0;                       ///< turned about the water over the whole sequence
};

/// The azimuth that is taken when none is given.
float default_azimuth_deg(const Bounds& bounds, Axis up);
/// Unit vector from the target towards a camera (or the sun) at this azimuth and elevation.
vec3 direction_towards(Axis up, float azimuth_deg, float elevation_deg);

/// A view that shows all of `bounds`, as far as the options leave it free.
/// @param turned_deg  added to the azimuth; with options.orbit_deg != 0 the distance is that of the whole turn
/// @throws Error invalid_argument: angles, sizes, distance out of range
View fitted_view(const Bounds& bounds, Axis up, const CameraOptions& options, float turned_deg, int width, int height);

/// One key of a camera path.
struct CameraKey {
  double at = 0;   ///< frame of the film from 0, or seconds of the film
  vec3 eye{0};     ///< m
  vec3 target{0};  ///< m
  float fov_deg = 35;
};

/// A way through keys: Catmull-Rom, each of eye, target and field of view for itself; still before the first key
/// and after the last.
class CameraPath {
 public:
  /// @throws Error invalid_argument: no keys, keys not in rising order
  CameraPath(std::vector<CameraKey> keys, bool in_seconds);
  CameraKey at(double place) const;
  bool in_seconds() const { return in_seconds_; }
  const std::vector<CameraKey>& keys() const { return keys_; }

 private:
  std::vector<CameraKey> keys_;
  bool in_seconds_;
};

/// Reads {"keys": [{"frame": 0, "eye": [x, y, z], "target": [x, y, z], "fov": 35}, ...]}; "time" (s) may stand
/// for "frame", in all keys alike; "fov" (degrees) may be missing.
/// @throws Error not_found, malformed_file naming the field
CameraPath read_camera_path(const std::string& path, float default_fov_deg = 35);

// --- What is found out about a sequence --------------------------------------------------------------------

struct SurveyOptions {
  std::optional<float> spacing;    ///< m; not estimated if set
  std::optional<Axis> up;          ///< not guessed if set
  std::optional<ColourBy> colour;  ///< whose range is looked for, unless it has one
  SizesBy sizes;                   ///< asked for: if none are, particles that have radii get a note
  int most_frames = 64;            ///< of a longer sequence, this many are read, evenly spread
  bool strict = false;             ///< a frame that cannot be read is an error
};

/// A sequence at a glance.
struct Survey {
  std::size_t frames = 0;          ///< in the sequence
  std::size_t frames_read = 0;     ///< of them, for this survey
  std::size_t most_particles = 0;  ///< in one frame
  Bounds bounds;                   ///< of the water over the sequence, without the few particles far away
  SpacingEstimate spacing;         ///< of the first frame with enough particles to tell; 0 if none has any
  UpEstimate up;
  std::vector<std::string> attributes;                  ///< of the first frame that has particles
  std::optional<std::pair<float, float>> colour_range;  ///< over the frames read
  std::vector<std::string> notes;       ///< what a user should be told: guesses from a part of the frames and the like
  std::vector<std::string> unreadable;  ///< one line for each frame that could not be read
  std::shared_ptr<const Particles> only_frame;  ///< of a sequence of one frame, so that it is read once
  /// What the positions of all frames are counted from, m: ReadOptions::origin, or what the first frame read chose.
  std::optional<glm::dvec3> origin;
};

/// Reads the frames (of a long sequence, some) and finds out what the pictures need to have in common.
/// @param on_frame  called after each frame with how many are done and how many there will be; may be null
/// @throws Error  with options.strict, or when there is one frame only: whatever reading it throws
Survey survey_frames(const FrameSequence& sequence, const SurveyOptions& options = {},
                     FunctionRef<void(std::size_t, std::size_t)>* on_frame = nullptr);
/// The same of one frame in memory.
Survey survey_particles(const Particles& particles, const SurveyOptions& options = {});

// --- Solid bodies of a sequence ----------------------------------------------------------------------------

/// What a body is in a simulation.
struct ObstacleRole {
  bool dynamic = false;       ///< moved by water and gravity: it floats or sinks
  float density = 500;        ///< kg/m^3, of dynamic ones
  double appears = 0;         ///< s; dropped in then
  std::vector<PoseKey> path;  ///< scripted; none: it stands where it is placed
};

/// A solid body as a user names it.
struct BodyOptions {
  std::string path;   ///< of a mesh; with `{}` or `{:04}` for the frame's number: one file a frame
  std::string shape;  ///< instead of a path: "box", "sphere" or "cylinder" (along y), 1 m in size around the origin
  glm::mat4 world_from_body{1.0f};
  /// One transform a frame, applied before world_from_body; the last one holds on. Empty: the body stands still.
  std::vector<glm::mat4> frames;
  std::vector<bool> absent;               ///< one a frame: it is not there; the last one holds on. Empty: always there
  std::string name;                       ///< by which a simulation's events call it; may be empty
  std::optional<ObstacleRole> role;       ///< in a simulation; none: the water does not meet it
  std::optional<SolidMaterial> material;  ///< instead of the file's own
};

/// The bodies of a sequence: read once, placed for each frame; those of one file a frame are read as they come, and the
/// last one is kept. One thread at a time.
class Bodies {
 public:
  /// @throws Error  as read_mesh() and make_solid(), for bodies that stand in one file; invalid_argument: neither path
  ///                nor shape, or both; an unknown shape
  explicit Bodies(std::vector<BodyOptions> bodies);
  /// @param index   place in the film, from 0
  /// @param number  in the particle file's name; what `{}` stands for
  /// @param notes   what a user should be told: a body whose file of this frame is missing is left out
  /// @throws Error  as read_mesh() and make_solid(), for a body's file of this frame
  /// @param moved  instead of BodyOptions::frames, one a body: none is left out of the picture. Empty: the bodies' own
  std::vector<PlacedSolid> at(std::size_t index, std::int64_t number, std::vector<std::string>& notes,
                              std::span<const std::optional<glm::mat4>> moved = {}) const;
  bool empty() const { return bodies_.empty(); }
  /// Whether the bodies are the same in all frames.
  bool still() const;

 private:
  struct Read {
    std::string path;  ///< of the frame's file; empty for bodies that stand in one
    std::shared_ptr<const Solid> solid;
  };
  std::vector<BodyOptions> bodies_;
  mutable std::vector<Read> read_;  ///< one a body
};

// --- Rain over a scene --------------------------------------------------------------------------------------

/// What of the rain is drawn.                                                        [Mizukami2013] fig. 10
enum class RainShown { all, splashes, streaks, neither };

/// The ground that it rains on, beside what the frame's scene is made of.
struct RainGround {
  bool there = false;                 ///< false: it rains on bodies, water and the plain ground, which all count as wet
  GroundOptions cells;                ///< materials and heights are made from what follows
  std::string materials;              ///< a PNG file: dark asphalt, grey concrete, bright steel; may be empty
  std::string heights;                ///< a PNG file: black `lowest`, white `highest`; may be empty
  float lowest = 0, highest = 0.02f;  ///< m
  std::string mesh;                   ///< name of a body whose height, seen from above, is the ground's; may be empty
  /// Ruts and slope, made up: `rut_depth` m deep along a, and falling by `slope` m a metre away from the middle of b.
  float rut_depth = 0, slope = 0;
  WetLook look;
};

/// The `rain` section of a scene file.
struct RainSettings {
  RainOptions rain;  ///< low = high: around the water, the bodies and what the camera sees nearby
  RainGround ground;
  SplashOptions splashes;
  RippleOptions ripples;  ///< low = high: the ground's region
  RainLook look;
  RainShown shown = RainShown::all;
  bool with_ripples = true;
  Bounds water;         ///< m; where deep water can be in any frame, and rings on it; empty: where it is in the first
  float rained_mm = 0;  ///< water that has fallen and settled before the film begins
  GroundMaterial bodies = GroundMaterial::steel;  ///< what meshes without cells count as; they are wet once rained on
  float shutter = 1.0f / 60;                      ///< s
  float streak_reach = 12;   ///< m from the eye up to which drops are drawn one by one; beyond, haze
  std::size_t frames = 100;  ///< where there is no water that has frames
  double frames_per_second = 25;
};

/// Rain, its ground, its splashes and ripples as they go on from frame to frame.
class RainyScene {
 public:
  /// @param seen_from_above  what the ground's heights are taken from where settings.ground.mesh names a body; may be
  ///                         null else
  /// @throws Error  as Rain, WetGround, Ripples; as read_png(); invalid_argument: a mesh that is not given
  explicit RainyScene(const RainSettings& settings, const Scene* seen_from_above = nullptr);
  ~RainyScene();
  const RainSettings& settings() const;
  /// Goes on to `time`, s: drops hit the scene's solids and the water, splash, wet the ground and make rings. The same
  /// time again changes nothing.
  /// @param water  may be null; drops that hit it splash as on deep water
  /// @throws Error invalid_argument: a time that is over
  void advance(double time, const Scene& scene, const Surface* water, StageTimes* times = nullptr);
  double time() const;
  std::size_t splashes() const;  ///< going on
  std::size_t hits() const;      ///< so far
  WaterBudget budget() const;    ///< of the ground, with what is in the air as standing
  /// The ground as a mesh, its cover, the puddles' surface, and rings on deep water; null or empty where there is none.
  std::shared_ptr<const Solid> relief() const;
  std::shared_ptr<const GroundCover> cover() const;
  HeightField puddles() const;
  HeightField rings() const;
  /// Splashes and streaks at time().
  std::vector<WaterPiece> pieces(const View& view) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Frames without particles of a film of rain.
FrameSequence rain_sequence(const RainSettings& settings, Axis up);

// --- What a user may set -----------------------------------------------------------------------------------

enum class GroundStyle { chequer, plain, none };
/// @throws Error invalid_argument
GroundStyle ground_style_of(std::string_view name);

/// Everything that a user may say about the picture; what is left alone is guessed from the survey.
struct PictureOptions {
  int width = 1280;  ///< px
  int height = 720;  ///< px
  SurfaceMethod method = SurfaceMethod::raycast;
  Show show = Show::water;
  RaycastOptions surface;  ///< spacing 0 and smoothing_length 0: from the survey
  SizesBy sizes;
  int drop_isolated = 0;
  std::optional<ColourBy> colour;
  bool legend = false;
  std::string material;            ///< empty: water; plastic where particles are coloured
  std::optional<vec3> extinction;  ///< 1/m
  std::optional<vec3> tint;        ///< in (0, 1]: what white light becomes over the depth of the scene
  std::string environment_hdr;     ///< a Radiance .hdr file; empty: the analytic sky
  std::optional<vec2> sun_deg;     ///< azimuth and elevation
  GroundStyle ground = GroundStyle::chequer;
  std::optional<float> ground_height;  ///< m; default the lowest point of the water
  bool shadow = true;
  std::optional<float> ior;           ///< index of refraction, > 1; default the material's
  std::optional<float> roughness;     ///< of the water's reflection, 0 .. 1; default the material's
  std::optional<vec3> ground_albedo;  ///< of the plane, or of the brighter squares (the others are 0.7 of it)
  float sun_scale = 1;                ///< factor of the sun's light, >= 0
  std::vector<BodyOptions> bodies;
  TankStyle tank = TankStyle::none;
  Bounds bodies_bounds;               ///< m; of the bodies in the first frame, which the fitted camera shows too
  std::optional<Bounds> tank_inside;  ///< m; default around the particles of all frames
  std::optional<vec3> tank_albedo;    ///< of the tiles
  std::vector<PointLight> lamps;
  OpticsOptions optics{RefractionMethod::ray_traced};
  bool caustics = true;
  CausticsOptions caustics_options;
  SurfelOptions surfels;
  HeightFieldOptions height_field;
  std::function<HeightField(double)> heights;  ///< as FrameSettings::heights
  CameraOptions camera;
  std::optional<CameraPath> path;    ///< goes before `camera`
  std::optional<float> cloud_cover;  ///< as EnvironmentOptions; default 0, with rain 1
  float sky_scale = 1;               ///< factor of the environment's light, >= 0
  std::optional<RainSettings> rain;
  FoamOptions foam;
  ToneOptions tone;
  Antialias antialias = Antialias::edges;
  std::uint64_t memory_limit = 0;  ///< bytes that the whole process may hold; 0: no limit. See check_memory()
};

/// One thing that was guessed, why, and how to say it yourself.
struct Guess {
  std::string what;   ///< "particle spacing"
  std::string value;  ///< "0.025 m"
  std::string reasoning;
  std::string option;  ///< "--spacing METRES"
};
std::vector<Guess> guesses_of(const Survey& survey, const PictureOptions& options);

/// Settings for the frames of a sequence, with the view of its first picture.
/// @throws Error invalid_argument: options out of range; not_found, malformed_file: the environment map
FrameSettings settings_of(const Survey& survey, const PictureOptions& options);

/// The view of picture `index` of `count`.
View view_of(const Survey& survey, const PictureOptions& options, std::size_t index, std::size_t count,
             double frames_per_second);

// --- Sequences ---------------------------------------------------------------------------------------------

enum class PictureFormat {
  png,
  exr,
  mp4,
  ply,  ///< no picture: the surfels of SurfaceMethod::surfels
};

/// Where pictures go: "still.png", "frames/{}.png", "frames/{:04}.exr", "film.mp4", "surfels_{}.ply".
class OutputTarget {
 public:
  /// @throws Error invalid_argument: no path, an unknown extension, a pattern that cannot be understood
  explicit OutputTarget(std::string path);
  PictureFormat format() const { return format_; }
  bool is_pattern() const { return is_pattern_; }
  bool is_film() const { return format_ == PictureFormat::mp4; }
  const std::string& path() const { return path_; }
  /// The path of one picture: `{}` becomes the number, `{:04}` the number with zeros in front.
  std::string path_of(std::int64_t number) const;
  /// Makes the directory if it is missing and tries to write into it.
  /// @throws Error io_failed naming the path
  void prepare() const;

 private:
  std::string path_;
  PictureFormat format_;
  bool is_pattern_;
};

struct SequenceOptions {
  std::string output;  ///< see OutputTarget
  VideoOptions video;
  bool resume = false;              ///< leave finished files as they are
  bool strict = false;              ///< stop at the first frame that cannot be drawn
  std::size_t turntable = 0;        ///< pictures of a sequence of one frame; 0: one
  std::vector<std::string> layers;  ///< of EXR files; empty: all
  /// Asked for further frames once all are drawn; none: the sequence has ended. Null: it ends with its last frame.
  std::function<std::vector<FramePath>()> further;
  /// Whether a frame that could not be read may still be being written and is to be read again. Null: it is not.
  std::function<bool(const FramePath&)> read_again;
};

/// The numbers of a sequence's pictures: those in the names of its frames if each has one and none has it twice, else
/// they are counted from 0.
std::vector<std::int64_t> picture_numbers(const FrameSequence& sequence);

/// Refuses what render_sequence() would refuse, before any work, and makes the output's directory.
/// @throws Error  invalid_argument: several pictures for one file, an unknown kind of file; io_failed
void check_output(const FrameSequence& sequence, const SequenceOptions& options);

/// What became of one picture.
struct FrameReport {
  std::string path;    ///< of the particles
  std::string output;  ///< of the picture or the film
  std::size_t particles = 0;
  int width = 0, height = 0;
  StageTimes times;
  double frame_ms = 0;             ///< of the whole, reading and writing included
  bool skipped = false;            ///< there already, with SequenceOptions::resume
  std::string problem;             ///< why it was not drawn; empty if it was
  std::vector<std::string> notes;  ///< particles dropped and the like
};

struct SequenceReport {
  std::vector<FrameReport> frames;
  std::size_t drawn = 0, skipped = 0, failed = 0;
  StageTimes times;  ///< sums
};

/// Draws a sequence, one picture a frame, into files or a film. A frame that cannot be read is left out and
/// reported; in a film the picture before it stands still.
/// @param on_frame  called after each picture with its report, its place from 0, and the number of pictures
/// @throws Error  invalid_argument: several pictures for one file; io_failed; with options.strict whatever a frame
///                throws, and the first such error when no frame could be drawn
SequenceReport render_sequence(const FrameSequence& sequence, const Survey& survey, const PictureOptions& picture,
                               const SequenceOptions& options,
                               FunctionRef<void(const FrameReport&, std::size_t, std::size_t)>* on_frame = nullptr);

/// Files, directories, globs or patterns in; a picture, pictures or a film out.
SequenceReport render_files(std::span<const std::string> what, const std::string& output,
                            const PictureOptions& picture = {});

// --- What a run would take ---------------------------------------------------------------------------------

/// Bytes that a run holds at once while it draws its largest frame, by what they are for.
struct RunMemory {
  std::uint64_t program = 0;    ///< with its libraries
  std::uint64_t reading = 0;    ///< the file's bytes and the particles, while a frame is read
  std::uint64_t particles = 0;  ///< of one frame, with their colours
  std::uint64_t surface = 0;    ///< while the surface is made or seen, whichever is more
  std::uint64_t picture = 0;    ///< pictures, light, the film's encoder
  std::uint64_t peak = 0;       ///< of all together: not the sum, as they do not all live at the same time
};

/// What a run would take, before it begins.
struct RunEstimate {
  std::size_t pictures = 0;
  std::uint64_t particles = 0;      ///< in the largest frame
  std::uint64_t all_particles = 0;  ///< in all frames together
  bool counted = true;              ///< by headers; false: some are judged from the sizes of files
  std::uint64_t input_bytes = 0;    ///< of all files
  std::uint64_t output_bytes = 0;
  RunMemory memory;
  int slabs = 1;        ///< parts that the largest frame is drawn in to keep to PictureOptions::memory_limit
  double survey_s = 0;  ///< of the look at all frames before the first picture
  double frame_s = 0;   ///< of the mean picture, on this machine now
  double total_s = 0;
  std::vector<std::string> notes;  ///< what is not in it
};

/// Estimates a run from the frames' headers and file sizes; nothing is written. Memory is within a factor of 1.5, time
/// within 2: it is measured with two small frames of water that are drawn in the same way, in a second or two.
/// @param made_particles  in a frame, of sequences that are made up without being foreseen
/// @param with_times      false: times are left zero, and nothing is drawn
/// @throws Error  not_found, malformed_file ...: no frame has a header that can be understood
RunEstimate estimate_run(const FrameSequence& sequence, const PictureOptions& picture, const SequenceOptions& options,
                         std::uint64_t made_particles = 0, bool with_times = true);

/// Refuses a run that cannot keep to picture.memory_limit, and says what would help. Nothing if there is no limit.
/// @throws Error  limit_exceeded
void check_memory(const FrameSequence& sequence, const PictureOptions& picture, const SequenceOptions& options,
                  std::uint64_t made_particles = 0);

/// Lets allocations fail that would bring the process to more than `bytes`, so that nothing else ends it. 0: nothing.
void hold_memory_below(std::uint64_t bytes);

/// Refuses what check_output() would refuse without touching the disk.
void check_output_name(const FrameSequence& sequence, const SequenceOptions& options);

// --- Scene files -------------------------------------------------------------------------------------------

/// Waves in a tank, made up rather than simulated.
struct WavesOptions {
  std::size_t particles = 100000;  ///< about: they fill a lattice
  std::size_t frames = 50;
  double frames_per_second = 25;
  vec3 size{2.0f, 0.5f, 1.0f};  ///< m; of the still water, y up, its lower corner at the origin
  float height = 0.06f;         ///< m, of the waves from the still level, at most
  float shortest = 0;           ///< m, shortest wavelength; 0: an eighth of the longer horizontal side
};

/// Water that is simulated while it is drawn.
struct SimulatedWater {
  SimulationOptions simulation;  ///< without obstacles: those are the bodies that have a role
  std::size_t frames = 100;
  double frames_per_second = 25;
  int most_steps = 0;                ///< in a frame; 0: as many as its time needs
  std::vector<std::string> dragged;  ///< names of the bodies that simulation.drags move
};

/// Water that is a height field without particles.
struct MadeHeights {
  std::vector<WaveTrain> waves;
  std::string image;                       ///< a PNG file: its brightness is the height; waves run on top of it
  Bounds region{{0, 0, 0}, {2, 0.5f, 2}};  ///< m; of the still water, or from black to white
  float step = 0;                          ///< m between columns
  float smoothing = 0;                     ///< m, of the image
  std::size_t frames = 50;
  double frames_per_second = 25;
};

/// A picture or a film described in a JSON file: docs/scene_file.md.
struct SceneFile {
  std::vector<std::string> frames;  ///< what find_frames() takes, relative to the working directory
  std::optional<std::int64_t> first, last, every;
  ReadOptions reading;                       ///< of the frames
  std::optional<WavesOptions> waves;         ///< water that is made up, instead of frames
  std::optional<SimulatedWater> simulation;  ///< water that is simulated, instead of frames
  std::optional<MadeHeights> heights;        ///< water that is a height field, instead of frames
  std::optional<float> spacing;              ///< m
  std::optional<Axis> up;
  PictureOptions picture;
  std::string output;  ///< empty: not said
  VideoOptions video;
};

/// Reads a scene file. Every field may be missing; paths in it are relative to its own folder.
/// @throws Error  not_found; malformed_file with line and field: not JSON, an unknown field (with the nearest known
///                name), a value of the wrong kind or outside its range
SceneFile read_scene_file(const std::string& path);

/// A JSON Schema (draft 2020-12) of scene files; docs/scene.schema.json holds a copy.
std::string scene_file_schema();

/// Water with waves as particles on a displaced lattice: superposed standing waves that obey the dispersion of gravity
/// waves over the tank's depth, omega^2 = g k tanh(k depth), and are reflected by its walls. A particle keeps its
/// place in the lists at all times and moves continuously. Particles::spacing, up and time are set; there is an
/// attribute "velocity", m/s.
/// @param time  s
/// @throws Error  invalid_argument: no particles, sizes that are not positive, waves too high for their length
Particles synthetic_waves(const WavesOptions& options, double time);
/// The waves as a sequence that is made up frame by frame.
FrameSequence waves_sequence(const WavesOptions& options);

/// The heights at a time, s. The image is read once, now.
/// @throws Error  as height_field() and read_png()
std::function<HeightField(double)> made_heights(const MadeHeights& heights, Axis up);
/// Frames without particles, which know their time.
FrameSequence heights_sequence(const MadeHeights& heights, Axis up);

/// A simulation and its bodies, frame by frame: what is drawn and what is written.
class SimulatedScene {
 public:
  /// @param bodies  those with a role become obstacles
  /// @throws Error  as Simulation; not_found: an event for a body that there is not; as read_mesh()
  SimulatedScene(const SimulatedWater& water, std::vector<BodyOptions> bodies);
  ~SimulatedScene();
  std::size_t frames() const;
  /// The water of frame `index`; frames must be asked for in rising order, the same one again is allowed.
  /// @throws Error invalid_argument: a frame that is over
  Particles frame(std::size_t index, StageTimes* times = nullptr);
  /// Where the bodies are in the frame that was asked for last: as BodyOptions::frames, one a body; bodies that have
  /// not appeared yet have none.
  std::vector<std::optional<glm::mat4>> transforms() const;
  /// What the pictures have in common, without running it: bounds are the tank's.
  Survey survey() const;
  Foreseen foreseen() const;
  Simulation& simulation();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The same as a sequence: its frames must be read in rising order; those between are simulated and left out.
FrameSequence simulated_sequence(const SimulatedWater& water, std::vector<BodyOptions> bodies);

/// What became of one simulated frame.
struct SimulatedFrame {
  std::string output;
  std::size_t particles = 0;
  double time = 0;        ///< s, of the water
  std::size_t steps = 0;  ///< of the simulation since the frame before
  double mean_neighbours = 0;
  double kinetic_energy = 0;  ///< J
  bool skipped = false;       ///< written before, and left as it was
  StageTimes times;
  double frame_ms = 0;  ///< of the whole
};

struct SimulationReport {
  std::vector<SimulatedFrame> frames;
  StageTimes times;               ///< sums
  std::vector<std::string> ways;  ///< files of the moving bodies' transforms; one a body, empty for those that stand
};

/// Simulates and writes frames as PLY files, and beside them, when all are there, the way of each body that moves or
/// appears: a JSON file as `frames` of a scene file's mesh takes it.
/// @param output  a name with {} for the frame's number, .ply; without one for a single frame
/// @param frames  at most so many
/// @param resume  frames that are there already are left as they are, if they are as long as they must be; the
///                simulation runs through them all the same
/// @throws Error  invalid_argument: several frames for one file, another kind of file; io_failed; as SimulatedScene
SimulationReport write_simulation(
    SimulatedScene& scene, std::span<const BodyOptions> bodies, const std::string& output, std::size_t frames,
    bool resume = false, FunctionRef<void(const SimulatedFrame&, std::size_t, std::size_t)>* on_frame = nullptr);

/// The text of a scene file that draws what write_simulation() has written: the scene file's own, with frames instead
/// of the simulation and ways instead of obstacles. Paths are relative to `folder`.
/// @throws Error  as read_scene_file()
std::string scene_of_written_frames(const std::string& scene_path, const std::string& folder, const std::string& output,
                                    const SimulationReport& report);

// --- A scene for measurements ------------------------------------------------------------------------------

/// A tank of water of about 2 : 1 : 2 m (y up) with waves, and a few hundred drops of 1 to 500 particles above it.
/// Particles stand on a lattice, each displaced by up to 0.2 spacings along each axis; Particles::spacing is set.
/// The same `count` and `seed` give the same particles.
/// @throws Error invalid_argument: count of 0
Particles synthetic_tank(std::size_t count, std::uint64_t seed = 1);

/// A water crown in a shallow pool (y up), of the same shape at every count: a floor of water of 2 x 2 m with ring
/// waves, from which a thin conical sheet rises to a rim with jets, and drops thrown from the jets. Lengths that do not
/// follow the shape (the thickness of the sheet, at least three spacings) are said in the definition. Particles stand
/// on a lattice, each displaced by up to 0.2 spacings along each axis, in the lattice's order: coherent, as solvers
/// that sort their particles write them. The same `count` and `seed` give the same particles; exactly `count` of them.
/// @throws Error invalid_argument: count of less than 1000
Particles synthetic_crown(std::size_t count, std::uint64_t seed = 1);
/// The camera the crown is measured with: all of pool, jets and drops in sight, water in 0.59 of a square's pixels.
View crown_view(int width, int height);

}  // namespace meniscus
