#include "sim/neighbours.h"

#include <gtest/gtest.h>
#include <random>
#include <set>

#include "box_boundary.h"

namespace meniscus {
namespace {

TEST(Neighbours, AreThoseOfBruteForce) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(0, 1);
  Fluid fluid;
  for (int i = 0; i < 700; ++i) fluid.add({place(random), 0.5f * place(random), 0.7f * place(random)}, vec3{0.0f});
  fluid.add({40, 30, 20}, vec3{0.0f});  // a drop far away
  const float h = 0.13f;
  Neighbours neighbours;
  neighbours.find(fluid.x, fluid.y, fluid.z, h);
  std::size_t sum = 0;
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const vec3 p = neighbours.grid().position(i);
    std::set<std::int32_t> wanted;
    for (std::size_t j = 0; j < fluid.size(); ++j)
      if (j != i && length(neighbours.grid().position(j) - p) < h) wanted.insert(static_cast<std::int32_t>(j));
    const NeighbourList list = neighbours.of(i);
    ASSERT_EQ(std::set<std::int32_t>(list.index, list.index + list.count), wanted);
    ASSERT_EQ(list.count, wanted.size());
    sum += list.count;
    for (std::size_t k = 0; k < (list.count + 15) / 16 * 16; ++k) {
      const auto j = static_cast<std::size_t>(list.index[k]);
      if (k < list.count) {
        const vec3 q = neighbours.grid().position(j);
        EXPECT_NEAR(list.r2[k], dot(q - p, q - p), 1e-6f);
      } else {
        EXPECT_EQ(j, fluid.size());
        EXPECT_EQ(list.r2[k], 4 * h * h);
      }
    }
    EXPECT_FALSE(neighbours.coincident(i));
  }
  EXPECT_NEAR(neighbours.mean(), static_cast<double>(sum) / static_cast<double>(fluid.size()), 1e-4);
}

TEST(Neighbours, InOnePointAreToldAndLimited) {
  const std::vector<float> zeros(1500, 0.25f);
  Neighbours neighbours;
  neighbours.find(zeros, zeros, zeros, 0.1f);
  EXPECT_EQ(neighbours.of(7).count, Neighbours::kMost);
  EXPECT_TRUE(neighbours.coincident(7));
}

}  // namespace
}  // namespace meniscus
