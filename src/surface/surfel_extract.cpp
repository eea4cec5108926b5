#include "surface/surfel_extract.h"

#include <fmt/format.h>

#include "surface/density.h"
#include "surface/surfel_block.h"

namespace meniscus {
namespace {

void require(bool holds, std::string_view name, double value, std::string_view range) {
  if (!holds)
    throw Error(
        ErrorCode::invalid_argument,
        ErrorDetail{
            fmt::format("{} is out of range", name), std::string(range), fmt::format("{}", value), {}, {}, {}, {}});
}

struct Blocks {
  int nx = 0, ny = 0, nz = 0;
  std::vector<std::uint64_t> keys;  ///< those near particles, rising; x fastest, then y, then z
};

/// The blocks that the kernels of particles reach. A table while it is small, else sorted keys, so that a few drops
/// that flew far away cost what they weigh.
Blocks blocks_near(const RaycastField& field, const SurfelGrid& grid) {
  Blocks blocks;
  const BandGrid& particles = field.grid;
  const float h = field.options.smoothing_length + grid.step;
  const vec3 size = grid.step * vec3{kBlockX, kBlockY, kBlockZ};
  const vec3 far = (particles.bounds().high + h - grid.low) / size;
  blocks.nx = static_cast<int>(far.x) + 1;
  blocks.ny = static_cast<int>(far.y) + 1;
  blocks.nz = static_cast<int>(far.z) + 1;
  const std::uint64_t across = static_cast<std::uint64_t>(blocks.nx),
                      plane = across * static_cast<std::uint64_t>(blocks.ny);
  const std::uint64_t all = plane * static_cast<std::uint64_t>(blocks.nz);
  const bool small = all <= 4 * particles.size() + 1'000'000;
  std::vector<std::uint8_t> table(small ? all : 0);
  const auto unique = [](std::vector<std::uint64_t>& keys) {
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  };
  std::size_t tidy_at = 1 << 20;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const vec3 low = (particles.position(i) - h - grid.low) / size,
               high = (particles.position(i) + h - grid.low) / size;
    const auto index = [](float value, int n) { return std::clamp(static_cast<int>(std::floor(value)), 0, n - 1); };
    const int x1 = index(high.x, blocks.nx), y1 = index(high.y, blocks.ny), z1 = index(high.z, blocks.nz);
    for (int z = index(low.z, blocks.nz); z <= z1; ++z)
      for (int y = index(low.y, blocks.ny); y <= y1; ++y)
        for (int x = index(low.x, blocks.nx); x <= x1; ++x) {
          const std::uint64_t key = static_cast<std::uint64_t>(z) * plane + static_cast<std::uint64_t>(y) * across +
                                    static_cast<std::uint64_t>(x);
          if (small)
            table[key] = 1;
          else
            blocks.keys.push_back(key);
        }
    if (blocks.keys.size() >= tidy_at) {
      unique(blocks.keys);
      tidy_at = std::max<std::size_t>(1 << 20, 2 * blocks.keys.size());
    }
  }
  unique(blocks.keys);
  for (std::uint64_t key = 0; key < table.size(); ++key)
    if (table[key]) blocks.keys.push_back(key);
  return blocks;
}

}  // namespace

SurfelOptions resolved(const SurfelOptions& given) {
  SurfelOptions options = given;
  const float s = options.spacing;
  require(s > 0 && std::isfinite(s), "particle spacing", s, "more than 0 m");
  if (options.smoothing_length == 0) options.smoothing_length = 2.0f * s;
  if (options.grid_step == 0) options.grid_step = 0.5f * s;
  require(options.grid_step >= s / 32 && options.grid_step <= 2 * s, "grid step", options.grid_step,
          fmt::format("1/32 to 2 spacings of {} m", s));
  if (options.gap_threshold == 0) options.gap_threshold = 1.5f * options.grid_step;
  require(options.gap_threshold > 0, "gap threshold", options.gap_threshold, "0 m or more");
  if (options.epsilon == 0) options.epsilon = s;
  require(options.epsilon > 0 && std::isfinite(options.epsilon), "epsilon", options.epsilon, "more than 0 m");
  require(options.filter_radius >= 0 && options.filter_radius <= 32, "filter radius", options.filter_radius,
          "0 to 32 px");
  return options;
}

DensityOptions density_options_of(const SurfelOptions& options) {
  return {options.spacing, options.smoothing_length, options.kernel, options.keep_thin, options.iso};
}

std::vector<Surfel> extract_surfels(const RaycastField& field, const SurfelOptions& options, StageTimes* times) {
  StageTimer timer(times, "surfels");
  std::vector<Surfel> surfels;
  if (field.grid.size() == 0) return surfels;
  const SurfelGrid grid{field.grid.bounds().low - options.smoothing_length - options.grid_step, options.grid_step,
                        options.gap_threshold};
  const Blocks blocks = blocks_near(field, grid);
  // Pieces of blocks, so that what each of them found waits in few pieces of memory.
  constexpr std::size_t kGrain = 4;
  std::vector<std::vector<Surfel>> found((blocks.keys.size() + kGrain - 1) / kGrain);
  parallel_for(blocks.keys.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t across = static_cast<std::uint64_t>(blocks.nx), down = static_cast<std::uint64_t>(blocks.ny);
      const std::uint64_t key = blocks.keys[i];
      add_block_surfels(field, grid, static_cast<int>(key % across), static_cast<int>(key / across % down),
                        static_cast<int>(key / across / down), found[begin / kGrain]);
    }
  });
  std::size_t total = 0;
  for (const auto& piece : found) total += piece.size();
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::limit_exceeded, ErrorDetail{"there are too many surfels",
                                                       "2^32 at most",
                                                       fmt::format("{}", total),
                                                       {},
                                                       {},
                                                       {},
                                                       "take a larger grid step"});
  surfels.reserve(total);
  for (auto& piece : found) {
    surfels.insert(surfels.end(), piece.begin(), piece.end());
    piece = {};
  }
  return surfels;
}

std::vector<Surfel> extract_surfels(const Particles& particles, const SurfelOptions& given, StageTimes* times) {
  const SurfelOptions options = resolved(given);
  return extract_surfels(make_density_field(particles, density_options_of(options), true, {}, times), options, times);
}

}  // namespace meniscus
