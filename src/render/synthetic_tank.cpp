#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "meniscus/render.h"
#include "render/synthetic_random.h"

namespace meniscus {
namespace {

constexpr float kSide = 2.0f;    ///< m: the tank is kSide x about 1 x kSide
constexpr float kJitter = 0.2f;  ///< spacings
constexpr std::size_t kMostDrops = 400;
constexpr std::size_t kMostInDrop = 500;

/// Height of the waves over the mean surface, m.
float wave(float x, float z) {
  return 0.050f * std::sin(3.1f * x + 1.3f * z) + 0.035f * std::sin(-4.3f * x + 5.9f * z + 1.0f) +
         0.015f * std::sin(11.0f * x + 7.0f * z + 2.0f) + 0.006f * std::sin(23.0f * x - 19.0f * z + 0.5f);
}

/// A column of the lattice holds this many particles when the mean surface stands at `level`.
std::size_t in_column(float x, float z, float level, float spacing) {
  const float layers = (level + wave(x, z)) / spacing;
  return layers > 0 ? static_cast<std::size_t>(layers) : 0;
}

/// Appends points, each displaced a little.
class Scatter {
 public:
  Scatter(Particles& particles, float spacing, std::uint64_t seed)
      : particles_(particles), jitter_(kJitter * spacing), random_(seed) {}
  void add(vec3 p) {
    particles_.x.push_back(p.x + random_.between(-jitter_, jitter_));
    particles_.y.push_back(p.y + random_.between(-jitter_, jitter_));
    particles_.z.push_back(p.z + random_.between(-jitter_, jitter_));
  }

 private:
  Particles& particles_;
  float jitter_;
  Random random_;
};

/// Exactly `count` particles of a lattice below the waves.
void fill_tank(Scatter& scatter, std::size_t count, float spacing) {
  const std::size_t side = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kSide / spacing)));
  const auto place = [&](std::size_t i) { return (static_cast<float>(i) + 0.5f) * spacing; };
  const auto total = [&](float level) {
    std::size_t sum = 0;
    for (std::size_t j = 0; j < side; ++j)
      for (std::size_t i = 0; i < side; ++i) sum += in_column(place(i), place(j), level, spacing);
    return sum;
  };
  // The lowest level that holds enough, by bisection; the few too many are left off the tops of the first columns.
  float low = 0, high = 2;
  while (total(high) < count) high *= 2;
  for (int i = 0; i < 40; ++i) {
    const float middle = 0.5f * (low + high);
    (total(middle) < count ? low : high) = middle;
  }
  std::size_t excess = total(high) - count;
  for (std::size_t j = 0; j < side; ++j)
    for (std::size_t i = 0; i < side; ++i) {
      std::size_t layers = in_column(place(i), place(j), high, spacing);
      if (excess > 0 && layers > 0) --layers, --excess;
      for (std::size_t k = 0; k < layers; ++k) scatter.add({place(i), place(k), place(j)});
    }
}

/// A ball of the `count` lattice points nearest to its centre.
void add_drop(Scatter& scatter, vec3 centre, std::size_t count, float spacing) {
  const int reach = static_cast<int>(std::ceil(std::cbrt(static_cast<float>(count)))) / 2 + 2;
  std::vector<glm::ivec3> cells;
  for (int z = -reach; z <= reach; ++z)
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) cells.emplace_back(x, y, z);
  const auto length2 = [](glm::ivec3 c) { return c.x * c.x + c.y * c.y + c.z * c.z; };
  std::stable_sort(cells.begin(), cells.end(), [&](auto a, auto b) { return length2(a) < length2(b); });
  for (std::size_t i = 0; i < count; ++i) scatter.add(centre + spacing * vec3(cells[i]));
}

}  // namespace

Particles synthetic_tank(std::size_t count, std::uint64_t seed) {
  if (count == 0) throw Error(ErrorCode::invalid_argument, "a tank of no particles");
  Random random(seed);

  // Drops take a twentieth of the particles at most; small ones are many.
  std::vector<std::size_t> drops;
  std::size_t in_drops = 0;
  while (drops.size() < kMostDrops) {
    const float size = std::pow(static_cast<float>(kMostInDrop), random.unit() * random.unit());
    const std::size_t particles = std::clamp<std::size_t>(static_cast<std::size_t>(size), 1, kMostInDrop);
    if (in_drops + particles > count / 20) break;
    drops.push_back(particles);
    in_drops += particles;
  }
  const float spacing = std::cbrt(kSide * kSide * 1.0f / static_cast<float>(count - in_drops));

  Particles particles;
  particles.format = "synthetic";
  particles.spacing = spacing;
  particles.up = Axis::y;
  for (auto* axis : {&particles.x, &particles.y, &particles.z}) axis->reserve(count);
  Scatter scatter(particles, spacing, seed ^ 0x5bf03635u);
  fill_tank(scatter, count - in_drops, spacing);
  for (const std::size_t size : drops) {
    const float x = random.between(0.1f, kSide - 0.1f), z = random.between(0.1f, kSide - 0.1f);
    const float above = random.between(0.15f, 0.6f);
    add_drop(scatter, {x, 1.0f + wave(x, z) + above, z}, size, spacing);
  }
  return particles;
}

}  // namespace meniscus
