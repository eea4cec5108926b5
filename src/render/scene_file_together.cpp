/// What concerns several sections of a scene file.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "render/nearest_name.h"
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

/// Particles that an unsaid spacing makes.
constexpr float kParticles = 20000;

float volume_of(const Bounds& box) { return box.extent().x * box.extent().y * box.extent().z; }

/// The room is open at its top.
bool lies_in(const Bounds& box, const Bounds& room, Axis up) {
  const vec3 slack = 1e-4f * room.extent();
  for (int axis = 0; axis < 3; ++axis)
    if (box.low[axis] < room.low[axis] - slack[axis] ||
        (axis != static_cast<int>(up) && box.high[axis] > room.high[axis] + slack[axis]))
      return false;
  return true;
}

/// The water comes from one place.
void check_source(const JsonValue& water) {
  std::vector<std::string> said;
  for (const char* source : {"frames", "waves", "simulation", "heights"})
    if (water.has(source)) said.emplace_back(source);
  if (said.size() > 1)
    water.refuse_key(said[1], "cannot stand beside " + said[0],
                     "leave one of them out: the water is read, made up, or simulated");
}

void check_drags(const JsonValue& drags, const Draft& draft) {
  std::vector<std::string> names, others;
  for (const BodyOptions& body : draft.scene.picture.bodies)
    if (!body.name.empty()) (body.role ? names : others).push_back(body.name);
  for (std::size_t i = 0; i < drags.size(); ++i) {
    const JsonValue name = drags.at(i).member("body");
    if (std::find(names.begin(), names.end(), name.text()) != names.end()) continue;
    if (std::find(others.begin(), others.end(), name.text()) != others.end())
      name.refuse("is no obstacle", "a mesh with a field obstacle", name.dump(), "give the mesh \"obstacle\": {}");
    const std::string nearest = nearest_name(name.text(), names);
    name.refuse(
        "is the name of no mesh",
        names.empty() ? std::string("a mesh with name and obstacle") : fmt::format("{}", fmt::join(names, ", ")),
        name.dump(), nearest.empty() ? "" : "did you mean " + nearest + "?");
  }
}

float spacing_for(const SimulationOptions& simulation) {
  float volume = 0;
  for (const Bounds& block : simulation.blocks) volume += volume_of(block);
  if (simulation.blocks.empty()) volume = 0.5f * volume_of(simulation.tank);
  return std::cbrt(volume / kParticles);
}

/// What the sections say together, and what a simulation needs to know.
void finish_simulation(const JsonValue& value, Draft& draft) {
  SceneFile& scene = draft.scene;
  PictureOptions& picture = scene.picture;
  SimulationOptions& simulation = scene.simulation->simulation;
  if (simulation.tank.empty()) {
    if (!picture.tank_inside)
      value.refuse("has no tank", "tank: [[x, y, z], [x, y, z]], here or as tank.inside", "none");
    simulation.tank = *picture.tank_inside;
  }
  simulation.up = scene.up.value_or(Axis::y);
  simulation.fluid.gravity = draft.gravity.value_or(-9.81f * direction_of(simulation.up));
  if (simulation.blocks.empty() && simulation.pours.empty()) value.refuse("has no water", "blocks or pour", "neither");
  for (std::size_t i = 0; i < simulation.blocks.size(); ++i)
    if (!lies_in(simulation.blocks[i], simulation.tank, simulation.up))
      value.member("blocks").at(i).refuse("reaches out of the tank", "a block within the tank",
                                          value.member("blocks").at(i).dump());
  if (!(simulation.fluid.spacing > 0)) simulation.fluid.spacing = scene.spacing.value_or(spacing_for(simulation));
  if (simulation.fluid.solver == Solver::pbf && simulation.fluid.viscosity > 1)
    value.member("viscosity").refuse("is out of range", "0 to 1 for pbf", value.member("viscosity").dump());
  const std::string other = simulation.fluid.solver == Solver::pbf ? "sph" : "pbf";
  const std::vector<const char*> foreign = simulation.fluid.solver == Solver::pbf
                                               ? std::vector<const char*>{"surface_tension", "stiffness"}
                                               : std::vector<const char*>{"iterations", "vorticity"};
  for (const char* field : foreign)
    if (value.has(field)) value.refuse_key(field, "is of the solver " + other + " only", "leave it out");
  if (value.has("drag")) check_drags(value.member("drag"), draft);

  // Tank, ground and columns are those of the simulation unless the scene says otherwise.
  if (!picture.tank_inside) picture.tank_inside = simulation.tank;
  if (!picture.ground_height) picture.ground_height = simulation.tank.low[static_cast<int>(simulation.up)];
  if (picture.height_field.region.empty()) picture.height_field.region = simulation.tank;
}

void finish_heights(const JsonValue& water, Draft& draft) {
  SceneFile& scene = draft.scene;
  const JsonValue value = water.member("heights");
  if (!value.has("region"))
    value.refuse("has no region", "region: [[x, y, z], [x, y, z]], corners of the still water", "none");
  if (water.has("surface") && scene.picture.method != SurfaceMethod::height_field)
    water.refuse_key("surface", "cannot be other than height_field beside heights", "leave it out");
  if (draft.scene.picture.colour)
    value.refuse("has no particles with quantities to colour by", "no section colour", "one");
  scene.picture.method = SurfaceMethod::height_field;
  if (!scene.up) scene.up = Axis::y;
  if (!scene.picture.ground_height)
    scene.picture.ground_height = scene.heights->region.low[static_cast<int>(*scene.up)];
  try {
    scene.picture.heights = made_heights(*scene.heights, *scene.up);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument && error.code() != ErrorCode::limit_exceeded) throw;
    value.refuse("cannot be: " + error.detail().problem, error.detail().expected, error.detail().found);
  }
}

bool has_water(const SceneFile& scene) {
  return !scene.frames.empty() || scene.waves || scene.simulation || scene.heights;
}

/// Where the rain's ground is, and what it is made from.
void finish_rain(const JsonValue& value, const Draft& draft) {
  const SceneFile& scene = draft.scene;
  if (has_water(scene))
    for (const char* field : {"frames", "fps"})
      if (value.has(field)) value.refuse_key(field, "is of rain without water", "leave it out: the water has frames");
  if (!value.has("ground")) {
    if (!has_water(scene) && scene.picture.bodies.empty() && !value.has("region"))
      value.refuse("has nothing to fall on", "ground, meshes, water or a region", "none of them");
    return;
  }
  const JsonValue ground = value.member("ground");
  if (!ground.has("region") && !ground.has("mesh") && !has_water(scene))
    ground.refuse("has no region", "region: [[a, b], [a, b]], two opposite corners, or a mesh", "neither");
  if (!ground.has("mesh")) return;
  std::vector<std::string> names;
  for (const BodyOptions& body : scene.picture.bodies)
    if (!body.name.empty()) names.push_back(body.name);
  const JsonValue name = ground.member("mesh");
  if (std::find(names.begin(), names.end(), name.text()) != names.end()) return;
  const std::string nearest = nearest_name(name.text(), names);
  name.refuse("is the name of no mesh",
              names.empty() ? std::string("a mesh with a name") : fmt::format("{}", fmt::join(names, ", ")),
              name.dump(), nearest.empty() ? "" : "did you mean " + nearest + "?");
}

}  // namespace

void finish_file(const JsonValue& value, Draft& draft) {
  SceneFile& scene = draft.scene;
  if (value.has("water")) check_source(value.member("water"));
  for (std::size_t i = 0; i < scene.picture.bodies.size(); ++i)
    if (scene.picture.bodies[i].role && !scene.simulation)
      value.member("meshes").at(i).refuse_key("obstacle", "needs water.simulation",
                                              "leave it out, or simulate the water that it stands in");
  if (scene.simulation) finish_simulation(value.member("water").member("simulation"), draft);
  if (scene.heights) finish_heights(value.member("water"), draft);
  if (scene.picture.rain) finish_rain(value.member("rain"), draft);
  // A film runs as fast as its water, unless it is told to run otherwise.
  const bool said = value.has("output") && value.member("output").has("fps");
  if (!said && scene.simulation) scene.video.frames_per_second = scene.simulation->frames_per_second;
  if (!said && scene.picture.rain && !has_water(scene))
    scene.video.frames_per_second = scene.picture.rain->frames_per_second;
  if (!said && scene.heights) scene.video.frames_per_second = scene.heights->frames_per_second;
}

}  // namespace meniscus::scene_file
