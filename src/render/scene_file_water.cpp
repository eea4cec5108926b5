/// The sections on the water itself: what is read, its surface, its look, its colours.
#include "render/scene_file_fields.h"

namespace meniscus::scene_file {
namespace {

PictureOptions& picture(Draft& d) { return d.scene.picture; }

void store_frames(const JsonValue& value, Draft& draft) {
  draft.scene.frames.clear();
  if (value.is_text()) draft.scene.frames.push_back(draft.resolved(value.text()));
  if (value.is_list())
    for (std::size_t i = 0; i < value.size(); ++i) draft.scene.frames.push_back(draft.resolved(value.at(i).text()));
}

void store_up(const JsonValue& value, Draft& draft) {
  for (const Axis axis : {Axis::x, Axis::y, Axis::z})
    if (value.text() == name_of(axis)) draft.scene.up = axis;
}

void finish_water(const JsonValue& value, Draft& draft) {
  const SceneFile& scene = draft.scene;
  if (scene.first && scene.last && *scene.first > *scene.last)
    value.refuse_key("last", "comes before first", "give the lower number first");
}

}  // namespace

const Section& water_section() {
  static const Section section{
      "water",
      "What the water is, how its surface is found, and what it looks like.",
      {{"frames",
        {{Kind::path}, {Kind::texts}},
        "(none)",
        "Files, directories, globs, or patterns with `{}` for the frame number",
        store_frames},
       {"reading", {an_object(reading_section())}, "{}", "How the files of `frames` are read", nullptr},
       {"waves",
        {an_object(waves_section())},
        "(none)",
        "Water that is made up, instead of frames",
        [](const JsonValue&, Draft& d) { d.scene.waves.emplace(); }},
       {"first",
        {an_integer(0, 1e15)},
        "(all)",
        "Number of the first frame",
        [](const JsonValue& v, Draft& d) { d.scene.first = v.integer(); }},
       {"last",
        {an_integer(0, 1e15)},
        "(all)",
        "Number of the last frame, which is included",
        [](const JsonValue& v, Draft& d) { d.scene.last = v.integer(); }},
       {"every",
        {an_integer(1, 1e9)},
        "1",
        "Only every n-th frame",
        [](const JsonValue& v, Draft& d) { d.scene.every = v.integer(); }},
       {"spacing",
        {a_number(above(0))},
        "(estimated)",
        "Distance between neighbouring particles, m",
        [](const JsonValue& v, Draft& d) { d.scene.spacing = v.real(); }},
       {"up",
        {a_name({"x", "y", "z"})},
        "(guessed; y where water is made up or simulated)",
        "Axis that points up",
        store_up},
       // After spacing and up, which are their defaults.
       {"simulation",
        {an_object(simulation_section())},
        "(none)",
        "Water that is simulated, instead of frames",
        [](const JsonValue&, Draft& d) { d.scene.simulation.emplace(); }},
       {"heights",
        {an_object(heights_section())},
        "(none)",
        "Water that is a made-up height field, instead of frames",
        [](const JsonValue&, Draft& d) { d.scene.heights.emplace(); }},
       {"height_field", {an_object(height_field_section())}, "{}", "How the surface `height_field` is found", nullptr},
       {"foam", {an_object(foam_section())}, "{}", "Spray, foam and bubbles beside the water", nullptr},
       {"smoothing_length",
        {a_number(above(0))},
        "(2 spacings)",
        "Reach of a particle's kernel, m",
        [](const JsonValue& v, Draft& d) {
          picture(d).surface.smoothing_length = picture(d).surfels.smoothing_length = v.real();
        }},
       {"radius_attribute",
        {{Kind::text}},
        "(none: all particles are alike)",
        "Attribute with each particle's radius, m, half its spacing; of a ray-cast surface",
        [](const JsonValue& v, Draft& d) { picture(d).sizes.radius = v.text(); }},
       {"smoothing_attribute",
        {{Kind::text}},
        "(none: follows from the spacing)",
        "Attribute with the reach of each particle's kernel, m; of a ray-cast surface",
        [](const JsonValue& v, Draft& d) { picture(d).sizes.smoothing_length = v.text(); }},
       {"surface",
        {a_name({"raycast", "surfels", "height_field", "spheres"})},
        "\"raycast\"",
        "What represents the water; made-up heights are a height_field",
        [](const JsonValue& v, Draft& d) { picture(d).method = surface_method_of(v.text()); }},
       {"kernel",
        {a_name({"cubic_spline", "poly6", "wyvill"})},
        "(cubic_spline; wyvill for surfels)",
        "Smoothing kernel",
        [](const JsonValue& v, Draft& d) {
          picture(d).surface.kernel = picture(d).surfels.kernel = kernel_of(v.text());
        }},
       {"iso",
        {a_number({0, 1, true, true})},
        "0.5",
        "Density of the surface as a fraction of that inside the water",
        [](const JsonValue& v, Draft& d) { picture(d).surface.iso = picture(d).surfels.iso = v.real(); }},
       {"step",
        {a_number({0, 1, true})},
        "0.25",
        "Step of the march, in smoothing lengths",
        [](const JsonValue& v, Draft& d) { picture(d).surface.step = v.real(); }},
       {"refinement",
        {a_name({"secant", "bisection"})},
        "\"secant\"",
        "How the crossing is closed in on",
        [](const JsonValue& v, Draft& d) { picture(d).surface.refinement = refinement_of(v.text()); }},
       {"refinement_steps",
        {an_integer(0, 32)},
        "2",
        "Evaluations after the crossing has been bracketed",
        [](const JsonValue& v, Draft& d) { picture(d).surface.refinement_steps = static_cast<int>(v.integer()); }},
       {"normals",
        {a_name({"gradient", "pca", "blend"})},
        "\"blend\"",
        "How normals are found",
        [](const JsonValue& v, Draft& d) { picture(d).surface.normals = normal_method_of(v.text()); }},
       {"normal_radius",
        {a_number(above(0))},
        "(3 spacings)",
        "Reach of the normals' sums, m",
        [](const JsonValue& v, Draft& d) { picture(d).surface.normal_radius = v.real(); }},
       {"blend_sharpness",
        {a_number(at_least(0))},
        "10",
        "How fast the blend turns to the gradient where both normals differ",
        [](const JsonValue& v, Draft& d) { picture(d).surface.blend_sharpness = v.real(); }},
       {"blend_agreement",
        {a_number(between(0, 1))},
        "0.998",
        "Cosine between both normals from which on pca alone is taken",
        [](const JsonValue& v, Draft& d) { picture(d).surface.blend_agreement = v.real(); }},
       {"filter_radius",
        {an_integer(0, 64)},
        "4",
        "Of the filter that smooths the normals, px; 0 switches it off",
        [](const JsonValue& v, Draft& d) { picture(d).surface.filter_radius = static_cast<int>(v.integer()); }},
       {"keep_thin",
        {a_boolean()},
        "true",
        "Keep drops, jets and thin sheets whole",
        [](const JsonValue& v, Draft& d) {
          picture(d).surface.keep_thin = picture(d).surfels.keep_thin = v.boolean();
        }},
       {"grid_step",
        {a_number(above(0))},
        "(half a spacing)",
        "Surfels: between points of the density grid, m",
        [](const JsonValue& v, Draft& d) { picture(d).surfels.grid_step = v.real(); }},
       {"gap_threshold",
        {a_number(above(0))},
        "(1.5 grid steps)",
        "Surfels: between neighbours beyond which points are added, m",
        [](const JsonValue& v, Draft& d) { picture(d).surfels.gap_threshold = v.real(); }},
       {"epsilon",
        {a_number(above(0))},
        "(a spacing)",
        "Surfels: discs this close in depth are blended, m",
        [](const JsonValue& v, Draft& d) { picture(d).surfels.epsilon = v.real(); }},
       {"drop_isolated",
        {an_integer(0, 1e6)},
        "0",
        "Leave out particles with fewer neighbours than this",
        [](const JsonValue& v, Draft& d) { picture(d).drop_isolated = static_cast<int>(v.integer()); }},
       {"material",
        {a_name(material_names())},
        "(water; plastic where particles are coloured)",
        "What the liquid is",
        [](const JsonValue& v, Draft& d) { picture(d).material = v.text(); }},
       {"ior",
        {a_number({1, 4, true})},
        "(the material's)",
        "Index of refraction",
        [](const JsonValue& v, Draft& d) { picture(d).ior = v.real(); }},
       {"extinction",
        {numbers(3, at_least(0))},
        "(the material's)",
        "Absorption in red, green and blue, 1/m",
        [](const JsonValue& v, Draft& d) { picture(d).extinction = v.three(); }},
       {"tint",
        {numbers(3, {0, 1, true})},
        "(the material's)",
        "Linear colour that white light has after the depth of the scene",
        [](const JsonValue& v, Draft& d) { picture(d).tint = v.three(); }},
       {"roughness",
        {a_number(between(0, 1))},
        "(the material's)",
        "Of the water's mirror image",
        [](const JsonValue& v, Draft& d) { picture(d).roughness = v.real(); }}},
      nullptr,
      finish_water};
  return section;
}

const Section& colour_section() {
  static const Section section{"colour",
                               "Water coloured by a quantity of its particles.",
                               {{"by",
                                 {{Kind::text}},
                                 "(none)",
                                 "A particle attribute; of vectors the magnitude",
                                 [](const JsonValue& v, Draft& d) { d.colour.attribute = v.text(); }},
                                {"map",
                                 {a_name({"viridis", "magma", "turbo", "coolwarm", "grey"})},
                                 "\"viridis\"",
                                 "The colour map",
                                 [](const JsonValue& v, Draft& d) { d.colour.colormap = colormap_of(v.text()); }},
                                {"range",
                                 {numbers(2)},
                                 "(of the whole sequence)",
                                 "Values at the ends of the map, rising",
                                 [](const JsonValue& v, Draft& d) {
                                   if (!(v.two().x < v.two().y))
                                     v.refuse("does not rise", "the lower value first", v.dump());
                                   d.colour.range = {v.two().x, v.two().y};
                                 }},
                                {"legend",
                                 {a_boolean()},
                                 "false",
                                 "Draw a colour bar",
                                 [](const JsonValue& v, Draft& d) { picture(d).legend = v.boolean(); }}},
                               nullptr,
                               [](const JsonValue& value, Draft& draft) {
                                 if (!draft.colour.attribute.empty())
                                   picture(draft).colour = draft.colour;
                                 else if (draft.colour.range || picture(draft).legend)
                                   value.refuse("has no by", "the name of a particle attribute", "none");
                               }};
  return section;
}

}  // namespace meniscus::scene_file
