#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "meniscus/io.h"
#include "program.h"

namespace meniscus {
namespace {

TEST(Convert, WritesWhatReadsBackAsItWas) {
  const Folder folder;
  folder.write("in.csv", "x,y,z,vx,vy,vz,density\n0.1,0.2,0.3,1,2,3,1000\n1e-3,2e5,-7,4,5,6,998.5\n");
  const Particles before = read_particles(folder / "in.csv");
  for (const char* ending : {".vtp", ".ply", ".npz", ".bgeo", ".csv"}) {
    const std::string out = folder / (std::string("deep/out") + ending);
    const Outcome run = run_program({"convert", folder / "in.csv", "-o", out});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const Particles after = read_particles(out);
    EXPECT_EQ(after.x, before.x) << ending;
    EXPECT_EQ(after.y, before.y) << ending;
    EXPECT_EQ(after.z, before.z) << ending;
    ASSERT_NE(after.find("velocity"), nullptr) << ending;
    EXPECT_EQ(after.find("velocity")->values, before.find("velocity")->values) << ending;
    ASSERT_NE(after.find("density"), nullptr) << ending;
    EXPECT_EQ(after.find("density")->values, before.find("density")->values) << ending;
  }
}

TEST(Convert, NumbersASequenceByItsFrames) {
  const Folder folder;
  for (const char* name : {"in/f_8.xyz", "in/f_9.xyz", "in/f_10.xyz"}) folder.write_block(name);
  ASSERT_EQ(run_program({"convert", folder / "in", "-o", folder / "out/{:03}.csv"}).exit_code, 0);
  EXPECT_TRUE(folder.has("out/008.csv") && folder.has("out/009.csv") && folder.has("out/010.csv"));
  EXPECT_EQ(run_program({"convert", folder / "in", "-o", folder / "one.csv"}).exit_code, 2) << "three into one";
}

TEST(Convert, LeavesOutWhatCannotBeReadAndFailsAtTheEnd) {
  const Folder folder;
  folder.write_block("in/f_1.xyz");
  folder.write("in/f_2.xyz", "0 0 0\nbroken\n");
  folder.write_block("in/f_3.xyz");
  const Outcome run = run_program({"convert", folder / "in", "-o", folder / "out/{}.csv"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("f_2.xyz"), std::string::npos) << run.err;
  EXPECT_TRUE(folder.has("out/1.csv") && folder.has("out/3.csv"));
  EXPECT_FALSE(folder.has("out/2.csv"));
  EXPECT_EQ(run_program({"convert", folder / "in", "-o", folder / "strict/{}.csv", "--strict"}).exit_code, 1);
  EXPECT_FALSE(folder.has("strict/3.csv"));
}

TEST(Convert, RefusesWhatCannotBeMeant) {
  const Folder folder;
  folder.write_block("f.csv");
  EXPECT_EQ(run_program({"convert", folder / "f.csv", "-o", folder / "f.doc"}).exit_code, 2);
  EXPECT_EQ(run_program({"convert", folder / "f.csv", "-o", folder / "f.csv"}).exit_code, 2) << "over itself";
  EXPECT_EQ(run_program({"convert", folder / "none.csv", "-o", folder / "g.csv"}).exit_code, 1);
}

TEST(Follow, DrawsFramesAsTheyCome) {
  const Folder folder;
  folder.write_block("in/f_1.xyz");
  std::thread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    folder.write_block("in/f_2.xyz", 5, 0.1f);
  });
  const Outcome run =
      run_program({"render", folder / "in", "-o", folder / "out/{}.png", "--size", "48x32", "--follow-end", "4"});
  writer.join();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(folder.has("out/1.png") && folder.has("out/2.png"));
}

}  // namespace
}  // namespace meniscus
