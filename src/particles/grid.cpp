#include "particles/grid.h"

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

namespace meniscus {
namespace {

constexpr std::size_t kGrain = 1 << 16;
constexpr float kMostCellsAlongAxis = 1 << 20;
constexpr std::size_t kDenseCellsPerParticle = 8;
constexpr std::size_t kDenseCellsAlways = 1 << 18;
constexpr float kFarAway = 1e18f;  ///< its square is finite, its distance to any particle beyond any support

}  // namespace

ParticleGrid::ParticleGrid(const Particles& particles, float cell_size)
    : count_(particles.size()), cell_size_(cell_size), per_cell_(1.0f / cell_size) {
  if (!(cell_size > 0.0f) || !std::isfinite(per_cell_))
    throw Error(ErrorCode::invalid_argument, fmt::format("cells of {} m cannot sort particles", cell_size));
  if (count_ > 0xffffffffu)
    throw Error(ErrorCode::limit_exceeded,
                fmt::format("{} particles in one frame; at most 2^32 - 1 can be sorted", count_));
  if (count_ > 0) {
    std::vector<Bounds> partial((count_ + kGrain - 1) / kGrain);
    parallel_for(count_, kGrain, [&](std::size_t begin, std::size_t end) {
      Bounds bounds;
      for (std::size_t i = begin; i < end; ++i) bounds.add(particles.position(i));
      partial[begin / kGrain] = bounds;
    });
    for (const Bounds& bounds : partial) bounds_.add(bounds);
    const vec3 extent = bounds_.extent();
    const float longest = std::max({extent.x, extent.y, extent.z});
    if (!(longest * per_cell_ < kMostCellsAlongAxis))
      throw Error(ErrorCode::limit_exceeded,
                  ErrorDetail{fmt::format("the particles spread over {:.3g} m, too wide for cells of {:.3g} m", longest,
                                          cell_size),
                              {},
                              {},
                              {},
                              {},
                              {},
                              "set a larger particle spacing, or leave out the particles that have flown away"});
    const auto along = [&](float size) { return static_cast<int>(size * per_cell_) + 1; };
    nx_ = along(extent.x);
    ny_ = along(extent.y);
    nz_ = along(extent.z);
    index_.resize(count_);
    if (cell_count() <= std::max(kDenseCellsAlways, kDenseCellsPerParticle * count_))
      sort_dense(particles);
    else
      sort_sparse(particles);
  }
  gather(particles);
}

std::size_t ParticleGrid::key_of(const Particles& particles, std::size_t i) const {
  const auto along = [&](float value, float low, int n) {
    return std::min(static_cast<int>((value - low) * per_cell_), n - 1);
  };
  return cell_index(along(particles.x[i], bounds_.low.x, nx_), along(particles.y[i], bounds_.low.y, ny_),
                    along(particles.z[i], bounds_.low.z, nz_));
}

void ParticleGrid::sort_dense(const Particles& particles) {
  // Counting sort by blocks of particles, each with counters of its own. It is stable, so the outcome does not
  // depend on the number of blocks.
  const std::size_t cells = cell_count();
  const std::size_t blocks =
      std::clamp<std::size_t>(std::min(static_cast<std::size_t>(thread_count()), 4 * count_ / (cells + 1)), 1, 8);
  const std::size_t per_block = (count_ + blocks - 1) / blocks;
  std::vector<std::uint32_t> key(count_);
  std::vector<std::vector<std::uint32_t>> counters(blocks);
  parallel_for(blocks, 1, [&](std::size_t block, std::size_t) {
    auto& mine = counters[block];
    mine.assign(cells, 0);
    for (std::size_t i = block * per_block; i < std::min(count_, (block + 1) * per_block); ++i) {
      key[i] = static_cast<std::uint32_t>(key_of(particles, i));
      ++mine[key[i]];
    }
  });
  start_.resize(cells + 1);
  std::uint32_t sum = 0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    start_[cell] = sum;
    for (auto& mine : counters) {
      const std::uint32_t in_block = mine[cell];
      mine[cell] = sum;
      sum += in_block;
    }
  }
  start_[cells] = sum;
  parallel_for(blocks, 1, [&](std::size_t block, std::size_t) {
    auto& mine = counters[block];
    for (std::size_t i = block * per_block; i < std::min(count_, (block + 1) * per_block); ++i)
      index_[mine[key[i]]++] = static_cast<std::uint32_t>(i);
  });
}

void ParticleGrid::sort_sparse(const Particles& particles) {
  struct Entry {
    std::uint64_t key;
    std::uint32_t index;
    bool operator<(const Entry& other) const { return key != other.key ? key < other.key : index < other.index; }
  };
  std::vector<Entry> entries(count_);
  parallel_for(count_, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) entries[i] = {key_of(particles, i), static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(entries.begin(), entries.end());
  for (std::size_t i = 0; i < count_; ++i) {
    index_[i] = entries[i].index;
    if (i == 0 || entries[i].key != entries[i - 1].key) {
      sparse_keys_.push_back(entries[i].key);
      sparse_start_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  sparse_start_.push_back(static_cast<std::uint32_t>(count_));
}

ParticleGrid::Run ParticleGrid::sparse_run(std::size_t first_key, std::size_t last_key) const {
  const auto first = std::lower_bound(sparse_keys_.begin(), sparse_keys_.end(), first_key);
  auto last = first;
  while (last != sparse_keys_.end() && *last <= last_key) ++last;  // a few cells at most in a sparse cloud
  return {sparse_start_[static_cast<std::size_t>(first - sparse_keys_.begin())],
          sparse_start_[static_cast<std::size_t>(last - sparse_keys_.begin())]};
}

void ParticleGrid::gather(const Particles& particles) {
  x_.resize(count_ + kPadding, kFarAway);
  y_.resize(count_ + kPadding, kFarAway);
  z_.resize(count_ + kPadding, kFarAway);
  parallel_for(count_, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t from = index_[i];
      x_[i] = particles.x[from];
      y_[i] = particles.y[from];
      z_[i] = particles.z[from];
    }
  });
  std::fill(x_.begin() + static_cast<std::ptrdiff_t>(count_), x_.end(), kFarAway);
  std::fill(y_.begin() + static_cast<std::ptrdiff_t>(count_), y_.end(), kFarAway);
  std::fill(z_.begin() + static_cast<std::ptrdiff_t>(count_), z_.end(), kFarAway);
}

}  // namespace meniscus
