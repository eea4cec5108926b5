#include "scene/texture.h"

#include <gtest/gtest.h>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "scene/hdr_writing.h"
#include "scene/picture_files.h"
#include "scene/scene_of.h"

namespace meniscus {
namespace {

using tests::png_bytes;
using tests::TemporaryFile;
using tests::tga_bytes;

float linear(int byte) {
  const float s = static_cast<float>(byte) / 255.0f;
  return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
}

Image<Texel> noise(int width, int height) {
  std::mt19937 random(2);
  Image<Texel> picture(width, height);
  for (Texel& texel : picture)
    texel = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  return picture;
}

TEST(Texture, ShowsItsTexelsInLinearLight) {
  const Image<Texel> picture = noise(8, 4);
  const Texture texture(picture);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x) {
      // (0, 0) is the lower left corner; it repeats.
      const vec2 point{(static_cast<float>(x) + 0.5f) / 8.0f - 3.0f, 1.0f - (static_cast<float>(y) + 0.5f) / 4.0f};
      const vec3 seen = texture.at(point, {0, 0}, 0);
      EXPECT_NEAR(seen.x, linear(picture(x, y).r), 1e-5f);
      EXPECT_NEAR(seen.y, linear(picture(x, y).g), 1e-5f);
      EXPECT_NEAR(seen.z, linear(picture(x, y).b), 1e-5f);
    }
}

TEST(Texture, OverAllOfItIsItsMean) {
  for (const auto& [width, height] : {std::pair{16, 16}, {13, 7}, {1, 5}, {40, 3}}) {
    const Image<Texel> picture = noise(width, height);
    const Texture texture(picture);
    float mean = 0;
    for (const Texel& texel : picture) mean += linear(texel.g) / static_cast<float>(picture.size());
    EXPECT_NEAR(texture.at({0.3f, 0.7f}, {0, 0}, 50.0f).y, mean, 0.01f) << width << " x " << height;
  }
}

TEST(Texture, AveragesALongRegionAlongIt) {
  // Upright stripes, black and white in turn: averaged across them they are grey, averaged along them they stay.
  Image<Texel> picture(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) picture(x, y) = (x / 4) % 2 ? Texel{255, 255, 255} : Texel{};
  const Texture texture(picture);
  const vec2 white{6.0f / 64, 0.4f};
  EXPECT_NEAR(texture.at(white, {0, 4.0f / 64}, 1.0f / 64).x, 1.0f, 0.01f);
  EXPECT_NEAR(texture.at(white, {4.0f / 64, 0}, 1.0f / 64).x, 0.5f, 0.13f);
  // Half a period farther the average over a period is the same.
  EXPECT_NEAR(texture.at({10.0f / 64, 0.4f}, {4.0f / 64, 0}, 1.0f / 64).x,
              1.0f - texture.at(white, {4.0f / 64, 0}, 1.0f / 64).x, 0.01f);
}

TEST(Texture, IsReadFromItsFile) {
  const Image<Texel> picture = noise(9, 5);
  for (const std::string& bytes : {png_bytes(picture), tga_bytes(picture)}) {
    const TemporaryFile file(bytes);
    const auto texture = read_texture(file.path());
    ASSERT_EQ(texture->width(), 9);
    ASSERT_EQ(texture->height(), 5);
    EXPECT_NEAR(texture->at({0.5f / 9, 4.5f / 5}, {0, 0}, 0).x, linear(picture(0, 0).r), 1e-5f) << "upper left";
    EXPECT_EQ(read_texture(file.path()), texture) << "kept while in use";
  }
}

TEST(Texture, DamagedIsAnErrorThatNamesTheFile) {
  const std::string whole = png_bytes(noise(20, 20));
  std::vector<std::string> damaged{"",
                                   "no picture",
                                   whole.substr(0, 20),
                                   whole.substr(0, 200),
                                   whole.substr(0, whole.size() / 2),
                                   std::string("\xFF\xD8\xFF\xE0") + "short"};
  std::string huge = whole;
  huge[16] = 0x7F;  // width
  damaged.push_back(huge);
  for (const std::string& bytes : damaged) {
    const TemporaryFile file(bytes);
    try {
      read_texture(file.path());
      FAIL() << bytes.size();
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().path, file.path());
      EXPECT_TRUE(error.code() == ErrorCode::malformed_file || error.code() == ErrorCode::limit_exceeded);
    }
  }
  EXPECT_THROW(read_texture("/nowhere/picture.png"), Error);
  EXPECT_THROW(read_texture("/tmp"), Error);
}

TEST(Texture, OnASolidIsAveragedOverTheBeam) {
  // White left half, black right half.
  Image<Texel> picture(32, 32);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 16; ++x) picture(x, y) = {255, 255, 255};
  const TemporaryFile file(png_bytes(picture));
  Mesh square;
  square.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  square.texture_points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  square.corners = {0, 1, 2, 0, 2, 3};
  square.materials = {SolidMaterial{vec3{0.5f}, file.path(), 1.0f, 1.5f}};
  const Scene scene = scene_of({{make_solid(square), glm::mat4(1.0f), {}}});
  EXPECT_NEAR(scene.hit({{0.5f, 1.2f, 3}, {0, 0, -1}}).albedo.x, 0.5f, 1e-4f);
  EXPECT_NEAR(scene.hit({{1.5f, 0.7f, 3}, {0, 0, -1}}).albedo.x, 0.0f, 1e-4f);
  EXPECT_NEAR(scene.hit({{1.4f, 0.7f, 3}, {0, 0, -1}}, {0, 4.0f}).albedo.x, 0.25f, 0.01f);
  // Seen slantwise along x the beam is long in x.
  const vec3 slant = glm::normalize(vec3{1, 0, -0.15f});
  EXPECT_NEAR(scene.hit({vec3{1.15f, 0.7f, 0} - 2.0f * slant, slant}, {0.05f, 0}).albedo.x, 0.03f, 0.03f);
  EXPECT_GT(scene.hit({vec3{1.1f, 0.7f, 0} - 2.0f * slant, slant}, {0.05f, 0}).albedo.x, 0.02f);
  EXPECT_LT(scene.hit({{1.1f, 0.7f, 3}, {0, 0, -1}}, {0.05f, 0}).albedo.x, 0.01f);
  // A placed copy wears another one, or none.
  const Scene plain = scene_of({{make_solid(square), glm::mat4(1.0f), SolidMaterial{}}});
  EXPECT_EQ(plain.hit({{1.5f, 0.7f, 3}, {0, 0, -1}}).albedo, vec3{0.6f});
}

}  // namespace
}  // namespace meniscus
