/// Grounds for the tests.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "meniscus/sim.h"

namespace meniscus::test {

/// Smooth ground of 1 cm cells of the given heights: row 0 of the list is the near end of b.
inline GroundOptions ground_of(const std::vector<std::vector<float>>& rows,
                               GroundMaterial material = GroundMaterial::steel) {
  GroundOptions options;
  options.cell = 0.01f;
  const int width = static_cast<int>(rows[0].size()), height = static_cast<int>(rows.size());
  options.high = {0.01f * static_cast<float>(width), 0.01f * static_cast<float>(height)};
  options.material = material;
  options.roughness = 0;
  options.heights = Image<float>(width, height);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      options.heights(i, height - 1 - j) = rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
  return options;
}

/// Ground as a function of the cell.
template <class F>
GroundOptions ground_from(int width, int height, F&& f, GroundMaterial material = GroundMaterial::steel) {
  std::vector<std::vector<float>> rows(static_cast<std::size_t>(height));
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) rows[static_cast<std::size_t>(j)].push_back(static_cast<float>(f(i, j)));
  return ground_of(rows, material);
}

/// Rough ground of all materials with hollows of some millimetres.
inline GroundOptions rough_ground(int size, std::uint64_t seed = 7) {
  GroundOptions options;
  options.low = {-1.0f, 2.0f};
  options.cell = 0.01f;
  options.high = options.low + vec2(0.01f * static_cast<float>(size));
  options.materials = Image<GroundMaterial>(3, 1);
  options.materials(0, 0) = GroundMaterial::concrete;
  options.materials(1, 0) = GroundMaterial::asphalt;
  options.materials(2, 0) = GroundMaterial::steel;
  options.roughness = 0.004f;
  options.seed = seed;
  return options;
}

inline double area_of(const WetGround& ground) {
  return static_cast<double>(ground.options().cell) * static_cast<double>(ground.options().cell);
}

inline double level_of(const WetGround& ground, std::size_t cell) {
  return static_cast<double>(ground.bed(cell)) + ground.depth(cell);
}

/// How far the budget is from closing, relative to what has fallen.
inline double missing_part(const WetGround& ground) {
  const WaterBudget budget = ground.budget();
  return std::abs(budget.fallen - (budget.soaked + budget.standing + budget.drained)) / budget.fallen;
}

}  // namespace meniscus::test
