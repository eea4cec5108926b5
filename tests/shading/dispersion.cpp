// Dispersion and the choice of Fresnel's formula.
#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>

#include "fixtures.h"
#include "meniscus/formulas/optics.h"

namespace meniscus {
namespace {

using namespace tests;

Image<vec3> slab(const Material& material, const OpticsOptions& options, bool in_water = false) {
  // A grazing look onto level water with its own reflection of the sky: white above, black below.
  static const Scene scene = without_ground(half_lit_environment());
  SurfaceBuffers buffers = even(8, 6, 5.0f, {0, 1, 0}, 0.5f);
  buffers.eye_in_water = in_water;
  const vec3 direction = in_water ? vec3{0.3f, 1.0f, 0.0f} : vec3{1.0f, -0.4f, 0.0f};
  return shade(looking(direction), {}, buffers, scene, material, {options, nullptr, nullptr, nullptr});
}

TEST(Dispersion, ShadesEachChannelAsIfTheMaterialHadItsIndex) {
  Material material = clear();
  material.extinction = {0.4f, 0.5f, 0.6f};
  material.dispersion = {-0.05f, 0.02f, 0.3f};
  OpticsOptions options;
  options.dispersion = true;
  for (const bool in_water : {false, true}) {
    const vec3 seen = slab(material, options, in_water)(4, 3);
    for (int k = 0; k < 3; ++k) {
      Material one = material;
      one.ior += material.dispersion[k];
      one.dispersion = vec3{0.0f};
      // Many pixels at a time are rounded otherwise.
      EXPECT_NEAR(seen[k], slab(one, options, in_water)(4, 3)[k], 1e-6) << k;
      // With another channel's index the pixel is shaded by itself.
      one.dispersion[(k + 1) % 3] = 0.1f;
      EXPECT_EQ(seen[k], slab(one, options, in_water)(4, 3)[k]) << k;
    }
    options.dispersion = false;
    EXPECT_NE(slab(material, options, in_water)(4, 3), seen);
    options.dispersion = true;
  }
}

TEST(Dispersion, OfWaterBendsBlueMoreThanRed) {
  const Material water = material_preset("water", 1.0f);
  EXPECT_LT(water.dispersion.x, water.dispersion.y);
  EXPECT_LT(water.dispersion.y, water.dispersion.z);
  // Abbe's number of water is 55.7: (n_d - 1) / (n_F - n_C), the lines 589, 486 and 656 nm lying within 450 to 650 nm.
  const float number = (water.ior - 1) / (water.dispersion.z - water.dispersion.x);
  EXPECT_GT(number, 35.0f);
  EXPECT_LT(number, 56.0f);
}

TEST(Dispersion, RefusesAnIndexThatIsNotAboveOne) {
  Material material = clear(1.1f);
  material.dispersion = {-0.1f, 0, 0};
  EXPECT_THROW(slab(material, {}), Error);
}

TEST(Schlick, IsExactStraightOnAndAtGrazing) {
  for (const float eta : {1.333f, 1.0f / 1.333f, 1.5f}) {
    EXPECT_NEAR(formulas::schlick_reflectance(1.0f, eta), formulas::fresnel_reflectance(1.0f, eta), 1e-6f);
    EXPECT_NEAR(formulas::schlick_reflectance(0.0f, eta), 1.0f, 1e-6f);
  }
}

TEST(Schlick, IsWithinSevenHundredthsOfFresnelOnBothSidesOfWater) {
  for (const float eta : {1.333f, 1.0f / 1.333f})
    for (float angle = 0; angle < 1.57f; angle += 0.01f)
      EXPECT_NEAR(formulas::schlick_reflectance(std::cos(angle), eta),
                  formulas::fresnel_reflectance(std::cos(angle), eta), 0.07f)
          << eta << " " << angle;
}

TEST(Schlick, IsWhatTheWaterReflectsWhenItIsAskedFor) {
  const Material material = clear();
  OpticsOptions options;
  options.fresnel = FresnelFormula::schlick;
  const vec3 direction = glm::normalize(vec3{1.0f, -0.4f, 0.0f});
  // The refracted ray goes down into the black half, the mirrored one up into the white one.
  const vec3 seen = slab(material, options)(4, 3);
  EXPECT_NEAR(seen.y, formulas::schlick_reflectance(-direction.y, material.ior), 1e-5f);
  EXPECT_GT(std::abs(seen.y - slab(material, {})(4, 3).y), 1e-4f);
  EXPECT_THROW(fresnel_formula_of("cook"), Error);
  EXPECT_EQ(fresnel_formula_of("schlick"), FresnelFormula::schlick);
}

}  // namespace
}  // namespace meniscus
