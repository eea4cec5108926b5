#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "meniscus/output.h"
#include "program.h"

namespace meniscus {
namespace {

/// A metre of road before the camera after long rain: a puddle, streaks over it, splashes.
constexpr const char* kRoad = R"({
  "rain": {
    "rate_mm_h": 100, "rained_mm": 12, "ripple_step": 0.02, "frames": 8, "fps": 25,
    "ground": {"region": [[-1, -1], [1, 1]], "cell": 0.05, "ruts": 0.02}
  },
  "camera": {"eye": [0, 0.5, 1.2], "target": [0, 0.2, 0]},
  "picture": {"size": [96, 64], "antialias": "off"}
}
)";

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// The picture of one frame, or an empty one and a failure.
Image<Rgb8> drawn(const Folder& folder, const std::string& what, const std::vector<std::string>& options) {
  const std::string out = folder / "out.png";
  const Outcome run = run_program(with({"render", what, "-o", out, "--quiet"}, options));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return run.exit_code == 0 ? read_png(out) : Image<Rgb8>();
}

bool equal(Rgb8 a, Rgb8 b) { return a.r == b.r && a.g == b.g && a.b == b.b; }

/// Part of the pixels that differ.
double difference(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  if (a.size() != b.size() || a.empty()) return 1;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += !equal(a[i], b[i]);
  return static_cast<double>(count) / static_cast<double>(a.size());
}

TEST(RainOptions, LeaveOutStreaksOrSplashesOrRings) {
  const Folder folder;
  folder.write("road.json", kRoad);
  const auto frame = [&](const std::vector<std::string>& options) {
    return drawn(folder, folder / "road.json", with({"--frames", "7:8"}, options));
  };
  const Image<Rgb8> all = frame({}), splashes = frame({"--only-splashes"}), streaks = frame({"--only-streaks"}),
                    smooth = frame({"--no-ripples"});
  EXPECT_GT(difference(all, splashes), 0.01) << "streaks are gone";
  EXPECT_GT(difference(all, streaks), 0.001) << "splashes are gone";
  EXPECT_GT(difference(splashes, streaks), 0.01);
  EXPECT_GT(difference(all, smooth), 0.005) << "rings are gone";
  EXPECT_EQ(difference(all, frame({"--threads", "1"})), 0);

  // Splashes are near the ground: over the horizon nothing is missing without them.
  std::size_t above = 0;
  for (int y = 0; y < all.height() / 8; ++y)
    for (int x = 0; x < all.width(); ++x) above += !equal(all(x, y), streaks(x, y));
  EXPECT_EQ(above, 0u);
}

TEST(RainOptions, LetItRainOnFramesThatKnowOfNoRain) {
  const Folder folder;
  folder.write_block("block.xyz", 8);
  const std::vector<std::string> small = {"--size", "64x48"};
  const Image<Rgb8> fair = drawn(folder, folder / "block.xyz", small);
  EXPECT_GT(difference(fair, drawn(folder, folder / "block.xyz", with(small, {"--rain", "50"}))), 0.3)
      << "the sky is overcast";
  EXPECT_EQ(difference(fair, drawn(folder, folder / "block.xyz", with(small, {"--rain", "0"}))), 0);
}

TEST(RainOptions, TakeTheRainOutOfAScene) {
  const Folder folder;
  folder.write_block("block.xyz", 8);
  const std::string water = "{\"water\": {\"frames\": \"block.xyz\"}";
  folder.write("fair.json", water + "}");
  folder.write("rainy.json", water + ", \"rain\": {\"rate_mm_h\": 100}}");
  const Image<Rgb8> fair = drawn(folder, folder / "fair.json", {"--size", "64x48"});
  EXPECT_GT(difference(fair, drawn(folder, folder / "rainy.json", {"--size", "64x48"})), 0.3);
  EXPECT_EQ(difference(fair, drawn(folder, folder / "rainy.json", {"--size", "64x48", "--rain", "0"})), 0);
}

TEST(RainOptions, OfAnotherSeedGiveOtherDrops) {
  const Folder folder;
  folder.write("road.json", kRoad);
  const Image<Rgb8> one = drawn(folder, folder / "road.json", {"--frames", "2:3", "--rain-seed", "1"});
  EXPECT_EQ(difference(one, drawn(folder, folder / "road.json", {"--frames", "2:3"})), 0) << "1 is the default";
  EXPECT_GT(difference(one, drawn(folder, folder / "road.json", {"--frames", "2:3", "--rain-seed", "2"})), 0.01);
}

TEST(RainOptions, OutOfTheirRangesAreWrongUsage) {
  const Folder folder;
  folder.write_block("block.xyz", 2);
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--rain", "-1"}, "--rain"},      {{"--rain", "much"}, "--rain"},      {{"--rain", "1e9"}, "--rain"},
      {{"--rain", "nan"}, "--rain"},     {{"--wind", "1,2"}, "--wind"},       {{"--gust", "-2"}, "--gust"},
      {{"--shutter", "0"}, "--shutter"}, {{"--rained", "-1"}, "--rained"},    {{"--rain-seed", "x"}, "--rain-seed"},
      {{"--clouds", "2"}, "--clouds"},   {{"--only-splash"}, "--only-splash"}};
  for (const auto& [options, part] : cases) {
    const Outcome run = run_program(with({"render", folder / "block.xyz", "-o", folder / "out.png"}, options));
    EXPECT_EQ(run.exit_code, 2) << part;
    EXPECT_EQ(run.err.rfind("meniscus: error: ", 0), 0u) << run.err;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  }
  EXPECT_FALSE(folder.has("out.png"));
}

TEST(RainOptions, AreAGroupOfTheHelp) {
  const std::string help = run_program({"render", "--help"}).out;
  for (const char* part :
       {"\nRain:", "--rain MM_H", "--wind X,Y,Z", "--only-splashes", "--only-streaks", "--no-ripples"})
    EXPECT_NE(help.find(part), std::string::npos) << part;
}

TEST(RainSection, NamesLineAndFieldOfAMistake) {
  const Folder folder;
  const auto error_of = [&](const std::string& line) {
    folder.write("scene.json",
                 "{\n  \"rain\": {\n    \"ground\": {\"region\": [[0, 0], [1, 1]]},\n    " + line + "\n  }\n}\n");
    const Outcome run = run_program({"render", folder / "scene.json", "-o", folder / "out.png"});
    EXPECT_EQ(run.exit_code, 1) << line;
    EXPECT_NE(run.err.find("scene.json:4"), std::string::npos) << run.err;
    return run.err;
  };
  EXPECT_NE(error_of("\"rate_mmh\": 5").find("rate_mm_h"), std::string::npos);
  EXPECT_NE(error_of("\"wind\": [0, 1]").find("rain.wind"), std::string::npos);
  EXPECT_NE(error_of("\"rained_mm\": -3").find("rain.rained_mm"), std::string::npos);
  EXPECT_NE(error_of("\"shown\": \"splash\"").find("rain.shown"), std::string::npos);
  EXPECT_NE(error_of("\"wind_field\": \"missing.ply\"").find("rain.wind_field"), std::string::npos);
  EXPECT_FALSE(folder.has("out.png"));
}

TEST(RainSection, NamesThePictureOfTheGroundThatIsMissing) {
  const Folder folder;
  folder.write("scene.json", R"({"rain": {"ground": {"region": [[0, 0], [1, 1]], "heights": "missing.png"}}})");
  const Outcome run = run_program({"render", folder / "scene.json", "-o", folder / "out.png"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("missing.png"), std::string::npos) << run.err;
}

TEST(StreetExample, IsDrawn) {
  const Folder folder;
  const std::string street = std::string(MENISCUS_SOURCE_DIR) + "/examples/street.json";
  const Image<Rgb8> picture = drawn(folder, street, {"--frames", "1:2", "--size", "64x36"});
  ASSERT_EQ(picture.width(), 64);
  // Sky above, ground below, neither black nor burnt out.
  const auto mean = [&](int from, int until) {
    double sum = 0;
    for (int y = from; y < until; ++y)
      for (int x = 0; x < 64; ++x) sum += picture(x, y).g;
    return sum / (64 * (until - from));
  };
  EXPECT_GT(mean(0, 9), mean(27, 36));
  EXPECT_GT(mean(27, 36), 20);
  EXPECT_LT(mean(0, 9), 250);
}

TEST(BenchSplash, HasTheColumnsOfThePublishedTable) {
  const Outcome run =
      run_program({"bench", "splash", "--json", "--counts", "10,40", "--scenes", "1", "--size", "64x48"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["rows"].size(), 2u);
  EXPECT_EQ(json["rows"][1]["splashes"], 40);
  for (const auto& row : json["rows"])
    for (const char* key : {"wet_fps", "puddle_3mm_fps", "puddle_5mm_fps", "crown_cone_fps"})
      EXPECT_GT(row[key].get<double>(), 0) << key;
  ASSERT_EQ(json["paper"].size(), 4u);
  EXPECT_NEAR(json["paper"][3]["puddle_5mm_fps"].get<double>(), 9.05, 1e-6);
  EXPECT_EQ(run_program({"bench", "splash", "--counts", "0"}).exit_code, 2);
  EXPECT_EQ(run_program({"bench", "splash", "--counts", "ten"}).exit_code, 2);
}

TEST(BenchGround, GivesWhatEachStateOfACellMakes) {
  const Outcome run = run_program({"bench", "ground", "--json", "--splashes", "500"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto rows = nlohmann::json::parse(run.out)["rows"];
  ASSERT_EQ(rows.size(), 15u);
  for (const auto& row : rows) {
    const std::string splash = row["splash"];
    EXPECT_EQ(row.contains("number"), splash == "scattering" || splash == "crown_cone") << row;
    if (row["material"] == "asphalt" && row["wetness"] == "puddle_3mm") {
      EXPECT_EQ(splash, "scattering");
      EXPECT_GE(row["number"]["min"], 4);
      EXPECT_LE(row["number"]["max"], 14);
      EXPECT_GE(row["angle_deg"]["min"].get<double>(), 1 - 1e-3);
      EXPECT_LE(row["angle_deg"]["max"].get<double>(), 60 + 1e-3);
    }
  }
  EXPECT_EQ(run_program({"bench", "ground", "--splashes", "0"}).exit_code, 2);
}

}  // namespace
}  // namespace meniscus
