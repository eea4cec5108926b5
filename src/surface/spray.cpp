#include "surface/spray.h"

#include <array>

namespace meniscus {
namespace {

constexpr int kAround = 2;        ///< cells; no shorter than two smoothing lengths
constexpr std::size_t kFew = 32;  ///< particles in the cells around that are looked at one by one
constexpr float kMargin = 1.01f;

/// Entry radius by the number of particles around, m; as many as are worth counting.
std::vector<float> radii_of(const RaycastField& field, float largest) {
  const RaycastOptions& options = field.options;
  const float volume = options.spacing * options.spacing * options.spacing;
  const float heaviest = options.keep_thin ? mass_rule(options).lone_mass : 1.0f;
  std::vector<float> radii{0.0f};
  for (int n = 1; n <= 64; ++n) {
    const auto reaches = [&](float d) {
      return static_cast<float>(n) * heaviest * volume * kernel_value(options.kernel, d, options.smoothing_length) >=
             options.iso;
    };
    float radius = 0;
    if (reaches(0.0f)) {
      float low = 0, high = options.smoothing_length;
      for (int i = 0; i < 24; ++i) (reaches(0.5f * (low + high)) ? low : high) = 0.5f * (low + high);
      radius = kMargin * std::sqrt(high * high + field.step * field.step);
    }
    if (radius >= largest) break;
    radii.push_back(radius);
  }
  return radii;
}

/// The cells around one, nearest first: most counts are settled by a few.
std::array<glm::ivec3, 125> offsets_around() {
  std::array<glm::ivec3, 125> offsets;
  std::size_t count = 0;
  for (int z = -kAround; z <= kAround; ++z)
    for (int y = -kAround; y <= kAround; ++y)
      for (int x = -kAround; x <= kAround; ++x) offsets[count++] = {x, y, z};
  const auto length2 = [](glm::ivec3 v) { return v.x * v.x + v.y * v.y + v.z * v.z; };
  std::stable_sort(offsets.begin(), offsets.end(), [&](auto a, auto b) { return length2(a) < length2(b); });
  return offsets;
}

}  // namespace

void shrink_entries_of_spray(RaycastField& field) {
  constexpr std::size_t kBlocks = 64;
  const BandGrid& grid = field.grid;
  if (grid.cell_size() < field.options.smoothing_length) return;
  const std::vector<float> radii = radii_of(field, entry_radius_at(field.options, 1.0f));
  const std::size_t most = radii.size() - 1;
  if (most == 0) return;
  const auto offsets = offsets_around();
  parallel_for(static_cast<std::size_t>(grid.blocks()), kBlocks, [&](std::size_t begin, std::size_t end) {
    for (int block = static_cast<int>(begin); block < static_cast<int>(end); ++block) {
      const glm::ivec3 corner = grid.corner(block);
      const auto around = [&](int cell) {
        const glm::ivec3 at = corner + glm::ivec3(cell % 8, cell / 8 % 8, cell / 64);
        std::size_t count = 0;
        for (const glm::ivec3& offset : offsets) {
          const glm::ivec3 c = at + offset;
          if (c.x < 0 || c.y < 0 || c.z < 0) continue;
          const glm::ivec3 b = c / BandGrid::kSide, in = c - b * BandGrid::kSide;
          const int other = b * BandGrid::kSide == corner ? block : grid.find(b.x, b.y, b.z);
          if (other < 0) continue;
          count += grid.counts(other)[(in.z * BandGrid::kSide + in.y) * BandGrid::kSide + in.x];
          if (count > kFew) break;
        }
        return count;
      };
      const float reach = 2.0f * field.options.smoothing_length;
      const auto within_reach = [&](vec3 at) {
        std::size_t count = 0;
        grid.for_each_run(at - reach, at + reach, [&](std::size_t first, std::size_t last) {
          for (std::size_t j = first; j < last; ++j) {
            const vec3 off = grid.position(j) - at;
            count += off.x * off.x + off.y * off.y + off.z * off.z <= reach * reach;
          }
        });
        return count;
      };
      for (int cell = 0; cell < BandGrid::kCells; ++cell) {
        const BandGrid::Run run = grid.run(block, cell);
        if (run.begin == run.end || run.end - run.begin > most) continue;
        if (around(cell) > kFew) continue;
        for (std::size_t i = run.begin; i < run.end; ++i) {
          const std::size_t count = within_reach(grid.position(i));
          if (count <= most) field.entry_radius[i] = std::min(field.entry_radius[i], radii[count]);
        }
      }
    }
  });
}

}  // namespace meniscus
