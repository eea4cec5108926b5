// Surfels written as a file of points and read again as particles.
#include <gtest/gtest.h>

#include <filesystem>

#include "meniscus/io.h"
#include "meniscus/output.h"
#include "meniscus/surface.h"

namespace meniscus {
namespace {

TEST(SurfelsPly, IsReadBackBitForBitWithNormalsAndRadii) {
  Particles particles;
  for (int i = 0; i < 64; ++i) {
    particles.x.push_back(0.1f * static_cast<float>(i % 4));
    particles.y.push_back(0.1f * static_cast<float>(i / 4 % 4));
    particles.z.push_back(0.1f * static_cast<float>(i / 16));
  }
  SurfelOptions options;
  options.spacing = 0.1f;
  const std::vector<Surfel> surfels = extract_surfels(particles, options);
  ASSERT_GT(surfels.size(), 100u);
  std::vector<vec3> positions, normals;
  std::vector<float> radii;
  for (const Surfel& surfel : surfels) {
    positions.push_back(surfel.position);
    normals.push_back(surfel.normal);
    radii.push_back(surfel.radius);
  }
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() /
      ("meniscus_surfels_ply_" + std::to_string(reinterpret_cast<std::uintptr_t>(&surfels)));
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "surfels_7.ply").string();
  write_point_ply(path, positions, normals, radii);
  const Particles read = read_particles(path);
  std::filesystem::remove_all(folder);

  ASSERT_EQ(read.size(), surfels.size());
  const Attribute* radius = read.find("radius");
  ASSERT_NE(radius, nullptr);
  const Attribute *normal = read.find("normal"), *parts[3] = {read.find("nx"), read.find("ny"), read.find("nz")};
  ASSERT_TRUE(normal || (parts[0] && parts[1] && parts[2]));
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    EXPECT_EQ(read.position(i), positions[i]);
    EXPECT_EQ(radius->values[i], radii[i]);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(normal ? normal->values[3 * i + static_cast<std::size_t>(axis)] : parts[axis]->values[i],
                normals[i][axis]);
  }
}

}  // namespace
}  // namespace meniscus
