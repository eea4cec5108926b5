#include "sim/wall_kernel.h"

#include <cmath>

#include "meniscus/formulas/fluids.h"

namespace meniscus {

void NearWalls::find(const Boundary& boundary, const Neighbours& neighbours, float h) {
  first_.resize(neighbours.size());
  count_.resize(neighbours.size());
  if (walls_.size() < neighbours.pieces()) {
    walls_.resize(neighbours.pieces());
    kept_.resize(neighbours.pieces());
  }
  const ParticleGrid& grid = neighbours.grid();
  parallel_for(neighbours.size(), Neighbours::kPiece, [&](std::size_t begin, std::size_t end) {
    std::vector<Wall>& found = walls_[begin / Neighbours::kPiece];
    found.clear();
    Wall walls[Boundary::kMostWalls];
    std::fill(first_.begin() + static_cast<std::ptrdiff_t>(begin), first_.begin() + static_cast<std::ptrdiff_t>(end),
              0u);
    std::fill(count_.begin() + static_cast<std::ptrdiff_t>(begin), count_.begin() + static_cast<std::ptrdiff_t>(end),
              std::uint8_t{0});
    for (const Neighbours::Group& group : neighbours.groups(begin / Neighbours::kPiece)) {
      if (!boundary.may_touch(group.box, h)) continue;
      for (std::size_t i = group.begin; i < group.end; ++i) {
        const int count = boundary.walls_near(grid.position(i), h, walls);
        first_[i] = static_cast<std::uint32_t>(found.size());
        count_[i] = static_cast<std::uint8_t>(count);
        found.insert(found.end(), walls, walls + count);
      }
    }
    kept_[begin / Neighbours::kPiece].resize(found.size());
  });
}

WallShares wall_shares(std::span<const Wall> walls, const float* distance, float h) {
  WallShares shares;
  float part[Boundary::kMostWalls];
  const float per_h = 1.0f / h;
  for (std::size_t a = 0; a < walls.size(); ++a) part[a] = formulas::spiky_beyond(distance[a] * per_h, 1.0f);
  for (std::size_t a = 0; a < walls.size(); ++a) {
    // The part of this wall's solid that is in none before it; exact for perpendicular walls through one point.
    float own = part[a];
    shares.weight[a] = 1.0f;
    for (std::size_t b = 0; b < walls.size(); ++b) {
      if (b == a || part[b] == 0.0f) continue;
      const float cosine = glm::dot(walls[a].normal, walls[b].normal);
      if (cosine == 0.0f) {  // most walls are perpendicular: what is below comes to this
        shares.weight[a] *= 1.0f - part[b];
        if (b < a) own *= 1.0f - part[b];
        continue;
      }
      shares.weight[a] *= 1.0f - formulas::beyond_both_slope(part[a], part[b], cosine);
      if (b < a && part[a] > 0.0f) own *= 1.0f - formulas::beyond_both(part[a], part[b], cosine) / part[a];
    }
    shares.solid += own;
  }
  return shares;
}

vec3 some_direction(std::uint32_t number) {
  // Steps of the golden angle, from pole to pole.
  const float height = 2.0f * static_cast<float>((number * 2654435769u) >> 8) / 16777216.0f - 1.0f;
  const float angle = 2.3999632f * static_cast<float>(number % 65536u);
  const float across = std::sqrt(std::max(0.0f, 1.0f - height * height));
  return {across * std::cos(angle), height, across * std::sin(angle)};
}

void ImpulseSums::clear(std::size_t pieces) {
  if (sums_.size() < pieces) sums_.resize(pieces);
  for (auto& piece : sums_) piece.clear();
}

void ImpulseSums::add(std::size_t piece, const Boundary& boundary, int body, vec3 impulse, vec3 point) {
  auto& sums = sums_[piece];
  std::size_t k = 0;
  while (k < sums.size() && sums[k].body != body) ++k;
  if (k == sums.size()) sums.push_back({body});
  const glm::dvec3 linear(impulse), arm(point - boundary.centre(static_cast<std::size_t>(body)));
  sums[k].linear += linear;
  sums[k].angular += glm::cross(arm, linear);
}

void ImpulseSums::add_to(std::span<Impulse> impulses) const {
  std::vector<OfBody> totals(impulses.size());
  for (const auto& piece : sums_)
    for (const OfBody& sum : piece)
      if (static_cast<std::size_t>(sum.body) < totals.size()) {
        totals[static_cast<std::size_t>(sum.body)].linear += sum.linear;
        totals[static_cast<std::size_t>(sum.body)].angular += sum.angular;
      }
  for (std::size_t body = 0; body < totals.size(); ++body) {
    impulses[body].linear += vec3(totals[body].linear);
    impulses[body].angular += vec3(totals[body].angular);
  }
}

}  // namespace meniscus
