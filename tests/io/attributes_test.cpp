#include "io/attributes.h"

#include <gtest/gtest.h>

namespace meniscus::io {
namespace {

std::vector<std::string> unified(std::vector<Attribute> attributes) {
  unify_names(attributes);
  std::vector<std::string> names;
  for (const Attribute& attribute : attributes) names.push_back(attribute.name + std::to_string(attribute.components));
  return names;
}

Attribute scalar(const std::string& name, float value = 0) { return {name, 1, {value}}; }

using Names = std::vector<std::string>;

TEST(AttributeNames, ComponentsBecomeOneVelocity) {
  for (const Names& parts : {Names{"vx", "vy", "vz"}, Names{"u", "v", "w"}, Names{"Vel:0", "Vel:1", "Vel:2"},
                             Names{"velocity_x", "velocity_y", "velocity_z"}, Names{"v.x", "v.y", "v.z"},
                             Names{"velocity[0]", "velocity[1]", "velocity[2]"}, Names{"VX", "VY", "VZ"}}) {
    std::vector<Attribute> attributes{scalar("id"), scalar(parts[2], 3), scalar(parts[0], 1), scalar("e"),
                                      scalar(parts[1], 2)};
    unify_names(attributes);
    ASSERT_EQ(attributes.size(), 3u) << parts[0];
    const auto velocity =
        std::find_if(attributes.begin(), attributes.end(), [](const Attribute& a) { return a.name == "velocity"; });
    ASSERT_NE(velocity, attributes.end()) << parts[0];
    EXPECT_EQ(velocity->values, (std::vector<float>{1, 2, 3})) << parts[0];
  }
}

TEST(AttributeNames, SeveralVectorsAreJoinedEach) {
  EXPECT_EQ(unified({scalar("fz"), scalar("force_z"), scalar("force_y"), scalar("vz"), scalar("force_x"), scalar("vx"),
                     scalar("nx"), scalar("ny"), scalar("vy"), scalar("nz")}),
            (Names{"fz1", "force3", "velocity3", "normal3"}));
}

TEST(AttributeNames, IncompleteVectorsStayAsTheyAre) {
  EXPECT_EQ(unified({scalar("u"), scalar("v")}), (Names{"u1", "v1"}));
  EXPECT_EQ(unified({scalar("vx"), scalar("vz")}), (Names{"vx1", "vz1"}));
  EXPECT_EQ(unified({scalar("u0"), scalar("v0"), scalar("w0"), scalar("x0")}), (Names{"u01", "v01", "w01", "x01"}));
}

TEST(AttributeNames, VectorsOfOneNameAreJoinedInTheirOrder) {
  std::vector<Attribute> attributes{scalar("vx", 1), scalar("vy", 2), scalar("vx", 4), scalar("vz", 3),
                                    scalar("id"),    scalar("vz", 6), scalar("vy", 5), scalar("vy", 7),
                                    scalar("u"),     scalar("w"),     scalar("v")};
  unify_names(attributes);
  ASSERT_EQ(attributes.size(), 5u);
  EXPECT_EQ(attributes[0].values, (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(attributes[1].values, (std::vector<float>{4, 5, 6}));
  EXPECT_EQ(attributes[2].name, "id");
  EXPECT_EQ(attributes[3].values, (std::vector<float>{7}));
  EXPECT_EQ(attributes[4].components, 3) << "u, v and w";
}

TEST(AttributeNames, OfVeryManyTakeNoTimeToSpeakOf) {
  // A file's header may name as many as its bytes allow: pairs of them are not to be looked at.
  std::vector<Attribute> attributes;
  for (int i = 0; i < 30'000; ++i) attributes.push_back(scalar("a" + std::to_string(i) + "_x"));
  unify_names(attributes);
  EXPECT_EQ(attributes.size(), 30'000u);
}

TEST(AttributeNames, VectorsAndDensitiesGetTheirCommonNames) {
  for (const char* name : {"v", "vel", "Vel", "VELOCITY", "Velocities"}) {
    EXPECT_EQ(unified({{name, 3, {1, 2, 3}}}), (Names{"velocity3"})) << name;
  }
  for (const char* name : {"rho", "Rho", "Rhop", "DENSITY", "densities"}) {
    EXPECT_EQ(unified({scalar(name)}), (Names{"density1"})) << name;
  }
  EXPECT_EQ(unified({scalar("velocity"), {"rho", 3, {1, 2, 3}}}), (Names{"velocity1", "rho3"}));
}

TEST(AttributeNames, ACommonNameIsGivenOnce) {
  EXPECT_EQ(unified({{"velocity", 3, {1, 2, 3}}, {"v", 3, {1, 2, 3}}}), (Names{"velocity3", "v3"}));
  EXPECT_EQ(unified({{"v", 3, {1, 2, 3}}, {"velocity", 3, {1, 2, 3}}}), (Names{"v3", "velocity3"}));
  EXPECT_EQ(unified({scalar("rho"), scalar("density"), scalar("dens")}), (Names{"rho1", "density1", "dens1"}));
}

}  // namespace
}  // namespace meniscus::io
