/// The sections on what happens in a simulation: pour, stir, tilt, drag.
#include <glm/geometric.hpp>

#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

SimulatedWater& water(Draft& d) { return *d.scene.simulation; }
SimulationOptions& simulation(Draft& d) { return water(d).simulation; }
Pour& pour(Draft& d) { return simulation(d).pours.back(); }
Stir& stir(Draft& d) { return simulation(d).stirs.back(); }
Tilt& tilt(Draft& d) { return simulation(d).tilts.back(); }
Drag& drag(Draft& d) { return simulation(d).drags.back(); }

/// s; the end of the last frame.
double end_of(Draft& d) { return static_cast<double>(water(d).frames) / water(d).frames_per_second; }

/// An event lasts for the whole film unless it says otherwise.
template <class Event>
Event& appended(std::vector<Event>& events, Draft& draft) {
  events.emplace_back();
  events.back().until = end_of(draft);
  return events.back();
}

template <class Event>
void check_times(const JsonValue& value, const Event& event) {
  if (event.from < event.until) return;
  // Both ends said, or the film ends before it begins.
  if (value.has("until")) value.refuse_key("until", "does not come after from", "give the earlier time first");
  value.refuse_key("from", "comes after the last frame", "simulate more frames, or let it begin earlier");
}

/// from and until, the same for all events.
template <auto event_of>
std::vector<Field> with_times(std::vector<Field> fields) {
  std::vector<Field> all{
      {"from",
       {a_number(between(0, 1e9))},
       "0",
       "s",
       [](const JsonValue& v, Draft& d) { event_of(d).from = v.number(); }},
      {"until", {a_number(between(0, 1e9))}, "(the film's end)", "s", [](const JsonValue& v, Draft& d) {
         event_of(d).until = v.number();
       }}};
  for (Field& field : fields) all.push_back(std::move(field));
  return all;
}

void check_axis(const JsonValue& value) {
  const float length = glm::length(value.three());
  if (!(length > 1e-10f && length < 1e10f)) value.refuse("is no direction", "a length above 0", value.dump());
}

void need(const JsonValue& value, const char* field, const char* expected) {
  if (!value.has(field)) value.refuse(std::string("has no ") + field, expected, "none");
}

}  // namespace

const Section& pour_section() {
  static const Section section{
      "water.simulation.pour[]", "A jet of water that comes out of a disc.",
      with_times<pour>({{"at",
                         {numbers(3)},
                         "(must be said)",
                         "Centre of the disc, m",
                         [](const JsonValue& v, Draft& d) { pour(d).at = v.three(); }},
                        {"velocity",
                         {numbers(3, between(-1000, 1000))},
                         "(1 m/s downwards)",
                         "m/s; the disc faces this way",
                         [](const JsonValue& v, Draft& d) {
                           check_axis(v);
                           pour(d).velocity = v.three();
                         }},
                        {"radius",
                         {a_number(above(0))},
                         "0.05",
                         "m",
                         [](const JsonValue& v, Draft& d) { pour(d).radius = v.real(); }}}),
      [](Draft& d) { appended(simulation(d).pours, d).velocity = -direction_of(d.scene.up.value_or(Axis::y)); },
      [](const JsonValue& value, Draft& draft) {
        need(value, "at", "[x, y, z] in metres");
        check_times(value, pour(draft));
      }};
  return section;
}

const Section& stir_section() {
  static const Section section{
      "water.simulation.stir[]", "Water within a cylinder is driven around its axis.",
      with_times<stir>({{"centre",
                         {numbers(3)},
                         "(must be said)",
                         "A point of the axis, m",
                         [](const JsonValue& v, Draft& d) { stir(d).centre = v.three(); }},
                        {"axis",
                         {numbers(3)},
                         "(upwards)",
                         "Any length but 0",
                         [](const JsonValue& v, Draft& d) {
                           check_axis(v);
                           stir(d).axis = v.three();
                         }},
                        {"radius",
                         {a_number(above(0))},
                         "0.1",
                         "m",
                         [](const JsonValue& v, Draft& d) { stir(d).radius = v.real(); }},
                        {"speed",
                         {a_number(between(-1000, 1000))},
                         "1",
                         "m/s at the radius; either way round",
                         [](const JsonValue& v, Draft& d) { stir(d).speed = v.real(); }}}),
      [](Draft& d) { appended(simulation(d).stirs, d).axis = direction_of(d.scene.up.value_or(Axis::y)); },
      [](const JsonValue& value, Draft& draft) {
        need(value, "centre", "[x, y, z] in metres");
        check_times(value, stir(draft));
      }};
  return section;
}

const Section& tilt_section() {
  static const Section section{
      "water.simulation.tilt[]",
      "The tank leans over about an axis and comes back: it stays where it is in the picture, and gravity turns.",
      with_times<tilt>({{"axis",
                         {numbers(3)},
                         "[0, 0, 1]",
                         "Any length but 0",
                         [](const JsonValue& v, Draft& d) {
                           check_axis(v);
                           tilt(d).axis = v.three();
                         }},
                        {"angle",
                         {a_number(between(-180, 180))},
                         "11.5",
                         "Degrees, half-way between from and until",
                         [](const JsonValue& v, Draft& d) { tilt(d).angle = v.real() * 0.01745329252f; }}}),
      [](Draft& d) { appended(simulation(d).tilts, d).angle = 11.5f * 0.01745329252f; },
      [](const JsonValue& value, Draft& draft) { check_times(value, tilt(draft)); }};
  return section;
}

const Section& drag_section() {
  static const Section section{
      "water.simulation.drag[]", "A body is drawn to a place; a dynamic one is let go there.",
      with_times<drag>({{"body",
                         {{Kind::text}},
                         "(must be said)",
                         "The name of a mesh that is an obstacle",
                         [](const JsonValue& v, Draft& d) { water(d).dragged.back() = v.text(); }},
                        {"to",
                         {numbers(3)},
                         "(must be said)",
                         "Where its origin goes, m",
                         [](const JsonValue& v, Draft& d) { drag(d).to = v.three(); }}}),
      [](Draft& d) {
        appended(simulation(d).drags, d);
        water(d).dragged.emplace_back();
      },
      [](const JsonValue& value, Draft& draft) {
        need(value, "body", "the name of a mesh");
        need(value, "to", "[x, y, z] in metres");
        check_times(value, drag(draft));
      }};
  return section;
}

}  // namespace meniscus::scene_file
