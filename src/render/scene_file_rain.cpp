/// The sections on rain and on the ground that it falls on.
#include "render/scene_file_rain.h"

namespace meniscus::scene_file {
namespace {

RainSettings& rain(Draft& d) { return *d.scene.picture.rain; }
GroundMaterial material_of(const JsonValue& v) { return ground_material_of(v.text()); }
Form a_material() { return a_name({"concrete", "asphalt", "steel"}); }
Form a_rectangle() { return {Kind::rows, {}, 2, 2, 2}; }

/// Two opposite corners, or a refusal.
void store_rectangle(const JsonValue& value, vec2& low, vec2& high) {
  const vec2 a = value.at(0).two(), b = value.at(1).two();
  low = glm::min(a, b);
  high = glm::max(a, b);
  if (!(low.x < high.x && low.y < high.y))
    value.refuse("has no space inside", "two corners that differ in both numbers", value.dump());
}

void finish_rain(const JsonValue& value, Draft& draft) {
  const RainOptions& options = rain(draft).rain;
  if (!(options.smallest_mm < options.largest_mm))
    value.refuse("has no drops", "smallest_mm below largest_mm",
                 std::to_string(options.smallest_mm) + " and " + std::to_string(options.largest_mm));
  if (value.has("wind") && value.has("wind_field"))
    value.refuse_key("wind", "cannot stand beside wind_field", "leave one of them out");
}

}  // namespace

RainShown rain_shown_of(const std::string& name) {
  return name == "splashes"  ? RainShown::splashes
         : name == "streaks" ? RainShown::streaks
         : name == "neither" ? RainShown::neither
                             : RainShown::all;
}

std::shared_ptr<const Particles> wind_field_of(const std::string& path) {
  auto field = std::make_shared<Particles>(read_particles(path));
  const Attribute* velocity = field->find("velocity");
  if (!velocity || velocity->components != 3)
    throw Error(
        ErrorCode::not_found,
        {"a field of wind needs velocities", "an attribute velocity of 3 components", "none", path, {}, {}, {}});
  return field;
}

const Section& rain_ground_section() {
  static const auto ground = [](Draft& d) -> RainGround& { return rain(d).ground; };
  static const Section section{
      "rain.ground",
      "Ground as square cells that soak up water and carry it. It takes the place of the section `ground`. a and b are "
      "the horizontal axes in the order x, y, z: x and z where y is up.",
      {{"region",
        {a_rectangle()},
        "(that of the mesh, or of the water)",
        "Two opposite corners along a and b, m",
        [](const JsonValue& v, Draft& d) { store_rectangle(v, ground(d).cells.low, ground(d).cells.high); }},
       {"cell",
        {a_number({0.001, 10})},
        "0.02",
        "Edge of a cell, m",
        [](const JsonValue& v, Draft& d) { ground(d).cells.cell = v.real(); }},
       {"level",
        {a_number()},
        "0",
        "Of cells of height 0, along the up axis, m",
        [](const JsonValue& v, Draft& d) { ground(d).cells.level = v.real(); }},
       {"material",
        {a_material()},
        "\"asphalt\"",
        "Of all cells, unless there is an image of them",
        [](const JsonValue& v, Draft& d) { ground(d).cells.material = material_of(v); }},
       {"materials",
        {{Kind::file}},
        "(none)",
        "A PNG file over the region: dark is asphalt, grey concrete, bright steel; its first row is the far end of b",
        [](const JsonValue& v, Draft& d) { ground(d).materials = d.resolved(v.text()); }},
       {"heights",
        {{Kind::file}},
        "(none)",
        "A PNG file over the region: black is `lowest`, white `highest`",
        [](const JsonValue& v, Draft& d) { ground(d).heights = d.resolved(v.text()); }},
       {"lowest",
        {a_number(between(-1000, 1000))},
        "0",
        "m above the level",
        [](const JsonValue& v, Draft& d) { ground(d).lowest = v.real(); }},
       {"highest",
        {a_number(between(-1000, 1000))},
        "0.02",
        "m above the level",
        [](const JsonValue& v, Draft& d) { ground(d).highest = v.real(); }},
       {"mesh",
        {{Kind::text}},
        "(none)",
        "Name of one of the meshes, whose height seen from above is the ground's; it is drawn as that",
        [](const JsonValue& v, Draft& d) { ground(d).mesh = v.text(); }},
       {"ruts",
        {a_number(between(0, 10))},
        "0",
        "Depth of two wheel tracks along a in the middle of the region, m; they are deeper here and there",
        [](const JsonValue& v, Draft& d) { ground(d).rut_depth = v.real(); }},
       {"slope",
        {a_number(between(-1, 1))},
        "0",
        "Metres that a metre away from the middle of b is lower",
        [](const JsonValue& v, Draft& d) { ground(d).slope = v.real(); }},
       {"roughness",
        {a_number(between(0, 1))},
        "(that of each material)",
        "Standard deviation of noise on the heights, m",
        [](const JsonValue& v, Draft& d) { ground(d).cells.roughness = v.real(); }},
       {"roughness_length",
        {a_number(above(0))},
        "0.1",
        "Of the largest bumps of that noise, m",
        [](const JsonValue& v, Draft& d) { ground(d).cells.roughness_length = v.real(); }},
       {"seed",
        {an_integer(0, 1e9)},
        "1",
        "Of the noise and the ruts",
        [](const JsonValue& v, Draft& d) { ground(d).cells.seed = static_cast<std::uint64_t>(v.integer()); }}},
      [](Draft& d) { ground(d).there = true; },
      [](const JsonValue& value, Draft& d) {
        if (value.has("mesh") && value.has("heights"))
          value.refuse_key("mesh", "cannot stand beside heights", "leave one of them out");
        if (value.has("material") && value.has("materials"))
          value.refuse_key("material", "cannot stand beside materials", "leave one of them out");
        static_cast<void>(d);
      }};
  return section;
}

const Section& rain_drop_section() {
  static const auto drop = [](Draft& d) -> RainDrop& { return rain(d).rain.drops.back(); };
  static const Section section{"rain.drops[]",
                               "One drop that falls like those of the rain.",
                               {{"time",
                                 {a_number(between(-1000, 1e6))},
                                 "0",
                                 "When it would reach the level of the lowest ground, s of the film",
                                 [](const JsonValue& v, Draft& d) { drop(d).time = v.number(); }},
                                {"place",
                                 {numbers(3, between(-1e6, 1e6))},
                                 "[0, 0, 0]",
                                 "Where it would; the coordinate along the up axis does not count, m",
                                 [](const JsonValue& v, Draft& d) { drop(d).place = v.three(); }},
                                {"diameter_mm",
                                 {a_number(between(0.1, 20))},
                                 "2",
                                 "mm",
                                 [](const JsonValue& v, Draft& d) { drop(d).diameter = 1e-3f * v.real(); }}},
                               [](Draft& d) {
                                 rain(d).rain.drops.emplace_back();
                                 drop(d).diameter = 2e-3f;
                               }};
  return section;
}

const Section& rain_section() {
  static const Section section{
      "rain",
      "Rain, its splashes and what it does to the ground. Without water of its own a scene of rain has `frames` "
      "frames, numbered from 0. The sky is overcast unless environment.clouds says otherwise.",
      {{"rate_mm_h",
        {a_number(between(0, 1000))},
        "10",
        "Water an hour, mm: 2 is a drizzle, 10 steady rain, 50 a cloudburst; 0: only `drops`",
        [](const JsonValue& v, Draft& d) { rain(d).rain.rate_mm_h = v.real(); }},
       {"wind",
        {numbers(3, between(-100, 100))},
        "[0, 0, 0]",
        "The mean, m/s",
        [](const JsonValue& v, Draft& d) { rain(d).rain.wind.velocity = v.three(); }},
       {"gust",
        {a_number(between(0, 100))},
        "0",
        "Standard deviation of the wind's speed, m/s",
        [](const JsonValue& v, Draft& d) { rain(d).rain.wind.gust = v.real(); }},
       {"gust_period",
        {a_number(between(0.01, 10000))},
        "4",
        "Of the slowest gusts, s",
        [](const JsonValue& v, Draft& d) { rain(d).rain.wind.gust_period = v.real(); }},
       {"wind_field",
        {{Kind::file}},
        "(none)",
        "A particle file whose velocities are the wind at its points, m/s, instead of `wind`",
        [](const JsonValue& v, Draft& d) { rain(d).rain.wind.field = wind_field_of(d.resolved(v.text())); }},
       {"seed",
        {an_integer(0, 1e9)},
        "1",
        "Of drops, gusts and splashes",
        [](const JsonValue& v, Draft& d) { rain(d).rain.seed = static_cast<std::uint64_t>(v.integer()); }},
       {"start",
        {a_number(between(-1000, 86400))},
        "0",
        "When it begins, s of the film; what has `rained_mm` has rained for some time before",
        [](const JsonValue& v, Draft& d) { rain(d).rain.start = v.number(); }},
       {"duration",
        {a_number(between(0, 1e9))},
        "(without end)",
        "s",
        [](const JsonValue& v, Draft& d) { rain(d).rain.duration = v.number(); }},
       {"rained_mm",
        {a_number(between(0, 10000))},
        "0",
        "Water that has fallen and found its places before the film begins, mm",
        [](const JsonValue& v, Draft& d) { rain(d).rained_mm = v.real(); }},
       {"smallest_mm",
        {a_number(between(0.1, 10))},
        "0.5",
        "Diameter of the smallest drops that are made one by one; the water of smaller ones comes with those",
        [](const JsonValue& v, Draft& d) { rain(d).rain.smallest_mm = v.real(); }},
       {"largest_mm",
        {a_number(between(0.1, 10))},
        "6",
        "Diameter of the largest",
        [](const JsonValue& v, Draft& d) { rain(d).rain.largest_mm = v.real(); }},
       {"share",
        {a_number({0, 1, true})},
        "(as much as there can be)",
        "Part of the drops that is made; each brings the water of those that are not",
        [](const JsonValue& v, Draft& d) { rain(d).rain.share = v.real(); }},
       {"most_per_second",
        {a_number(between(1, 1e8))},
        "200000",
        "Drops that are made a second at most, where `share` does not say",
        [](const JsonValue& v, Draft& d) { rain(d).rain.most_per_second = v.number(); }},
       {"whole_within",
        {a_number(between(0, 1000))},
        "4",
        "m from the eye, horizontally, within which all drops are made; farther away fewer, the large ones first, each "
        "bringing the water of those that are not. Less where `most_per_second` is reached. 0, or where `share` says: "
        "the same share everywhere",
        [](const JsonValue& v, Draft& d) { rain(d).rain.whole_within = v.real(); }},
       {"drops", {objects(rain_drop_section())}, "[]", "Single drops beside the rain", nullptr},
       {"top",
        {a_number(between(0.1, 1000))},
        "8",
        "Height above the ground from which drops are followed, m; more where bodies or the eye are higher",
        [](const JsonValue& v, Draft& d) { rain(d).rain.top = v.real(); }},
       {"region",
        {a_rectangle()},
        "(over water, bodies, ground and camera)",
        "Where it rains: two opposite corners along the horizontal axes in the order x, y, z, m",
        [](const JsonValue& v, Draft& d) { store_rectangle(v, rain(d).rain.low, rain(d).rain.high); }},
       {"shutter",
        {a_number({0, 1, true})},
        "0.016666667",
        "How long it is open, s: drops are streaks as long as their way in that time",
        [](const JsonValue& v, Draft& d) { rain(d).shutter = v.real(); }},
       {"streak_reach",
        {a_number(between(0.1, 1000))},
        "12",
        "Distance from the eye up to which drops are drawn one by one, m; beyond they are haze",
        [](const JsonValue& v, Draft& d) { rain(d).streak_reach = v.real(); }},
       {"streak_strength",
        {a_number(between(0, 100))},
        "1",
        "Factor of the opacity of streaks",
        [](const JsonValue& v, Draft& d) { rain(d).look.streak_strength = v.real(); }},
       {"shown",
        {a_name({"all", "splashes", "streaks", "neither"})},
        "\"all\"",
        "What of it is drawn",
        [](const JsonValue& v, Draft& d) { rain(d).shown = rain_shown_of(v.text()); }},
       {"ripples",
        {a_boolean()},
        "true",
        "Hits make rings on puddles and water",
        [](const JsonValue& v, Draft& d) { rain(d).with_ripples = v.boolean(); }},
       {"ripple_step",
        {a_number(between(0.001, 10))},
        "0.01",
        "Between the points that waves are known at, m",
        [](const JsonValue& v, Draft& d) { rain(d).ripples.step = v.real(); }},
       {"ripple_strength",
        {a_number(between(0, 100))},
        "1",
        "Factor of the rings' heights",
        [](const JsonValue& v, Draft& d) { rain(d).ripples.strength = v.real(); }},
       {"splash_size",
        {a_number(between(0.1, 10))},
        "1",
        "Factor of the lengths of splashes as they are drawn; their water and the ways of their droplets stay",
        [](const JsonValue& v, Draft& d) { rain(d).splashes.size = v.real(); }},
       {"secondary",
        {a_boolean()},
        "false",
        "Droplets of splashes splash themselves, once",
        [](const JsonValue& v, Draft& d) { rain(d).splashes.secondary = v.boolean(); }},
       {"bodies",
        {a_material()},
        "\"steel\"",
        "What meshes count as",
        [](const JsonValue& v, Draft& d) { rain(d).bodies = material_of(v); }},
       {"frames",
        {an_integer(1, 1e6)},
        "100",
        "Number of frames, where there is no water that has frames",
        [](const JsonValue& v, Draft& d) { rain(d).frames = static_cast<std::size_t>(v.integer()); }},
       {"fps",
        {a_number(between(0.1, 1000))},
        "25",
        "Frames a second of those, and of their film unless output.fps says otherwise",
        [](const JsonValue& v, Draft& d) { rain(d).frames_per_second = v.number(); }},
       {"ground", {an_object(rain_ground_section())}, "(none)", "Ground that gets wet", nullptr}},
      [](Draft& d) { d.scene.picture.rain.emplace(); },
      finish_rain};
  return section;
}

}  // namespace meniscus::scene_file
