/// Options on rain.
#include "commands.h"
#include "option_group.h"

namespace meniscus::apps {
namespace {

/// The scene's rain, or one that begins with the first option that is about it.
RainSettings& rain_of(PictureOptions& picture) {
  if (!picture.rain) picture.rain.emplace();
  return *picture.rain;
}

}  // namespace

void PictureArguments::add_rain(CLI::App& command) {
  OptionGroup group(command, "Rain", setters_);
  group.number<float>(
      "--rain", "MM_H",
      [](PictureOptions& p, float v) {
        if (v == 0)
          p.rain.reset();
        else
          rain_of(p).rain.rate_mm_h = in_range("--rain", v, 1e-3f, 1000.0f);
      },
      "It rains so many mm an hour: 2 is a drizzle, 50 a cloudburst; 0: not at all");
  group.text(
      "--wind", "X,Y,Z",
      [](PictureOptions& p, const std::string& text) {
        const vec3 wind = parse_vec3("--wind", text);
        for (const float along : {wind.x, wind.y, wind.z})
          static_cast<void>(in_range("--wind", along, -100.0f, 100.0f));
        rain_of(p).rain.wind.velocity = wind;
        rain_of(p).rain.wind.field.reset();
      },
      "Wind that the rain falls with, m/s (default: none)");
  group.number<float>(
      "--gust", "SPEED",
      [](PictureOptions& p, float v) { rain_of(p).rain.wind.gust = in_range("--gust", v, 0.0f, 100.0f); },
      "Standard deviation of the wind's speed, m/s (default: 0)");
  group.number<float>(
      "--rained", "MM",
      [](PictureOptions& p, float v) { rain_of(p).rained_mm = in_range("--rained", v, 0.0f, 10000.0f); },
      "Water that has fallen before the first picture, mm (default: 0)");
  group.number<long long>(
      "--rain-seed", "N",
      [](PictureOptions& p, long long v) {
        rain_of(p).rain.seed = static_cast<std::uint64_t>(in_range("--rain-seed", v, 0LL, 1000000000LL));
      },
      "Other drops of the same rain (default: 1)");
  group.number<float>(
      "--shutter", "SECONDS",
      [](PictureOptions& p, float v) { rain_of(p).shutter = in_range("--shutter", v, 1e-6f, 1.0f); },
      "Time that drops in the air are blurred over (default: 1/60)");
  group.flag(
      "--only-splashes", [](PictureOptions& p) { rain_of(p).shown = RainShown::splashes; },
      "No drops in the air are drawn");
  group.flag(
      "--only-streaks", [](PictureOptions& p) { rain_of(p).shown = RainShown::streaks; }, "No splashes are drawn");
  command.get_option("--only-splashes")->excludes("--only-streaks");
  group.flag(
      "--no-ripples", [](PictureOptions& p) { rain_of(p).with_ripples = false; }, "Drops make no rings on water");
}

}  // namespace meniscus::apps
