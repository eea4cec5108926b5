/// The section on water that is simulated.
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

SimulatedWater& water(Draft& d) { return *d.scene.simulation; }
FluidOptions& fluid(Draft& d) { return water(d).simulation.fluid; }

void store_blocks(const JsonValue& value, Draft& draft) {
  for (std::size_t i = 0; i < value.size(); ++i) water(draft).simulation.blocks.push_back(box_of(value.at(i)));
}

void store_gravity(const JsonValue& value, Draft& draft) {
  draft.gravity = value.is_list() ? value.three() : -value.real() * direction_of(draft.scene.up.value_or(Axis::y));
}

}  // namespace

const Section& simulation_section() {
  static const Section section{
      "water.simulation",
      "Water that is simulated while it is drawn, or by `meniscus simulate`, in a box that is open at the top. Meshes "
      "with a field `obstacle` stand, move or float in it. The frames are numbered from 0, the state at the start.",
      {{"solver",
        {a_name({"sph", "pbf"})},
        "\"sph\"",
        "Smoothed particles, for small tanks; or position based fluids, for larger tanks and steps",
        [](const JsonValue& v, Draft& d) { fluid(d).solver = solver_of(v.text()); }},
       {"spacing",
        {a_number(above(0))},
        "(water.spacing; else so that the blocks, or half of the tank, hold 20000 particles)",
        "Edge of the cube of water that one particle stands for, m",
        [](const JsonValue& v, Draft& d) { fluid(d).spacing = v.real(); }},
       {"frames",
        {an_integer(1, 1e6)},
        "100",
        "Number of frames",
        [](const JsonValue& v, Draft& d) { water(d).frames = static_cast<std::size_t>(v.integer()); }},
       {"fps",
        {a_number(between(0.1, 10000))},
        "25",
        "Frames a second of the water's time, and of the film unless output.fps says otherwise",
        [](const JsonValue& v, Draft& d) { water(d).frames_per_second = v.number(); }},
       {"step",
        {a_number({0, 1, true})},
        "(0.003 for sph, or less; 1/120 for pbf)",
        "Of time, s",
        [](const JsonValue& v, Draft& d) { fluid(d).step = v.real(); }},
       {"most_steps",
        {an_integer(0, 1e6)},
        "0",
        "Steps in a frame at most: the water is slowed rather than the picture; 0: as many as its time needs",
        [](const JsonValue& v, Draft& d) { water(d).most_steps = static_cast<int>(v.integer()); }},
       {"smoothing_length",
        {a_number(above(0))},
        "(2 spacings)",
        "Reach of the solver's kernels, m",
        [](const JsonValue& v, Draft& d) { fluid(d).smoothing_length = v.real(); }},
       {"viscosity",
        {a_number(at_least(0))},
        "(the solver's)",
        "sph: Pa s, of the model; pbf: the part of the neighbours' velocity that is taken on, 0 to 1",
        [](const JsonValue& v, Draft& d) { fluid(d).viscosity = v.real(); }},
       {"surface_tension",
        {a_number(at_least(0))},
        "(the solver's)",
        "sph: N/m, of the model",
        [](const JsonValue& v, Draft& d) { fluid(d).surface_tension = v.real(); }},
       {"stiffness",
        {a_number(above(0))},
        "(as stiff as the step allows)",
        "sph: pressure over the excess of density, m^2/s^2",
        [](const JsonValue& v, Draft& d) { fluid(d).stiffness = v.real(); }},
       {"iterations",
        {an_integer(1, 64)},
        "4",
        "pbf: of the density constraint in each step",
        [](const JsonValue& v, Draft& d) { fluid(d).iterations = static_cast<int>(v.integer()); }},
       {"vorticity",
        {a_number(at_least(0))},
        "(the solver's)",
        "pbf: strength of the vorticity confinement",
        [](const JsonValue& v, Draft& d) { fluid(d).vorticity = v.real(); }},
       {"gravity",
        {a_number(between(-1000, 1000)), numbers(3, between(-1000, 1000))},
        "9.81",
        "Downwards, or as a vector, m/s^2",
        store_gravity},
       {"density",
        {a_number(above(0))},
        "1000",
        "Of the liquid, kg/m^3",
        [](const JsonValue& v, Draft& d) { fluid(d).rest_density = v.real(); }},
       {"most_particles",
        {an_integer(1, 1e9)},
        "10000000",
        "What is poured stops there",
        [](const JsonValue& v, Draft& d) {
          water(d).simulation.most_particles = static_cast<std::size_t>(v.integer());
        }},
       {"tank",
        {{Kind::rows, {}, 2, 2, 3}},
        "(tank.inside)",
        "Two opposite corners of the box that holds the water, m",
        [](const JsonValue& v, Draft& d) { water(d).simulation.tank = box_of(v); }},
       {"blocks", {{Kind::boxes}}, "[]", "Water at the start: two opposite corners of each block, m", store_blocks},
       {"pour", {objects(pour_section())}, "[]", "Jets of water", nullptr},
       {"stir", {objects(stir_section())}, "[]", "Water that is stirred", nullptr},
       {"tilt", {objects(tilt_section())}, "[]", "The tank leans over and comes back", nullptr},
       {"drag", {objects(drag_section())}, "[]", "Bodies that are drawn to a place", nullptr}}};
  return section;
}

}  // namespace meniscus::scene_file
