/// The scenes of examples/rain/, drawn small: they show what the figures that they are after show.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "meniscus/output.h"
#include "program.h"

namespace meniscus {
namespace {

/// One frame without streaks and rings, so that two frames differ by splashes alone.
Image<Rgb8> frame_of(const std::string& scene, int frame, std::vector<std::string> options) {
  const Folder folder;
  std::vector<std::string> arguments = {"render",
                                        std::string(MENISCUS_SOURCE_DIR) + "/examples/rain/" + scene + ".json",
                                        "-o",
                                        folder / "out.png",
                                        "--quiet",
                                        "--size",
                                        "96x72",
                                        "--antialias",
                                        "off",
                                        "--only-splashes",
                                        "--no-ripples",
                                        "--frames",
                                        std::to_string(frame) + ":" + std::to_string(frame + 1)};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome run = run_program(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return run.exit_code == 0 ? read_png(folder / "out.png") : Image<Rgb8>(96, 72);
}

/// How much is changed, in steps of 8 bits summed over the pixels, and where in the mean, px.
struct Change {
  double sum = 0, x = 0, y = 0;
};
Change change(const Image<Rgb8>& a, const Image<Rgb8>& b) {
  Change change;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const double d = std::abs(a(x, y).g - b(x, y).g);
      change.sum += d, change.x += d * x, change.y += d * y;
    }
  if (change.sum > 0) change.x /= change.sum, change.y /= change.sum;
  return change;
}

TEST(RainFigure6, SplashesLeanAndFlyWithTheWind) {
  const auto splash = [](const std::string& wind) {
    const std::vector<std::string> blown = {"--wind", wind + ",0,0"};
    return change(frame_of("fig6", 0, blown), frame_of("fig6", 26, blown));
  };
  const Change still = splash("0"), storm = splash("8");
  EXPECT_GT(still.sum, 1000);
  EXPECT_NEAR(still.x, 47.5, 3);
  EXPECT_GT(storm.x, still.x + 5);
}

TEST(RainFigure8, SplashesGrowWithTheDepthOfWater) {
  const auto splashes = [](const std::string& rained) {
    return change(frame_of("fig8", 0, {"--rained", rained}), frame_of("fig8", 40, {"--rained", rained})).sum;
  };
  const double wet = splashes("1"), deep = splashes("5.9");
  EXPECT_GT(wet, 200);
  EXPECT_GT(deep, 2 * wet);
}

TEST(RainFigure9, SplashesRiseAndAreGoneAgain) {
  const Image<Rgb8> still = frame_of("fig9", 0, {}), still_deep = frame_of("fig9", 0, {"--rained", "11"});
  const Change early = change(still, frame_of("fig9", 14, {})), later = change(still, frame_of("fig9", 30, {})),
               end = change(still, frame_of("fig9", 199, {}));
  EXPECT_GT(early.sum, 1000);
  EXPECT_LT(later.y, early.y - 2) << "it has risen";
  EXPECT_LT(end.sum, 0.05 * early.sum);

  // The cone stands in the middle, where the drop fell.
  const Change cone = change(still_deep, frame_of("fig9", 90, {"--rained", "11"}));
  EXPECT_GT(cone.sum, 500);
  EXPECT_NEAR(cone.x, 47.5, 3);
}

}  // namespace
}  // namespace meniscus
