// render --dry-run and --memory-limit, as a user meets them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "meniscus/image.h"
#include "meniscus/io.h"
#include "meniscus/output.h"
#include "meniscus/render.h"
#include "program.h"

namespace meniscus {
namespace {

using nlohmann::json;

Outcome render(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "render");
  return run_program(arguments);
}

/// A film of waves of so many particles.
void write_waves(const Folder& folder, std::size_t particles, int frames) {
  const json scene = {{"water", {{"waves", {{"particles", particles}, {"frames", frames}}}}}};
  folder.write("waves.json", scene.dump());
}

/// A frame of a tank of water in a binary file.
std::string write_tank(const Folder& folder, std::size_t count) {
  const std::string path = folder / "tank.ply";
  write_particles(path, synthetic_tank(count));
  return path;
}

std::size_t files_in(const Folder& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::recursive_directory_iterator(folder.path()),
                                                std::filesystem::recursive_directory_iterator()));
}

TEST(DryRun, TellsWhatARunWouldTakeAndWritesNothing) {
  const Folder folder;
  folder.write_block("in/f_1.xyz");
  folder.write_block("in/f_2.xyz", 7);
  const std::size_t before = files_in(folder);
  const Outcome text = render({folder / "in", "-o", folder / "new/{}.png", "--dry-run"});
  ASSERT_EQ(text.exit_code, 0) << text.err;
  for (const char* part : {"2 pictures", "343", "memory", "time"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << ": " << text.out;
  const Outcome run = render({folder / "in", "-o", folder / "film.mp4", "--dry-run", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json told = json::parse(run.out);
  EXPECT_EQ(told["pictures"], 2);
  EXPECT_EQ(told["particles"], 343);
  EXPECT_EQ(told["all_particles"], 125 + 343);
  EXPECT_EQ(told["counted"], true);
  EXPECT_EQ(told["slabs"], 1);
  for (const char* key : {"frame_s", "total_s", "output_bytes", "input_bytes"})
    EXPECT_GT(told[key].get<double>(), 0) << key;
  EXPECT_GT(told["memory_bytes"]["peak"].get<double>(), 1e6);
  EXPECT_EQ(files_in(folder), before);
}

TEST(DryRun, ForeseesTheMemoryOfARun) {
  const Folder folder;
  const std::string tank = write_tank(folder, 400000);
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--size", "320x240", "--refraction", "thickness", "--no-caustics"},
        std::vector<std::string>{"--size", "640x480"}}) {
    std::vector<std::string> arguments{tank, "-o", folder / "still.png", "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    std::vector<std::string> dry = arguments;
    dry.insert(dry.end(), {"--dry-run", "--json"});
    const json told = json::parse(render(dry).out);
    arguments.insert(arguments.end(), {"--report", folder / "report.json"});
    ASSERT_EQ(render(arguments).exit_code, 0);
    const double real = json::parse(folder.read("report.json"))["peak_rss_bytes"].get<double>();
    const double foreseen = told["memory_bytes"]["peak"].get<double>();
    EXPECT_GT(foreseen, 0.6 * real);
    EXPECT_LT(foreseen, 1.6 * real);
  }
}

TEST(DryRun, KnowsFramesThatAreMadeUp) {
  const Folder folder;
  write_waves(folder, 30000, 7);
  const Outcome run =
      render({folder / "waves.json", "-o", folder / "film.mp4", "--dry-run", "--json", "--size", "64x64"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json told = json::parse(run.out);
  EXPECT_EQ(told["pictures"], 7);
  EXPECT_EQ(told["particles"], 30000);
  EXPECT_EQ(told["all_particles"], 210000);
  EXPECT_FALSE(folder.has("film.mp4"));
}

TEST(DryRun, RefusesWhatTheRunWouldRefuse) {
  const Folder folder;
  folder.write_block("in/f_1.xyz");
  folder.write_block("in/f_2.xyz");
  EXPECT_EQ(render({folder / "in", "-o", folder / "one.png", "--dry-run"}).exit_code, 2) << "two pictures, one file";
  EXPECT_EQ(render({folder / "none", "-o", folder / "one.png", "--dry-run"}).exit_code, 1);
  EXPECT_EQ(render({folder / "in/f_1.xyz", "-o", folder / "one.png", "--json"}).exit_code, 2);
  folder.write("broken.ply",
               "ply\nformat binary_little_endian 1.0\nelement vertex 99999999\nproperty float x\nend_header\n");
  EXPECT_EQ(render({folder / "broken.ply", "-o", folder / "one.png", "--dry-run"}).exit_code, 1);
}

TEST(MemoryLimit, IsReadStrictly) {
  const Folder folder;
  folder.write_block("f.xyz", 2);
  for (const char* wrong : {"4 GB", "4gb", "GB", "-1GB", "1e9", "1..5GB", "nan", "4GBx", "99999999999TB", "0.1", ""}) {
    const Outcome run =
        render({folder / "f.xyz", "-o", folder / "f.png", "--dry-run", std::string("--memory-limit=") + wrong});
    EXPECT_EQ(run.exit_code, 2) << wrong << run.err;
    EXPECT_NE(run.err.find("--memory-limit"), std::string::npos) << wrong << run.err;
  }
  for (const char* right : {"0", "4GB", "1.5GiB", "2000000000", "900MiB"})
    EXPECT_EQ(render({folder / "f.xyz", "-o", folder / "f.png", "--dry-run", "--memory-limit", right}).exit_code, 0)
        << right;
}

/// What the refusal names, each as arguments: "... what would do: --size 640x360 or --memory-limit 200MB".
std::vector<std::vector<std::string>> advised(const std::string& error) {
  const std::string head = "what would do: ";
  const std::size_t begin = error.find(head);
  if (begin == std::string::npos) return {};
  std::istringstream words(error.substr(begin + head.size()));
  std::vector<std::vector<std::string>> advice(1);
  for (std::string word; words >> word;) {
    const bool ends = word.ends_with(",");
    if (ends) word.pop_back();
    while (word.ends_with(")")) word.pop_back();
    if (word == "or")
      advice.emplace_back();
    else if (word != "with")
      advice.back().push_back(word);
    if (ends) advice.emplace_back();
  }
  return advice;
}

TEST(MemoryLimit, RefusesBeforeItStartsAndNamesOnlyWhatWouldDo) {
  const Folder folder;
  const std::string tank = write_tank(folder, 200000);
  const auto peak = [&](const std::vector<std::string>& options) {
    std::vector<std::string> dry{tank, "-o", folder / "a.png", "--dry-run", "--json"};
    dry.insert(dry.end(), options.begin(), options.end());
    return json::parse(render(dry).out)["memory_bytes"]["peak"].get<double>();
  };
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{}, std::vector<std::string>{"--antialias", "2x2"},
        std::vector<std::string>{"--surface", "surfels", "--refraction", "thickness"}})
    for (const double share : {0.9, 0.6, 0.3}) {
      std::vector<std::string> asked{tank, "-o", folder / "out/still.png", "--memory-limit",
                                     std::to_string(static_cast<std::uint64_t>(share * peak(options)))};
      asked.insert(asked.end(), options.begin(), options.end());
      const Outcome run = render(asked);
      EXPECT_EQ(run.exit_code, 1) << run.err;
      EXPECT_NE(run.err.find("no more than the limit of"), std::string::npos) << run.err;
      EXPECT_FALSE(folder.has("out"));
      const std::vector<std::vector<std::string>> advice = advised(run.err);
      ASSERT_FALSE(advice.empty()) << run.err;
      if (share == 0.9) {
        EXPECT_GT(advice.size(), 1u) << run.err;
      }
      for (const std::vector<std::string>& change : advice) {
        std::vector<std::string> other{tank, "-o", folder / "still.png", "--dry-run"};
        std::vector<std::string> rest(asked.begin() + 3, asked.end());
        for (std::size_t i = 0; i + 1 < rest.size();)  // what is given anew replaces what was asked for
          if (std::find(change.begin(), change.end(), rest[i]) != change.end())
            rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i),
                       rest.begin() + static_cast<std::ptrdiff_t>(i) + 2);
          else
            i += 2;
        other.insert(other.end(), rest.begin(), rest.end());
        other.insert(other.end(), change.begin(), change.end());
        const Outcome followed = render(other);
        EXPECT_EQ(followed.exit_code, 0) << run.err << followed.err;
      }
    }
  const Outcome file = render({tank, "-o", folder / "out/still.png", "--memory-limit", "2MB"});
  EXPECT_EQ(file.exit_code, 1);
  EXPECT_NE(file.err.find("file is larger"), std::string::npos) << file.err;
  EXPECT_NE(file.err.find("tank.ply"), std::string::npos) << file.err;
}

/// dB, of two pictures of the folder.
double psnr_of(const Folder& folder, const std::string& first, const std::string& second) {
  const Image<Rgb8> a = read_png(folder / (first + ".png")), b = read_png(folder / (second + ".png"));
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (const int difference : {a[i].r - b[i].r, a[i].g - b[i].g, a[i].b - b[i].b}) squares += difference * difference;
  return 10 * std::log10(3.0 * 255 * 255 * static_cast<double>(a.size()) / std::max(squares, 1e-9));
}

TEST(MemoryLimit, DrawsTheSamePictureInPartsAndStaysBelow) {
  const Folder folder;
  const std::string tank = write_tank(folder, 1500000);
  std::vector<std::string> arguments{tank,          "--size", "200x150", "--refraction", "thickness", "--no-caustics",
                                     "--antialias", "off",    "--quiet"};
  const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"-o", folder / (name + ".png"), "--report", folder / (name + ".json")});
    all.insert(all.end(), more.begin(), more.end());
    return render(all);
  };
  ASSERT_EQ(run("whole", {}).exit_code, 0);
  const double whole = json::parse(folder.read("whole.json"))["peak_rss_bytes"].get<double>();
  // The first limit in steps of which the surface as a whole is foreseen to take too much.
  std::vector<std::string> dry = arguments;
  dry.insert(dry.end(), {"-o", folder / "dry.png", "--dry-run", "--json", "--memory-limit"});
  bool in_parts = false;
  for (double share = 1.3; share > 0.4 && !in_parts; share -= 0.02) {
    const std::string limit = std::to_string(static_cast<std::uint64_t>(share * whole));
    dry.push_back(limit);
    const Outcome told = render(dry);
    dry.pop_back();
    if (told.exit_code != 0 || json::parse(told.out)["slabs"].get<int>() < 2) continue;
    in_parts = true;
    const Outcome drawn = run("parts", {"--memory-limit", limit});
    ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
    EXPECT_LT(json::parse(folder.read("parts.json"))["peak_rss_bytes"].get<double>(), share * whole);
    EXPECT_GT(psnr_of(folder, "whole", "parts"), 50);
    ASSERT_EQ(run("whole", {"--no-shadow"}).exit_code, 0);
    ASSERT_EQ(run("parts", {"--no-shadow", "--memory-limit", limit}).exit_code, 0);
    EXPECT_GT(psnr_of(folder, "whole", "parts"), 50);
  }
  EXPECT_TRUE(in_parts);
}

}  // namespace
}  // namespace meniscus
