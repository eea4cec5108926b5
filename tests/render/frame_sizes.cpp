// Sizes of particles from the attributes of their files.
#include <gtest/gtest.h>

#include "meniscus/render.h"
#include "render/frame_sizes.h"

namespace meniscus {
namespace {

/// A pool whose right half is of particles three times as large, with their radii.
Particles two_resolutions() {
  Particles particles;
  Attribute radius{"pscale", 1, {}}, velocity{"velocity", 3, {}};
  const auto fill = [&](float low, float high, float s) {
    for (float z = s / 2; z < 0.6f; z += s)
      for (float y = s / 2; y < 0.3f; y += s)
        for (float x = low + s / 2; x < high; x += s) {
          particles.x.push_back(x);
          particles.y.push_back(y);
          particles.z.push_back(z);
          radius.values.push_back(s / 2);
        }
  };
  fill(0, 0.6f, 0.04f);
  fill(0.6f, 1.2f, 0.12f);
  velocity.values.resize(3 * particles.size());
  particles.attributes = {radius, velocity};
  return particles;
}

std::string error_of(const Particles& particles, const SizesBy& by) {
  try {
    static_cast<void>(frame_sizes(particles, by));
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(FrameSizes, AreTwiceTheRadiiAndTheSmoothingLengths) {
  Particles particles = two_resolutions();
  particles.attributes.push_back({"h", 1, std::vector<float>(particles.size(), 0.25f)});
  const FrameSizes sizes = frame_sizes(particles, {"pscale", "h"});
  ASSERT_EQ(sizes.spacing.size(), particles.size());
  EXPECT_EQ(sizes.spacing.front(), 0.04f);
  EXPECT_EQ(sizes.spacing.back(), 0.12f);
  EXPECT_EQ(sizes.smoothing_length[7], 0.25f);
  EXPECT_TRUE(frame_sizes(particles, {}).sizes().empty());
  EXPECT_TRUE(frame_sizes(Particles{}, {"pscale", ""}).sizes().empty());
}

TEST(FrameSizes, AreRefusedWithTheAttributesThatThereAre) {
  const Particles particles = two_resolutions();
  EXPECT_NE(error_of(particles, {"radius", ""}).find("pscale"), std::string::npos);
  EXPECT_NE(error_of(particles, {"", "size"}).find("pscale"), std::string::npos);
  EXPECT_NE(error_of(particles, {"velocity", ""}).find("number"), std::string::npos);
}

TEST(FrameSizes, ThatDifferAreToldOfUnlessAskedFor) {
  Particles particles = two_resolutions();
  SurveyOptions options;
  const auto notes = survey_particles(particles, options).notes;
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("--radius-attribute pscale"), std::string::npos) << notes[0];
  options.sizes.radius = "pscale";
  EXPECT_TRUE(survey_particles(particles, options).notes.empty());
  options.sizes = {};
  particles.attributes[0].values.assign(particles.size(), 0.02f);
  EXPECT_TRUE(survey_particles(particles, options).notes.empty());
}

TEST(FrameSizes, LetLargeParticlesFillTheirWater) {
  // With one size for all the large particles are islands, or the small ones a blob.
  const Particles particles = two_resolutions();
  SurveyOptions survey_options;
  survey_options.up = Axis::y;
  const Survey survey = survey_particles(particles, survey_options);
  PictureOptions picture;
  picture.width = 120;
  picture.height = 90;
  picture.antialias = Antialias::off;
  picture.optics.refraction = RefractionMethod::thickness;
  picture.ground = GroundStyle::none;
  picture.surface.spacing = 0.04f;
  picture.camera.elevation_deg = 89;
  const auto covered = [&](const PictureOptions& options) {
    const FramePicture frame = render_frame(particles, settings_of(survey, options));
    double sum = 0;
    for (const float c : frame.buffers.coverage) sum += c;
    return sum / static_cast<double>(frame.buffers.coverage.size());
  };
  const double alike = covered(picture);
  picture.sizes.radius = "pscale";
  const double own = covered(picture);
  EXPECT_GT(own, 1.1 * alike);
  picture.method = SurfaceMethod::surfels;
  EXPECT_THROW(covered(picture), Error);
}

}  // namespace
}  // namespace meniscus
