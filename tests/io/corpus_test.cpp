// Files that once made a reader stumble: each is read, or refused with an error that names it.
#include <filesystem>

#include "small_frames.h"

namespace meniscus {
namespace {

TEST(Corpus, IsReadOrRefused) {
  for (const auto& entry : std::filesystem::directory_iterator(MENISCUS_SOURCE_DIR "/tests/fuzz/corpus")) {
    if (!entry.is_regular_file()) continue;
    const std::string path = entry.path().string();
    try {
      const Particles particles = read_particles(path);
      EXPECT_EQ(particles.y.size(), particles.size()) << path;
      EXPECT_EQ(particles.z.size(), particles.size()) << path;
      for (const Attribute& attribute : particles.attributes)
        EXPECT_EQ(attribute.values.size(), particles.size() * static_cast<std::size_t>(attribute.components)) << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.detail().path, path);
    }
  }
}

}  // namespace
}  // namespace meniscus
