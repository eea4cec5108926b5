#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "rain.h"

namespace meniscus {
namespace {

/// A wet square with a puddle, a post, and a camera at its edge.
PictureOptions wet_square() {
  PictureOptions options;
  options.width = 160;
  options.height = 90;
  options.camera.eye = vec3(0, 1.2f, 2.4f);
  options.camera.target = vec3(0, 0.1f, 0);
  options.rain = rain_on_square(1.2f, 60);
  options.rain->rained_mm = 12;
  options.rain->ground.rut_depth = 0.03f;
  options.rain->rain.share = 0.3f;
  options.rain->ripples.step = 0.02f;
  BodyOptions post;
  post.shape = "box";
  post.world_from_body = glm::scale(glm::translate(glm::mat4(1.0f), {0.3f, 0.3f, -0.5f}), vec3(0.1f, 0.8f, 0.1f));
  options.bodies = {post};
  return options;
}

FramePicture drawn(const PictureOptions& options, double time, double frames_per_second = 0) {
  Survey survey = survey_frames(rain_sequence(*options.rain, Axis::y));
  FrameSettings settings = settings_of(survey, options);
  std::vector<std::string> notes;
  settings.solids = Bodies(options.bodies).at(0, 0, notes);
  if (frames_per_second > 0)
    for (int frame = 0; frame < static_cast<int>(time * frames_per_second); ++frame) {
      settings.time = frame / frames_per_second;
      render_frame({}, settings);
    }
  settings.time = time;
  return render_frame({}, settings);
}

bool same(const FramePicture& a, const FramePicture& b) {
  return std::equal(a.radiance.begin(), a.radiance.end(), b.radiance.begin(), b.radiance.end());
}

TEST(RainyFrame, HasTheSameBitsWithOneTwoAndFiveThreads) {
  std::vector<FramePicture> pictures;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    pictures.push_back(drawn(wet_square(), 0.3));
  }
  EXPECT_TRUE(same(pictures[0], pictures[1]));
  EXPECT_TRUE(same(pictures[0], pictures[2]));
}

TEST(RainyFrame, IsTheSameAtTheSameTimeInFilmsOfOtherRates) {
  const FramePicture at_once = drawn(wet_square(), 0.4);
  EXPECT_TRUE(same(at_once, drawn(wet_square(), 0.4, 10)));
  EXPECT_FALSE(same(at_once, drawn(wet_square(), 0.36)));
}

TEST(RainyFrame, IsFiniteAndShowsPuddles) {
  for (const Antialias antialias : {Antialias::off, Antialias::edges, Antialias::full}) {
    PictureOptions options = wet_square();
    options.antialias = antialias;
    const FramePicture frame = drawn(options, 0.3);
    EXPECT_TRUE(std::all_of(frame.radiance.begin(), frame.radiance.end(),
                            [](vec3 c) { return std::isfinite(c.x + c.y + c.z) && c.x >= 0; }));
    EXPECT_GT(
        std::count_if(frame.buffers.coverage.begin(), frame.buffers.coverage.end(), [](float c) { return c > 0; }),
        100);
  }
}

double difference(const FramePicture& a, const FramePicture& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.radiance.size(); ++i) sum += std::abs(a.radiance[i].y - b.radiance[i].y);
  return sum;
}

TEST(RainyFrame, HasNoSeamAtAShore) {
  PictureOptions options;
  options.width = 80;
  options.height = 240;
  options.antialias = Antialias::off;
  options.camera.eye = vec3(0, 0.8f, 2.6f);
  options.camera.target = vec3(0, 0, 0.2f);
  options.rain = rain_on_square(1.2f, 60);
  options.rain->rained_mm = 14;
  options.rain->shown = RainShown::neither;
  options.rain->with_ripples = false;
  GroundOptions& cells = options.rain->ground.cells;
  cells.heights = Image<float>(48, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x)
      cells.heights(x, y) = 0.03f * std::min(glm::length((vec2(x, y) - 23.5f) / 24.0f), 1.0f);
  const FramePicture picture = drawn(options, 0);
  // Up the middle, over the near shore: means of a few columns, from row to row.
  const auto bright = [&](int y) {
    float sum = 0;
    for (int x = 30; x < 50; ++x) sum += picture.radiance(x, y).y;
    return sum / 20;
  };
  float most = 0, lowest = 1e9f, highest = 0;
  for (int y = 110; y < 235; ++y) {
    most = std::max(most, std::abs(bright(y) / bright(y - 1) - 1));
    lowest = std::min(lowest, bright(y));
    highest = std::max(highest, bright(y));
  }
  EXPECT_LT(most, 0.1f) << "grain alone";
  EXPECT_GT(highest, 1.3f * lowest) << "from water to ground";
}

TEST(RainyFrame, DrawsOnlyWhatIsAskedFor) {
  PictureOptions options = wet_square();
  const auto with = [&](RainShown shown) {
    options.rain->shown = shown;
    return drawn(options, 0.3);
  };
  const FramePicture neither = with(RainShown::neither), all = with(RainShown::all),
                     splashes = with(RainShown::splashes), streaks = with(RainShown::streaks);
  EXPECT_GT(difference(splashes, neither), 0);
  EXPECT_GT(difference(streaks, neither), 0);
  EXPECT_GT(difference(all, splashes), 0);
  EXPECT_GT(difference(all, streaks), 0);
}

TEST(RainyFrame, LeavesTheParticlesOfATankAlone) {
  const Particles tank = synthetic_tank(3000);
  PictureOptions options;
  options.width = 160;
  options.height = 96;
  const Survey survey = survey_particles(tank);
  options.cloud_cover = 1;
  const FramePicture dry = render_frame(tank, settings_of(survey, options));
  options.rain.emplace();
  options.rain->rain.rate_mm_h = 100;
  options.rain->rain.most_per_second = 20000;
  FrameSettings settings = settings_of(survey, options);
  settings.time = 0.5;
  const FramePicture wet = render_frame(tank, settings);
  EXPECT_EQ(wet.particles, dry.particles);
  EXPECT_TRUE(std::equal(wet.buffers.depth.begin(), wet.buffers.depth.end(), dry.buffers.depth.begin()));
  EXPECT_FALSE(std::equal(wet.buffers.normal.begin(), wet.buffers.normal.end(), dry.buffers.normal.begin()));
  EXPECT_GT(settings.rain->hits(), 100u);
  EXPECT_GT(settings.rain->splashes(), 0u);
}

TEST(RainyFrame, ShowsNoSplashesFromUnderTheWater) {
  const Particles tank = synthetic_tank(3000);
  PictureOptions options;
  options.width = 80;
  options.height = 48;
  options.cloud_cover = 1;
  options.camera.eye = tank.bounds().centre() * vec3(1, 0.5f, 1);
  options.camera.target = *options.camera.eye + vec3(0.3f, 0.6f, 0);
  const auto shown = [&](RainShown what) {
    options.rain.emplace();
    options.rain->rain.rate_mm_h = 100;
    options.rain->rain.most_per_second = 20000;
    options.rain->shown = what;
    FrameSettings settings = settings_of(survey_particles(tank), options);
    settings.time = 0.3;
    return render_frame(tank, settings);
  };
  const FramePicture all = shown(RainShown::all);
  ASSERT_TRUE(all.buffers.eye_in_water);
  EXPECT_TRUE(same(all, shown(RainShown::neither)));
}

TEST(RainyFrame, AResumedSequenceIsTheSame) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "resumed_rain";
  std::filesystem::remove_all(folder);
  PictureOptions options = wet_square();
  options.rain->frames = 3;
  options.rain->frames_per_second = 10;
  const FrameSequence sequence = rain_sequence(*options.rain, Axis::y);
  const Survey survey = survey_frames(sequence);
  SequenceOptions whole;
  whole.output = (folder / "{}.png").string();
  whole.video.frames_per_second = 10;
  render_sequence(sequence, survey, options, whole);
  const Image<Rgb8> last = read_png((folder / "2.png").string());
  std::filesystem::remove(folder / "2.png");
  whole.resume = true;
  const SequenceReport report = render_sequence(sequence, survey, options, whole);
  EXPECT_EQ(report.skipped, 2u);
  EXPECT_EQ(report.drawn, 1u);
  const Image<Rgb8> again = read_png((folder / "2.png").string());
  EXPECT_TRUE(std::equal(last.begin(), last.end(), again.begin(), again.end()));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace meniscus
