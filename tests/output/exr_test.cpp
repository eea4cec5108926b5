#include <cmath>
#include <cstring>

#include "meniscus/output.h"
#include "output/scratch.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Image<float> depths(int width, int height) {
  Image<float> image(width, height);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = i % 5 == 0 ? kInfinity : std::sqrt(static_cast<float>(i));
  return image;
}

Image<vec3> vectors(int width, int height, float scale) {
  Image<vec3> image(width, height);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const float t = static_cast<float>(i);
    image[i] = scale * vec3{std::sin(t), 1e-30f * t, 1e20f * t};
  }
  return image;
}

const Image<float>& channel(const std::vector<std::pair<std::string, Image<float>>>& channels,
                            const std::string& name) {
  for (const auto& [full_name, image] : channels)
    if (full_name == name) return image;
  throw std::runtime_error("no channel " + name);
}

bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST(Exr, KeepsEveryFloatOfEveryLayer) {
  const Scratch scratch;
  const Image<float> depth = depths(37, 41);
  const Image<vec3> radiance = vectors(37, 41, 1), normal = vectors(37, 41, -3);
  const std::vector<ExrLayer> layers{{.name = "", .vector = &radiance},
                                     {.name = "depth", .scalar = &depth},
                                     {.name = "water.normal", .vector = &normal, .is_direction = true}};
  write_exr(scratch / "a.exr", layers);
  EXPECT_EQ(scratch.names(), std::vector<std::string>{"a.exr"});

  const auto channels = read_exr(scratch / "a.exr");
  std::vector<std::string> names;
  for (const auto& [name, image] : channels) {
    names.push_back(name);
    EXPECT_EQ(image.width(), 37);
    EXPECT_EQ(image.height(), 41);
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names,
            (std::vector<std::string>{"B", "G", "R", "depth", "water.normal.X", "water.normal.Y", "water.normal.Z"}));
  for (std::size_t i = 0; i < depth.size(); ++i) {
    EXPECT_TRUE(same_bits(channel(channels, "depth")[i], depth[i]));
    EXPECT_TRUE(same_bits(channel(channels, "R")[i], radiance[i].x));
    EXPECT_TRUE(same_bits(channel(channels, "G")[i], radiance[i].y));
    EXPECT_TRUE(same_bits(channel(channels, "B")[i], radiance[i].z));
    EXPECT_TRUE(same_bits(channel(channels, "water.normal.Z")[i], normal[i].z));
  }
}

TEST(Exr, RoundsHalvesAndKeepsThemFinite) {
  const Scratch scratch;
  Image<float> values(4, 1);
  values[0] = 1.0f / 3.0f;
  values[1] = 1e6f;
  values[2] = -kInfinity;
  values[3] = 2048.0f;
  const std::vector<ExrLayer> layers{{.scalar = &values, .half = true}};
  write_exr(scratch / "a.exr", layers);
  const auto channels = read_exr(scratch / "a.exr");
  ASSERT_EQ(channels.size(), 1u);
  EXPECT_EQ(channels[0].first, "Y");
  const Image<float>& read = channels[0].second;
  EXPECT_NE(read[0], values[0]);
  EXPECT_NEAR(read[0], values[0], values[0] / 2048);
  EXPECT_EQ(read[1], 65504.0f);
  EXPECT_EQ(read[2], -kInfinity);
  EXPECT_EQ(read[3], 2048.0f);
}

TEST(Exr, IsTheSameFileForAnyNumberOfThreads) {
  const Scratch scratch;
  const Image<vec3> radiance = vectors(120, 100, 1);
  const std::vector<ExrLayer> layers{{.vector = &radiance}};
  write_exr(scratch / "many.exr", layers);
  const ThreadLimit one(1);
  write_exr(scratch / "one.exr", layers);
  EXPECT_EQ(bytes_of(scratch / "many.exr"), bytes_of(scratch / "one.exr"));
}

TEST(Exr, RefusesLayersThatDoNotFit) {
  const Scratch scratch;
  const std::string path = scratch / "a.exr";
  const Image<float> small(3, 3), large(4, 3), empty;
  const Image<vec3> vector(3, 3);
  const auto refused = [&](const std::vector<ExrLayer>& layers) {
    refusal(ErrorCode::invalid_argument, path, [&] { write_exr(path, layers); });
  };
  refused({});
  refused({{.name = "nothing"}});
  refused({{.name = "both", .scalar = &small, .vector = &vector}});
  refused({{.name = "empty", .scalar = &empty}});
  refused({{.name = "a", .scalar = &small}, {.name = "b", .scalar = &large}});
  refused({{.name = "a", .scalar = &small}, {.name = "a", .scalar = &small}});
  refused({{.name = "", .vector = &vector}, {.name = "G", .scalar = &small}});
  EXPECT_TRUE(scratch.names().empty());
}

TEST(Exr, IsRefusedWhereverItIsCutOff) {
  const Scratch scratch;
  const Image<vec3> radiance = vectors(9, 35, 1);
  const std::vector<ExrLayer> layers{{.vector = &radiance}};
  write_exr(scratch / "whole.exr", layers);
  const std::string whole = bytes_of(scratch / "whole.exr");
  for (std::size_t length = 0; length < whole.size(); length += length < 400 ? 1 : 29) {
    write_bytes(scratch / "cut.exr", whole.substr(0, length));
    refusal(ErrorCode::malformed_file, scratch / "cut.exr", [&] { read_exr(scratch / "cut.exr"); });
  }
}

TEST(Exr, WithABrokenHeaderIsRefusedOrRead) {
  // A header has no checksum: a changed byte may be another valid file. It must never be more than that.
  const Scratch scratch;
  const Image<float> depth = depths(9, 9);
  const std::vector<ExrLayer> layers{{.name = "depth", .scalar = &depth}};
  write_exr(scratch / "whole.exr", layers);
  const std::string whole = bytes_of(scratch / "whole.exr");
  int refused = 0;
  for (std::size_t at = 0; at < std::min<std::size_t>(whole.size(), 400); ++at)
    for (const int flip : {0x01, 0x80}) {
      std::string broken = whole;
      broken[at] = static_cast<char>(broken[at] ^ flip);
      write_bytes(scratch / "broken.exr", broken);
      try {
        for (const auto& [name, image] : read_exr(scratch / "broken.exr")) EXPECT_LE(image.size(), 64u << 20);
      } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("broken.exr"), std::string::npos) << error.what();
        ++refused;
      }
    }
  EXPECT_GT(refused, 200);
  EXPECT_LT(peak_rss_bytes(), std::uint64_t{1} << 30);
}

TEST(Exr, OfAnImpossibleSizeIsRefusedBeforeMemoryIsTaken) {
  const Scratch scratch;
  const Image<float> depth = depths(9, 9);
  const std::vector<ExrLayer> layers{{.name = "depth", .scalar = &depth}};
  write_exr(scratch / "a.exr", layers);
  std::string bytes = bytes_of(scratch / "a.exr");
  const std::size_t window = bytes.find(std::string("dataWindow\0box2i\0", 17));
  ASSERT_NE(window, std::string::npos);
  const std::string size("\x2f\x75\0\0\x2f\x75\0\0", 8);  // up to 29,999, 29,999
  bytes.replace(window + 17 + 4 + 8, 8, size);
  write_bytes(scratch / "a.exr", bytes);
  refusal(ErrorCode::limit_exceeded, scratch / "a.exr", [&] { read_exr(scratch / "a.exr"); });
}

TEST(Exr, ReadingNamesWhatIsMissing) {
  const Scratch scratch;
  refusal(ErrorCode::not_found, scratch / "none.exr", [&] { read_exr(scratch / "none.exr"); });
  write_bytes(scratch / "text.exr", "this is a text, not a picture");
  refusal(ErrorCode::malformed_file, scratch / "text.exr", [&] { read_exr(scratch / "text.exr"); });
}

}  // namespace
}  // namespace meniscus
