// Which particles a grid of the band near the surface keeps, and in what order, against brute force over cells.
#include "particles/band_grid.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "particles/clouds.h"

namespace meniscus {
namespace {

using namespace clouds;

/// Cells by coordinates, as the definitions say.
class Oracle {
 public:
  Oracle(const Particles& particles, const BandGrid::Options& options) : options_(options) {
    low_ = particles.bounds().low - 0.25f * options.cell_size;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const vec3 p = particles.position(i);
      cells_[cell_of(p)].push_back(static_cast<std::uint32_t>(i));
      patches_[cell_of(p)].insert(patch_of(p));
    }
  }
  using Cell = std::array<int, 3>;
  Cell cell_of(vec3 p) const {
    const vec3 at = (p - low_) * (1.0f / options_.cell_size);
    return {static_cast<int>(at.x), static_cast<int>(at.y), static_cast<int>(at.z)};
  }
  bool well_filled(Cell c) const {
    const auto found = cells_.find(c);
    return found != cells_.end() && found->second.size() >= options_.well_filled &&
           patches_.at(c).size() >= std::min(options_.well_filled, 2u);
  }
  bool all_filled(Cell c, int reach) const {
    if (options_.well_filled == 0) return false;
    for (int z = -reach; z <= reach; ++z)
      for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
          if (!well_filled({c[0] + x, c[1] + y, c[2] + z})) return false;
        }
    return true;
  }
  bool is_deep(Cell c) {
    const auto known = deep_.find(c);
    if (known != deep_.end()) return known->second;
    return deep_[c] = all_filled(c, options_.kept_layers + 1);
  }
  BandGrid::Kind kind(Cell c) {
    if (is_deep(c)) return BandGrid::deep;
    return all_filled(c, 1) ? BandGrid::hidden : BandGrid::open;
  }
  const std::map<Cell, std::vector<std::uint32_t>>& cells() const { return cells_; }

 private:
  int patch_of(vec3 p) const {
    const vec3 at = (p - low_) * (1.0f / options_.cell_size);
    const glm::ivec3 sub = glm::floor(4.0f * (at - glm::floor(at)));
    return (sub.x + 2 * sub.y + 3 * sub.z) % 8;
  }

  BandGrid::Options options_;
  vec3 low_;
  std::map<Cell, std::set<int>> patches_;
  std::map<Cell, std::vector<std::uint32_t>> cells_;
  std::map<Cell, bool> deep_;
};

struct Counted {
  std::size_t deep = 0, hidden = 0;
};

/// Every cell of every block, and that there is no particle elsewhere.
Counted expect_as_defined(const Particles& particles, const BandGrid::Options& options) {
  const BandGrid grid(particles, options);
  Oracle oracle(particles, options);
  Counted met;
  EXPECT_EQ(grid.counted(), particles.size());
  std::size_t next = 0, counted = 0;
  std::array<int, 3> before{-1, -1, -1};
  for (int block = 0; block < grid.blocks(); ++block) {
    const glm::ivec3 corner = grid.corner(block), at = corner / BandGrid::kSide;
    EXPECT_EQ(grid.find(at.x, at.y, at.z), block);
    const std::array<int, 3> order{at.z, at.y, at.x};
    EXPECT_LT(before, order);
    before = order;
    EXPECT_EQ(grid.run(block).begin, next);
    std::size_t in_block = 0;
    bool all_open = true;
    for (int i = 0; i < BandGrid::kCells; ++i) {
      const Oracle::Cell cell{corner.x + i % 8, corner.y + i / 8 % 8, corner.z + i / 64};
      const auto found = oracle.cells().find(cell);
      const std::vector<std::uint32_t> in_cell =
          found == oracle.cells().end() ? std::vector<std::uint32_t>{} : found->second;
      in_block += in_cell.size();
      const BandGrid::Kind kind = oracle.kind(cell);
      met.deep += kind == BandGrid::deep;
      met.hidden += kind == BandGrid::hidden;
      all_open = all_open && kind == BandGrid::open;
      EXPECT_EQ(grid.kinds(block)[i], kind) << cell[0] << " " << cell[1] << " " << cell[2];
      EXPECT_EQ(grid.counts(block)[i], in_cell.size());
      const BandGrid::Run run = grid.run(block, i);
      EXPECT_EQ(run.begin, next);
      std::vector<std::uint32_t> kept;
      for (std::size_t k = run.begin; k < run.end; ++k) {
        kept.push_back(grid.given_index(k));
        EXPECT_EQ(grid.position(k), particles.position(grid.given_index(k)));
      }
      EXPECT_EQ(kept, kind == BandGrid::deep ? std::vector<std::uint32_t>{} : in_cell);
      next = run.end;
      const bool amidst = (grid.amidst(block)[i / 64] >> i % 64 & 1) != 0;
      EXPECT_EQ(amidst, oracle.all_filled(cell, 2));
      const vec3 middle = grid.origin() + options.cell_size * (vec3(cell[0], cell[1], cell[2]) + 0.5f);
      EXPECT_EQ(grid.kind_at(middle), kind);
      bool full = false;
      if (grid.has_deep())
        for (int n = 0; n < 27; ++n)
          full = full || oracle.is_deep({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      EXPECT_EQ(grid.full_at(middle), full);
      EXPECT_EQ(grid.touches_full(middle, middle), full);
    }
    EXPECT_GT(in_block, 0u);
    if (grid.all_open(block)) {
      EXPECT_TRUE(all_open);
    }
    counted += in_block;
  }
  EXPECT_EQ(next, grid.size());
  EXPECT_EQ(counted, particles.size());
  return met;
}

TEST(BandGrid, LeavesOutTheParticlesOfDeepCellsOnly) {
  for (const int layers : {0, 1, 2}) {
    const Counted met = expect_as_defined(cubic(26, 24, 28, 0.3), {2.0f, 3, layers});
    EXPECT_GT(met.deep, 0u) << layers;
    EXPECT_EQ(met.hidden > 0, layers > 0);
  }
}

TEST(BandGrid, FindsKindsAcrossBlocksOfTroubledWater) {
  EXPECT_GT(expect_as_defined(flip_seeds(26, 23, 21), {2.0f, 3, 1}).deep, 0u);
  EXPECT_GT(expect_as_defined(advected(20, 0.5), {2.0f, 2, 1}).hidden, 0u);
  expect_as_defined(splash(), {2.0f, 3, 2});
  EXPECT_GT(expect_as_defined(cubic(36, 36, 36), {1.5f, 1, 9}).deep, 0u);  // layers beyond a block
}

/// Cells of two with three particles each, in so many points.
Particles in_clumps(int cells, int points) {
  Particles particles;
  add(particles, {0, 0, 0});
  for (int z = 0; z < cells; ++z)
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x)
        for (int i = 0; i < 3; ++i)
          add(particles, 2.0 * glm::dvec3(x, y, z) + glm::dvec3(0.3 + 0.5 * std::min(i, points - 1), 0.3, 0.3));
  return particles;
}

TEST(BandGrid, TakesClumpsForNoWaterHoweverManyParticlesTheyHold) {
  const BandGrid::Options wanted{2.0f, 3, 1};
  for (const Particles& cloud : {in_clumps(9, 1), joined(in_clumps(9, 1), in_clumps(9, 1))}) {
    EXPECT_FALSE(BandGrid(cloud, wanted).has_hidden());
    expect_as_defined(cloud, wanted);
  }
  EXPECT_GT(expect_as_defined(in_clumps(9, 2), wanted).deep, 0u);
  EXPECT_GT(expect_as_defined(in_clumps(9, 1), {2.0f, 1, 1}).deep, 0u);  // one particle is enough
}

TEST(BandGrid, TakesALatticeForWaterWhereverItsPlanesAreRoundedTo) {
  // Planes half a cell apart stand between sub-cubes but for rounding errors, to either side.
  for (const double shift : {0.0, 0.25, 0.5, 0.75, 0.1})
    for (int sides = 0; sides < 64; ++sides) {
      const auto rounded = [&](int plane, int axis) {
        return plane + 1 + shift + ((sides >> (2 * axis + plane % 2) & 1) != 0 ? 1e-5 : -1e-5);
      };
      Particles lattice;
      add(lattice, {0, 0, 0});
      for (int z = 0; z < 12; ++z)
        for (int y = 0; y < 12; ++y)
          for (int x = 0; x < 12; ++x) add(lattice, {rounded(x, 0), rounded(y, 1), rounded(z, 2)});
      EXPECT_TRUE(BandGrid(lattice, {2.0f, 3, 0}).has_deep()) << shift << " " << sides;
    }
}

TEST(BandGrid, LeavesOutTheMiddleOfAnExactLattice) {
  // Planes half a cell apart, from the lowest particles on: of a simulation's first frame.
  for (const float spacing : {0.01f, 0.025f, 0.3f}) {
    Particles lattice;
    for (int z = 0; z < 48; ++z)
      for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 48; ++x) add(lattice, glm::dvec3(0.7f + spacing * vec3(x, y, z)));
    const BandGrid grid(lattice, {2 * spacing, 3, 2});
    EXPECT_EQ(grid.size(), lattice.size() - std::size_t{8} * 18 * 18 * 18) << spacing;
  }
}

TEST(BandGrid, LeavesOutTroubledWaterWhereHereAndThereACellHoldsItsParticlesInTwoPatches) {
  Particles particles = cubic(48, 44, 48, 0.25);
  for (float& y : particles.y) y *= 1.1f;
  const BandGrid grid(particles, {2.0f, 3, 2});
  // All but six layers of cells along each axis.
  EXPECT_LT(static_cast<double>(grid.size()), static_cast<double>(particles.size()) - 0.95 * 8 * 18 * 18 * 18 / 1.1);
  expect_as_defined(particles, {2.0f, 3, 1});
}

TEST(BandGrid, KeepsAllWhereNoCellIsWellFilled) {
  const Particles particles = cubic(30, 30, 30, 0.2);
  const BandGrid grid(particles, {2.0f, 0, 2});
  EXPECT_EQ(grid.size(), particles.size());
  EXPECT_FALSE(grid.has_hidden());
  expect_as_defined(particles, {2.0f, 0, 2});
}

TEST(BandGrid, SortsTheSameWithoutIndices) {
  const Particles particles = shuffled(cubic(32, 30, 34, 0.3), 3);
  const BandGrid with(particles, {2.0f, 3, 1}), without(particles, {2.0f, 3, 1, false});
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i) ASSERT_EQ(with.position(i), without.position(i));
  EXPECT_EQ(with.memory_bytes() - without.memory_bytes(), 4 * (with.size() + BandGrid::kPadding));
}

TEST(BandGrid, DoesNotDependOnTheOrderOfBlocksOfTheInput) {
  expect_as_defined(shuffled(cubic(32, 30, 34, 0.3), 3), {2.0f, 3, 1});
}

TEST(BandGrid, FindsBlocksByHashingInASparseCloud) {
  Particles particles = joined(cubic(32, 30, 34, 0.3), spray(60, {-4e4, -4e4, -4e4}, {4e4, 4e4, 4e4}));
  EXPECT_GT(expect_as_defined(particles, {2.0f, 3, 1}).deep, 0u);
  expect_as_defined(shuffled(particles, 5), {2.0f, 3, 1});
}

TEST(BandGrid, FindsEveryBoxOfASparseCloud) {
  const Particles particles = joined(cubic(20, 20, 20, 0.3), spray(500, {-900, -900, -900}, {900, 900, 900}));
  const BandGrid grid(particles, {2.0f, 0, 2});
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    const vec3 centre = i % 2 ? particles.position(random.bits() % particles.size()) : vec3(random.in_cube(1000));
    const vec3 half(static_cast<float>(std::pow(10.0, random.between(-1, 3.2))));
    std::vector<bool> met(particles.size());
    grid.for_each_run(centre - half, centre + half, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        EXPECT_FALSE(met[grid.given_index(k)]);
        met[grid.given_index(k)] = true;
      }
    });
    for (std::size_t k = 0; k < particles.size(); ++k) {
      const vec3 off = glm::abs(particles.position(k) - centre);
      if (std::max({off.x, off.y, off.z}) < half.x) {
        EXPECT_TRUE(met[k]);
      }
    }
  }
}

TEST(BandGrid, TakesNoMoreForSprayThanItsParticlesJustify) {
  const BandGrid grid(spray(100000, {-3e5, -3e5, -3e5}, {3e5, 3e5, 3e5}), {2.0f, 3, 2});
  EXPECT_EQ(grid.size(), 100000u);
  EXPECT_LT(grid.memory_bytes(), 128u * 100000u);
}

TEST(BandGrid, HoldsOneParticleNoneAndManyInOnePoint) {
  expect_as_defined(spray(1, {3, 4, 5}, {3, 4, 5}), {0.1f, 1, 1});
  const BandGrid none(Particles{}, {0.1f, 3, 2});
  EXPECT_EQ(none.size(), 0u);
  EXPECT_EQ(none.blocks(), 0);
  EXPECT_EQ(none.find(0, 0, 0), -1);
  EXPECT_EQ(none.kind_at({0, 0, 0}), BandGrid::open);
  none.for_each_run({-1, -1, -1}, {1, 1, 1}, [](std::size_t, std::size_t) { ADD_FAILURE(); });
  expect_as_defined(spray(70000, {3, 4, 5}, {3, 4, 5}), {0.1f, 3, 1});
}

TEST(BandGrid, KeepsItsOrderFarFromTheOrigin) {
  const Particles far = moved(cubic(30, 30, 30, 0.3), [](glm::dvec3 p) { return p + glm::dvec3(1e5, -2e5, 3e5); });
  expect_as_defined(far, {2.0f, 3, 1});
}

TEST(BandGrid, IsTheSameForAnyNumberOfThreads) {
  const Particles tank = cubic(80, 70, 60, 0.4);
  for (const Particles& particles : {tank, shuffled(tank, 1), joined(tank, spray(50, {-1e5, 0, 0}, {1e5, 1, 1}))}) {
    std::vector<BandGrid> grids;
    for (const int threads : {1, 2, 5}) {
      const ThreadLimit limit(threads);
      grids.emplace_back(particles, BandGrid::Options{2.0f, 3, 1});
    }
    for (const BandGrid& grid : grids) {
      ASSERT_EQ(grid.size(), grids[0].size());
      EXPECT_LT(grid.size(), particles.size());
      for (std::size_t i = 0; i < grid.size(); ++i) ASSERT_EQ(grid.given_index(i), grids[0].given_index(i));
    }
  }
}

TEST(BandGrid, HasPaddingThatIsFarFromEverything) {
  const BandGrid grid(cubic(5, 5, 5), {2.0f, 3, 2});
  for (std::size_t i = grid.size(); i < grid.size() + BandGrid::kPadding; ++i)
    EXPECT_GT(std::min({grid.x()[i], grid.y()[i], grid.z()[i]}), 1e17f);
}

TEST(BandGrid, RefusesCellsThatCannotSort) {
  const Particles particles = cubic(3, 3, 3);
  for (const float cell : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), 1e-45f, 1e-8f})
    EXPECT_THROW(BandGrid(particles, {cell, 3, 2}), Error) << cell;
  EXPECT_THROW(BandGrid(joined(particles, spray(1, {3e38, 0, 0}, {3e38, 0, 0})), {1.0f, 3, 2}), Error);
}

}  // namespace
}  // namespace meniscus
