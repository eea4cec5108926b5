// Which particles are kept, and units: the same for all formats.
#include "io/readers.h"
#include "io/where.h"
#include "small_frames.h"

namespace meniscus {
namespace {

/// Particle i at (i, 0, 0.1 i); type 0 1 2 3 3 ..., as many as there are values.
Particles typed(const std::vector<float>& types, const std::string& name = "Type") {
  Particles particles;
  for (std::size_t i = 0; i < types.size(); ++i) {
    particles.x.push_back(static_cast<float>(i));
    particles.y.push_back(0);
    particles.z.push_back(0.1f * static_cast<float>(i));
  }
  particles.attributes.push_back({name, 1, types});
  return particles;
}

Particles finished(Particles particles, const ReadOptions& options = {}) {
  io::finish(options, particles);
  return particles;
}

ReadOptions where(const std::string& condition) {
  ReadOptions options;
  options.where = condition;
  return options;
}

/// The particles that a condition keeps of ten, by their numbers. Particle i has type i % 4, density 1000 + i and
/// velocity (i, -i, 0.5 i).
std::vector<float> chosen(const std::string& condition) {
  Particles particles = typed({0, 1, 2, 3, 0, 1, 2, 3, 0, 1}, "kind of");
  Attribute density{"rho", 1, {}}, velocity{"velocity", 3, {}};
  for (int i = 0; i < 10; ++i) {
    const auto f = static_cast<float>(i);
    density.values.push_back(1000 + f);
    for (const float v : {f, -f, 0.5f * f}) velocity.values.push_back(v);
  }
  particles.attributes.push_back(density);
  particles.attributes.push_back(velocity);
  return finished(particles, where(condition)).x;
}

using Numbers = std::vector<float>;

TEST(Where, KeepsWhatFitsACondition) {
  EXPECT_EQ(chosen("'kind of'==3"), (Numbers{3, 7}));
  EXPECT_EQ(chosen("\"Kind Of\" != 0 && density<1004"), (Numbers{1, 2, 3}));
  EXPECT_EQ(chosen("density >= 1008 || RHO<=1.001e3"), (Numbers{0, 1, 8, 9}));
  EXPECT_EQ(chosen("x>7||x<3&&'kind of'>0"), (Numbers{1, 2, 8, 9})) << "&& binds tighter";
  EXPECT_EQ(chosen("velocity[1] < -8"), (Numbers{9}));
  EXPECT_EQ(chosen("vz==4.5"), (Numbers{9}));
  EXPECT_EQ(chosen("Velocity[0]==+2"), (Numbers{2}));
  EXPECT_EQ(chosen("z==0.1"), (Numbers{1})) << "0.1 is the float nearest to it";
  EXPECT_EQ(chosen("y!=0"), (Numbers{}));
}

TEST(Where, SaysWhatItLeftOut) {
  const Particles none = finished(typed({1, 2}), where("Type==3"));
  EXPECT_TRUE(none.empty());
  ASSERT_EQ(none.notes.size(), 1u);
  EXPECT_NE(none.notes[0].find("2 of 2"), std::string::npos) << none.notes[0];
}

TEST(Where, KeepsAttributesWithTheirParticles) {
  Particles particles;
  const std::size_t count = 200000;
  Attribute pair{"pair", 2, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const auto f = static_cast<float>(i);
    particles.x.push_back(i % 5 == 3 ? NAN : f);
    particles.y.push_back(f);
    particles.z.push_back(f);
    pair.values.push_back(f);
    pair.values.push_back(-f);
  }
  particles.attributes.push_back(pair);
  particles.dropped_non_finite = count / 5;  // as set_positions() counts them
  const Particles kept = finished(particles, where("pair[0]>=65000&&y!=65538"));
  std::size_t at = 0;
  for (std::size_t i = 65000; i < count; ++i) {
    if (i == 65538 || i % 5 == 3) continue;
    ASSERT_LT(at, kept.size());
    const auto f = static_cast<float>(i);
    ASSERT_EQ(kept.position(at), vec3(f, f, f));
    ASSERT_EQ(kept.attributes[0].values[2 * at], f);
    ASSERT_EQ(kept.attributes[0].values[2 * at + 1], -f);
    ++at;
  }
  EXPECT_EQ(kept.size(), at);
  EXPECT_EQ(kept.attributes[0].values.size(), 2 * at);
  EXPECT_EQ(kept.dropped_non_finite, count / 5);
}

TEST(Where, KnowsPositionsFarFromZero) {
  Particles particles = typed({1, 1, 1});
  particles.origin.x = 5e6;
  EXPECT_EQ(finished(particles, where("x>=5000001")).x, (Numbers{1, 2}));
}

TEST(Where, NamesThePlaceThatItDoesNotUnderstand) {
  const std::pair<const char*, const char*> wrong[] = {{"", "character 1"},
                                                       {"type", "character 5"},
                                                       {"type=3", "character 5"},
                                                       {"type==", "character 7"},
                                                       {"type==3 &", "character 9"},
                                                       {"type==3 && ", "character 12"},
                                                       {"type==water", "character 7"},
                                                       {"type==3 rho>2", "character 9"},
                                                       {"(type==3)", "character 1"},
                                                       {"v[==3", "character 3"},
                                                       {"v[0==3", "character 4"},
                                                       {"'v==3", "character 1"},
                                                       {"type==3||", "character 10"},
                                                       {"==3", "character 1"},
                                                       {"v[99999999999999999999]==1", "character"}};
  for (const auto& [text, place] : wrong) {
    try {
      const io::Condition condition(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << text;
      EXPECT_NE(std::string(error.what()).find(place), std::string::npos) << error.what();
    }
  }
}

TEST(Where, ListsTheAttributesWhereOneIsNotThere) {
  for (const char* text : {"absent==1", "velocity==1", "velocity[3]==1", "'kind of'[1]==1", "position[5]==1"}) {
    try {
      chosen(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
      EXPECT_NE(std::string(error.what()).find("x, y, z, kind of, density, velocity[0..2]"), std::string::npos)
          << error.what();
    }
  }
}

TEST(Fluid, OfDualSphysicsIsOfTypeThree) {
  const Particles fluid = finished(typed({0, 1, 2, 3, 3}));
  EXPECT_EQ(fluid.x, (Numbers{3, 4}));
  ASSERT_EQ(fluid.notes.size(), 1u);
  EXPECT_NE(fluid.notes[0].find("3 of 5"), std::string::npos);
  EXPECT_NE(fluid.notes[0].find("--boundaries"), std::string::npos);
  ReadOptions all;
  all.boundaries = true;
  EXPECT_EQ(finished(typed({0, 1, 2, 3, 3}), all).size(), 5u);
  EXPECT_EQ(finished(typed({0, 1, 2, 3, 3}), where("Type<3")).size(), 3u) << "what is asked for comes first";
}

TEST(Fluid, OfDualSphysicsHasMkBelowTen) { EXPECT_EQ(finished(typed({1, 11, 10, 2}, "Mk")).x, (Numbers{0, 3})); }

TEST(Fluid, IsEverythingWhereNothingIsFluid) {
  const Particles boundary = finished(typed({0, 1, 2, 0}));
  EXPECT_EQ(boundary.size(), 4u);
  ASSERT_EQ(boundary.notes.size(), 1u);
  EXPECT_NE(boundary.notes[0].find("boundaries"), std::string::npos);
  EXPECT_EQ(finished(typed({10, 11}, "Mk")).size(), 2u);
}

TEST(Fluid, IsEverythingWhereTheAttributesAreNotSurelyKnown) {
  for (const auto& [name, values] : std::vector<std::pair<std::string, Numbers>>{{"type", {1, 2, 3}},
                                                                                 {"Type", {1, 2, 3, 4}},
                                                                                 {"Type", {0.5f, 3}},
                                                                                 {"Type", {NAN, 3}},
                                                                                 {"Type", {-1, 3}},
                                                                                 {"Type", {3, 3}},
                                                                                 {"mk", {1, 11}},
                                                                                 {"Mk", {1, 10.5f}},
                                                                                 {"tag", {0, 1}}}) {
    const Particles all = finished(typed(values, name));
    EXPECT_EQ(all.size(), values.size()) << name;
    EXPECT_TRUE(all.notes.empty()) << name;
  }
}

TEST(Fluid, OfPySphIsWhatIsNoCopy) {
  Particles particles = typed({0, 1, 0, 2}, "tag");
  particles.attributes.push_back({"gid", 1, {0, 1, 2, 3}});
  particles.attributes.push_back({"pid", 1, {0, 0, 0, 0}});
  EXPECT_EQ(finished(particles).x, (Numbers{0, 2}));
}

TEST(Scale, IsOfLengthsAndVelocitiesAndNothingElse) {
  Particles particles = typed({1, 2}, "density");
  particles.spacing = 4.0f;
  particles.attributes.push_back({"vel", 3, {1, 2, 3, 4, 5, 6}});
  particles.attributes.push_back({"Radius", 1, {2, 4}});
  particles.attributes.push_back({"h", 1, {8, 2}});
  ReadOptions options;
  options.scale = 0.5;
  const Particles scaled = finished(particles, options);
  EXPECT_EQ(scaled.spacing, 2.0f);
  EXPECT_EQ(scaled.find("velocity")->values, (Numbers{0.5f, 1, 1.5f, 2, 2.5f, 3}));
  EXPECT_EQ(scaled.find("Radius")->values, (Numbers{1, 2}));
  EXPECT_EQ(scaled.find("h")->values, (Numbers{4, 1}));
  EXPECT_EQ(scaled.find("density")->values, (Numbers{1, 2}));
  EXPECT_EQ(scaled.x, (Numbers{0, 1})) << "readers scale positions";
}

TEST(Scale, OfTextIsAppliedToItsPositions) {
  const Scratch scratch;
  ReadOptions options;
  options.scale = 0.001;
  const Particles particles = read_particles(scratch.write("f.csv", "x,y,z,vx,vy,vz\n1000,2000,-500,1,0,0\n"), options);
  EXPECT_EQ(particles.position(0), vec3(1, 2, -0.5f));
  EXPECT_EQ(particles.find("velocity")->values[0], 0.001f);
}

TEST(Names, ThatAreNoTextAreMadeReadable) {
  Particles particles = typed({1}, std::string("a\xff\x01"
                                               "b\xc3\xa4\xe2\x82\xac\xed\xa0\x80\xc0\x80\xf0\x9f\x8c\x8a\xc3"));
  EXPECT_EQ(finished(particles).attributes[0].name, "a??b\xc3\xa4\xe2\x82\xac?????\xf0\x9f\x8c\x8a?");
}

}  // namespace
}  // namespace meniscus
