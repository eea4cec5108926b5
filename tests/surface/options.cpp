// Options out of their range are refused by name.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

struct Wrong {
  const char* named;  ///< what the message has to say
  std::function<void(RaycastOptions&)> set;
};

TEST(Options, OutOfRangeAreRefusedByName) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Wrong> wrongs{
      {"particle spacing", [](RaycastOptions& o) { o.spacing = 0; }},
      {"particle spacing", [](RaycastOptions& o) { o.spacing = -1; }},
      {"particle spacing", [](RaycastOptions& o) { o.spacing = kInfinity; }},
      {"particle spacing", [&](RaycastOptions& o) { o.spacing = nan; }},
      {"smoothing length", [](RaycastOptions& o) { o.smoothing_length = 0.9f * kSpacing; }},
      {"smoothing length", [](RaycastOptions& o) { o.smoothing_length = -kSpacing; }},
      {"smoothing length", [](RaycastOptions& o) { o.smoothing_length = 21 * kSpacing; }},
      {"smoothing length", [&](RaycastOptions& o) { o.smoothing_length = nan; }},
      {"normal radius", [](RaycastOptions& o) { o.normal_radius = 0.5f * kSpacing; }},
      {"normal radius", [](RaycastOptions& o) { o.normal_radius = 100 * kSpacing; }},
      {"iso-value", [](RaycastOptions& o) { o.iso = 0; }},
      {"iso-value", [](RaycastOptions& o) { o.iso = 1; }},
      {"iso-value", [&](RaycastOptions& o) { o.iso = nan; }},
      {"step", [](RaycastOptions& o) { o.step = 0; }},
      {"step", [](RaycastOptions& o) { o.step = 1.1f; }},
      {"step", [&](RaycastOptions& o) { o.step = nan; }},
      {"refinement steps", [](RaycastOptions& o) { o.refinement_steps = -1; }},
      {"refinement steps", [](RaycastOptions& o) { o.refinement_steps = 33; }},
      {"blend sharpness", [](RaycastOptions& o) { o.blend_sharpness = -1; }},
      {"blend sharpness", [&](RaycastOptions& o) { o.blend_sharpness = nan; }},
      {"blend agreement", [](RaycastOptions& o) { o.blend_agreement = 1.5f; }},
      {"filter radius", [](RaycastOptions& o) { o.filter_radius = -1; }},
      {"filter radius", [](RaycastOptions& o) { o.filter_radius = 33; }},
  };
  const Particles particles = lattice_ball(2);
  for (const Wrong& wrong : wrongs)
    for (const bool fast : {true, false}) {
      RaycastOptions with = options();
      wrong.set(with);
      try {
        if (fast)
          make_raycast_surface(particles, with);
        else
          make_plain_raycast_surface(particles, with);
        ADD_FAILURE() << wrong.named << " was accepted";
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find(wrong.named), std::string::npos) << error.what();
        EXPECT_FALSE(error.detail().expected.empty());
      }
    }
}

TEST(Options, AtTheEndsOfTheirRangesWork) {
  const Particles particles = lattice_ball(3);
  const View view = looking_at(particles.bounds(), {1, 1, 0}, Projection::perspective, 33, 33);
  const std::vector<std::function<void(RaycastOptions&)>> settings{
      [](RaycastOptions& o) { o.smoothing_length = kSpacing; },
      [](RaycastOptions& o) { o.smoothing_length = 20 * kSpacing; },
      [](RaycastOptions& o) { o.normal_radius = kSpacing; },
      [](RaycastOptions& o) { o.normal_radius = 20 * kSpacing; },
      [](RaycastOptions& o) { o.iso = 0.001f; },
      [](RaycastOptions& o) { o.iso = 0.999f; },
      [](RaycastOptions& o) { o.step = 0.01f; },
      [](RaycastOptions& o) { o.step = 1; },
      [](RaycastOptions& o) { o.refinement_steps = 0; },
      [](RaycastOptions& o) { o.refinement_steps = 32; },
      [](RaycastOptions& o) { o.blend_sharpness = 0; },
      [](RaycastOptions& o) { o.blend_sharpness = 1e6f; },
      [](RaycastOptions& o) { o.blend_agreement = 0; },
      [](RaycastOptions& o) { o.filter_radius = 32; }};
  for (const auto& set : settings) {
    RaycastOptions with = options();
    set(with);
    expect_consistent(make_raycast_surface(particles, with)->see(view));
  }
}

TEST(Options, NamesAreThoseOfTheCommandLine) {
  EXPECT_EQ(kernel_of("cubic_spline"), Kernel::cubic_spline);
  EXPECT_EQ(kernel_of("poly6"), Kernel::poly6);
  EXPECT_EQ(kernel_of("wyvill"), Kernel::wyvill);
  EXPECT_EQ(normal_method_of("gradient"), NormalMethod::gradient);
  EXPECT_EQ(normal_method_of("pca"), NormalMethod::pca);
  EXPECT_EQ(normal_method_of("blend"), NormalMethod::blend);
  EXPECT_EQ(refinement_of("secant"), Refinement::secant);
  EXPECT_EQ(refinement_of("bisection"), Refinement::bisection);
  for (const auto& ask :
       {std::function<void()>([] { kernel_of("gauss"); }), std::function<void()>([] { normal_method_of("gauss"); }),
        std::function<void()>([] { refinement_of("gauss"); })}) {
    try {
      ask();
      ADD_FAILURE() << "was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
      EXPECT_NE(std::string(error.what()).find("gauss"), std::string::npos);
      EXPECT_NE(error.detail().expected.find(", "), std::string::npos);  // the known ones
    }
  }
}

}  // namespace
}  // namespace meniscus
