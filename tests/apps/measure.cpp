#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "meniscus/output.h"
#include "program.h"

namespace meniscus {
namespace {

using nlohmann::json;

TEST(BenchRaycast, PrintsEveryKeyAndAgreesWithThePlainMethod) {
  const Outcome run =
      run_program({"bench", "raycast", "--particles", "2000", "--size", "64x48", "--iso-sweep", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json measured = json::parse(run.out);
  EXPECT_EQ(measured["particles"], 2000);
  EXPECT_EQ(measured["width"], 64);
  EXPECT_EQ(measured["height"], 48);
  EXPECT_GT(measured["stages_ms"].size(), 2u);
  for (const char* key : {"frame_ms", "peak_rss_bytes", "plain_frame_ms", "ratio"})
    EXPECT_GT(measured[key].get<double>(), 0) << key;
  EXPECT_TRUE(measured["plain_measured_size"].is_array());
  EXPECT_LT(measured["hit_mismatch"].get<double>(), 0.001);
  EXPECT_LT(measured["depth_error_p99_spacings"].get<double>(), 0.01);
  EXPECT_EQ(measured["iso_sweep"].size(), 5u);
  EXPECT_NEAR(measured["iso_sweep"][0]["iso"].get<double>(), 0.3, 1e-9);
}

TEST(Compare, TellsHowFarTwoPicturesDiffer) {
  const Folder folder;
  Image<Rgb8> a(16, 16, {10, 20, 30}), b = a;
  b(3, 4) = {20, 20, 30};
  write_png(folder / "a.png", a);
  write_png(folder / "b.png", b);
  const json equal = json::parse(run_program({"compare", folder / "a.png", folder / "a.png", "--json"}).out);
  EXPECT_EQ(equal["psnr_db"], 999);
  EXPECT_EQ(equal["pixels_differing"], 0);
  const json different = json::parse(run_program({"compare", folder / "a.png", folder / "b.png", "--json"}).out);
  EXPECT_EQ(different["pixels_differing"], 1);
  EXPECT_EQ(different["max_difference"], 10);
  // One channel of 3 x 256 is off by 10.
  EXPECT_NEAR(different["psnr_db"].get<double>(), 10 * std::log10(255.0 * 255.0 / (100.0 / 768.0)), 0.01);
  EXPECT_LT(different["ssim"].get<double>(), 1);
}

TEST(Compare, JudgesIfItIsAskedTo) {
  const Folder folder;
  write_png(folder / "a.png", Image<Rgb8>(4, 4, {10, 20, 30}));
  write_png(folder / "b.png", Image<Rgb8>(4, 4, {90, 20, 30}));
  write_png(folder / "c.png", Image<Rgb8>(5, 4, {90, 20, 30}));
  EXPECT_EQ(run_program({"compare", folder / "a.png", folder / "a.png", "--min-psnr", "50"}).exit_code, 0);
  EXPECT_EQ(run_program({"compare", folder / "a.png", folder / "b.png", "--min-psnr", "50"}).exit_code, 1);
  EXPECT_EQ(run_program({"compare", folder / "a.png", folder / "b.png"}).exit_code, 0);
  EXPECT_EQ(run_program({"compare", folder / "a.png", folder / "c.png"}).exit_code, 1);
}

}  // namespace
}  // namespace meniscus
