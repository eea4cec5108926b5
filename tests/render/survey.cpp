#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "meniscus/render.h"

namespace meniscus {
namespace {

/// A directory of small text frames, removed at the end.
class Frames {
 public:
  Frames() : directory_(::testing::TempDir() + "survey_" + std::to_string(::getpid())) {
    std::filesystem::create_directories(directory_);
  }
  ~Frames() { std::filesystem::remove_all(directory_); }
  /// A cube of 4 x 4 x 4 particles, 0.1 m apart, moved along x.
  void add_cube(int number, float x) {
    std::ofstream file(path(number));
    for (int i = 0; i < 64; ++i)
      file << x + 0.1f * static_cast<float>(i % 4) << " " << 0.1 * (i / 4 % 4) << " " << 0.1 * (i / 16) << "\n";
  }
  void add_text(int number, const std::string& text) { std::ofstream(path(number)) << text; }
  std::string path(int number) const { return directory_ + "/f_" + std::to_string(number) + ".xyz"; }
  const std::string& directory() const { return directory_; }
  FrameSequence found() const { return find_frames(std::vector<std::string>{directory_}); }

 private:
  std::string directory_;
};

TEST(Survey, HoldsTheWaterOfTheWholeSequence) {
  Frames frames;
  frames.add_cube(1, 0);
  frames.add_cube(2, 5);
  const Survey survey = survey_frames(frames.found());
  EXPECT_EQ(survey.frames, 2u);
  EXPECT_EQ(survey.most_particles, 64u);
  EXPECT_NEAR(survey.bounds.low.x, 0, 0.11f);
  EXPECT_NEAR(survey.bounds.high.x, 5.3f, 0.11f);
}

TEST(Survey, ReadsAPartOfALongSequenceWithBothEnds) {
  Frames frames;
  for (int i = 0; i < 9; ++i) frames.add_cube(i, static_cast<float>(i));
  SurveyOptions options;
  options.most_frames = 3;
  const Survey survey = survey_frames(frames.found(), options);
  EXPECT_EQ(survey.frames_read, 3u);
  EXPECT_EQ(survey.notes.size(), 1u);
  EXPECT_NEAR(survey.bounds.high.x, 8.3f, 0.11f);
}

TEST(Survey, NotesWhatCannotBeReadUnlessItIsStrict) {
  Frames frames;
  frames.add_cube(1, 0);
  frames.add_text(2, "0 0 0\nwhat is this\n");
  frames.add_cube(3, 0);
  const Survey survey = survey_frames(frames.found());
  ASSERT_EQ(survey.unreadable.size(), 1u);
  EXPECT_NE(survey.unreadable[0].find(frames.path(2)), std::string::npos);
  SurveyOptions strict;
  strict.strict = true;
  EXPECT_THROW(survey_frames(frames.found(), strict), Error);
}

TEST(Survey, TakesWhatItIsTold) {
  Frames frames;
  frames.add_cube(1, 0);
  SurveyOptions options;
  options.spacing = 0.07f;
  options.up = Axis::x;
  const Survey survey = survey_frames(frames.found(), options);
  EXPECT_EQ(survey.spacing.spacing, 0.07f);
  EXPECT_EQ(survey.up.axis, Axis::x);
}

TEST(Guesses, EachNamesTheOptionThatOverridesIt) {
  Frames frames;
  frames.add_cube(1, 0);
  for (const Guess& guess : guesses_of(survey_frames(frames.found()), {})) {
    EXPECT_EQ(guess.option.substr(0, 2), "--") << guess.what;
    EXPECT_FALSE(guess.value.empty()) << guess.what;
    EXPECT_FALSE(guess.reasoning.empty()) << guess.what;
  }
}

TEST(Settings, TheGroundHidesTheRoundedLowerEdgeOfTheWater) {
  Frames frames;
  frames.add_cube(1, 0);
  SurveyOptions options;
  options.up = Axis::z;
  options.spacing = 0.1f;
  const FrameSettings settings = settings_of(survey_frames(frames.found(), options), {});
  EXPECT_EQ(settings.ground.up, vec3(0, 0, 1));
  EXPECT_NEAR(settings.ground.height, 0.025f, 0.02f);  // a quarter of a spacing above the lowest particles
}

TEST(Settings, ATintIsWhatLightHasAfterTheDepthOfTheScene) {
  Survey survey;
  survey.bounds = {vec3{0}, vec3{2, 3, 4}};
  survey.spacing.spacing = 0.01f;
  PictureOptions options;
  options.tint = vec3{0.5f, 0.25f, 1};
  const vec3 extinction = settings_of(survey, options).material.extinction;
  EXPECT_NEAR(std::exp(-2 * extinction.x), 0.5f, 1e-5f);
  EXPECT_NEAR(std::exp(-2 * extinction.y), 0.25f, 1e-5f);
  EXPECT_NEAR(extinction.z, 0, 1e-6f);
}

TEST(RenderFiles, DrawsADirectoryInOneCall) {
  Frames frames;
  frames.add_cube(1, 0);
  frames.add_cube(2, 0.2f);
  PictureOptions picture;
  picture.width = 64;
  picture.height = 48;
  const std::string output = frames.directory() + "/out/{:03}.png";
  const SequenceReport report = render_files(std::vector<std::string>{frames.directory()}, output, picture);
  EXPECT_EQ(report.drawn, 2u);
  EXPECT_EQ(read_png(frames.directory() + "/out/001.png").width(), 64);
  EXPECT_EQ(read_png(frames.directory() + "/out/002.png").height(), 48);
}

}  // namespace
}  // namespace meniscus
