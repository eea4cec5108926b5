// Pictures of three frames of the shipped sequence as they were when somebody last looked at them.
//
// A change of the picture that is wanted: run with MENISCUS_UPDATE_GOLDEN=1 in the environment, look at
// tests/render/golden/*.png, and commit them. A failure leaves the new picture beside the build.
#include <gtest/gtest.h>

#include <cstdlib>
#include <ostream>

#include "meniscus/render.h"

namespace meniscus {
namespace {

const std::string kSource = MENISCUS_SOURCE_DIR;

struct GoldenFrame {
  std::string frame, picture;
  std::string material;
  bool coloured;
};

void PrintTo(const GoldenFrame& golden, std::ostream* out) { *out << golden.picture; }

class GoldenPicture : public testing::TestWithParam<GoldenFrame> {};

TEST_P(GoldenPicture, IsAsItWasSeen) {
  const GoldenFrame& golden = GetParam();
  const Particles particles = read_particles(kSource + "/data/dam_break_3d/" + golden.frame);
  PictureOptions options;
  options.width = 400;
  options.height = 225;
  options.material = golden.material;
  if (golden.coloured) {
    options.colour = ColourBy{"velocity", Colormap::viridis, std::pair{0.0f, 4.0f}};
    options.legend = true;
  }
  const Image<Rgb8> drawn = render_frame(particles, settings_of(survey_particles(particles), options)).picture;
  const std::string path = kSource + "/tests/render/golden/" + golden.picture;
  if (std::getenv("MENISCUS_UPDATE_GOLDEN")) {
    write_png(path, drawn);
    GTEST_SKIP() << "wrote " << path;
  }
  const ImageDifference difference = compare(drawn, read_png(path));
  if (difference.psnr_db < 45) write_png(std::string(MENISCUS_BINARY_DIR) + "/failed_" + golden.picture, drawn);
  EXPECT_GE(difference.psnr_db, 45) << "the new picture is " << MENISCUS_BINARY_DIR << "/failed_" << golden.picture;
}

INSTANTIATE_TEST_SUITE_P(DamBreak, GoldenPicture,
                         testing::Values(GoldenFrame{"dam_break_3d_01080.hdf5", "column.png", "water", false},
                                         GoldenFrame{"dam_break_3d_02790.hdf5", "obstacle_coloured.png", "plastic",
                                                     true},
                                         GoldenFrame{"dam_break_3d_04320.hdf5", "splash.png", "water", false}),
                         [](const auto& info) { return info.param.picture.substr(0, info.param.picture.find('.')); });

// What the comparison is worth: faults of the kind that optics have are far below its limit.
TEST(GoldenPictures, TellWaterWithAnotherAbsorptionApart) {
  const Particles particles = read_particles(kSource + "/data/dam_break_3d/dam_break_3d_04320.hdf5");
  PictureOptions options;
  options.width = 400;
  options.height = 225;
  FrameSettings settings = settings_of(survey_particles(particles), options);
  const Image<Rgb8> right = render_frame(particles, settings).picture;
  settings.material.extinction *= 1.3f;
  EXPECT_LT(compare(right, render_frame(particles, settings).picture).psnr_db, 45);
}

}  // namespace
}  // namespace meniscus
