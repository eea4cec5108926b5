#include "render/antialias.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace meniscus {
namespace {

/// A block of water on the ground beside a box.
struct Corner {
  Corner() : scene(Environment(EnvironmentOptions{}), Ground{}) {
    HeightField field;
    field.low = vec2(-1);
    field.step = vec2(0.5f);
    field.height = Image<float>(4, 4, 0.5f);
    water = make_height_field_surface(std::move(field));
    scene.set_solids({{make_solid(box_mesh({0.7f, 0, -0.5f}, {1.4f, 0.9f, 0.5f})), glm::mat4(1.0f), {}, false}});
  }
  Scene scene;
  Material material = Material{};
  std::unique_ptr<Surface> water;
};

Image<vec3> shaded(const Corner& corner, const View& view, SurfaceBuffers& seen) {
  seen = corner.water->see(view);
  return shade(view, {}, seen, corner.scene, corner.material, {{}, nullptr, corner.water.get(), nullptr});
}

// Against the mean of a picture of four times the size, whose pixels are the sixteen rays.
TEST(RefinePixels, DrawsOutlinesAsSixteenRaysWould) {
  const Corner corner;
  const View view = perspective_view({0.4f, 1.6f, 4}, {0.2f, 0.3f, 0}, {0, 1, 0}, 0.7f, 120, 80);
  SurfaceBuffers seen, fine;
  Image<vec3> picture = shaded(corner, view, seen);
  const Image<vec3> coarse = picture;
  const Image<vec3> expected = downsampled(shaded(corner, view.resized(480, 320), fine), 4);
  const SceneBuffers solids = corner.scene.see(view);
  const std::vector<std::uint32_t> pixels = silhouette_pixels(view, seen, corner.scene, 0.01f, &solids);
  ASSERT_GT(pixels.size(), 200u);
  refine_pixels(*corner.water, view, corner.scene, corner.material, {{}, nullptr, corner.water.get(), nullptr}, pixels,
                seen, picture);
  const auto apart = [&](const Image<vec3>& drawn, std::size_t i) {
    const vec3 difference = glm::abs(drawn[i] - expected[i]);
    return std::max({difference.r, difference.g, difference.b}) /
           std::max({expected[i].r, expected[i].g, expected[i].b});
  };
  double mean = 0, before = 0;
  for (const std::uint32_t pixel : pixels) {
    EXPECT_LT(apart(picture, pixel), 0.12f) << pixel;
    mean += static_cast<double>(apart(picture, pixel));
    before += static_cast<double>(apart(coarse, pixel));
  }
  mean /= static_cast<double>(pixels.size());
  before /= static_cast<double>(pixels.size());
  EXPECT_LT(mean, 0.01);
  EXPECT_GT(before, 8 * mean);
  // Other pixels are left alone.
  for (std::size_t i = 0; i < picture.size(); ++i)
    EXPECT_TRUE(std::binary_search(pixels.begin(), pixels.end(), i) || picture[i] == coarse[i]) << i;
}

}  // namespace
}  // namespace meniscus
