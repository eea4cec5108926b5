#include "shading/caustics_cells.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace meniscus {
namespace {

/// Texels between samples at most, and samples along a side of a cell at most.
constexpr float kApart = 0.55f;
constexpr int kMostSamples = 48;
/// Rows of the map that one piece of work fills, and rows of cells in one list.
constexpr int kBandRows = 32;
constexpr std::size_t kListRows = 16;

struct Place {
  int x, y;
};

/// A cell; its dry corners have no light.
struct Cell {
  vec2 at[4];
  float flux[4];
  float low, high;  ///< rows
  float left, right;
};

/// @return  false: no light
bool cell_of(const LightPoint* upper, const LightPoint* lower, Cell& cell) {
  const LightPoint* corners[4] = {upper, upper + 1, lower, lower + 1};
  float most = 0;
  for (const LightPoint* corner : corners) most = std::max(most, corner->flux);
  if (!(most > 0)) return false;
  for (int k = 0; k < 4; ++k) {
    cell.at[k] = corners[k]->at;
    cell.flux[k] = std::max(corners[k]->flux, 0.0f);
  }
  cell.low = std::min({cell.at[0].y, cell.at[1].y, cell.at[2].y, cell.at[3].y});
  cell.high = std::max({cell.at[0].y, cell.at[1].y, cell.at[2].y, cell.at[3].y});
  cell.left = std::min({cell.at[0].x, cell.at[1].x, cell.at[2].x, cell.at[3].x});
  cell.right = std::max({cell.at[0].x, cell.at[1].x, cell.at[2].x, cell.at[3].x});
  return true;
}

/// Weights of a quadratic B-spline on the texels around `at`, the first of which is returned.
int spline(float at, float weights[3]) {
  const float nearest = std::floor(at + 0.5f), t = at - nearest;
  weights[0] = 0.5f * (0.5f - t) * (0.5f - t);
  weights[1] = 0.75f - t * t;
  weights[2] = 0.5f * (0.5f + t) * (0.5f + t);
  return static_cast<int>(nearest) - 1;
}

int samples(vec2 p, vec2 q, vec2 r, vec2 s) {
  const vec2 u = glm::abs(q - p), v = glm::abs(s - r);
  return std::clamp(static_cast<int>(std::ceil(std::max({u.x, u.y, v.x, v.y}) / kApart)), 1, kMostSamples);
}

void add(const Cell& cell, float area, vec2 low, vec2 high, int top, int bottom, Image<float>& map) {
  const int across = samples(cell.at[0], cell.at[1], cell.at[2], cell.at[3]);
  const int along = samples(cell.at[0], cell.at[2], cell.at[1], cell.at[3]);
  const float share = area / static_cast<float>(across * along);
  const float first = static_cast<float>(top) - 1.51f, last = static_cast<float>(bottom) + 0.51f;
  const float per_across = 1.0f / static_cast<float>(across), per_along = 1.0f / static_cast<float>(along);
  for (int y = 0; y < along; ++y) {
    const float t = (static_cast<float>(y) + 0.5f) * per_along;
    const vec2 left = cell.at[0] + t * (cell.at[2] - cell.at[0]), right = cell.at[1] + t * (cell.at[3] - cell.at[1]);
    const float flux_left = share * (cell.flux[0] + t * (cell.flux[2] - cell.flux[0]));
    const float flux_right = share * (cell.flux[1] + t * (cell.flux[3] - cell.flux[1]));
    for (int x = 0; x < across; ++x) {
      const float s = (static_cast<float>(x) + 0.5f) * per_across;
      const vec2 at = left + s * (right - left);
      if (!(at.x >= low.x && at.y >= low.y && at.x <= high.x && at.y <= high.y)) continue;
      if (at.y < first || at.y > last) continue;
      const float flux = flux_left + s * (flux_right - flux_left);
      float wx[3], wy[3];
      const int i = spline(at.x, wx), j = spline(at.y, wy);
      const bool inside = i >= 0 && i + 2 < map.width();
      for (int b = 0; b < 3; ++b) {
        if (j + b < top || j + b >= bottom) continue;
        const float w = flux * wy[b];
        float* row = map.row(j + b);
        if (inside) {
          row[i] += w * wx[0];
          row[i + 1] += w * wx[1];
          row[i + 2] += w * wx[2];
        } else {
          for (int a = 0; a < 3; ++a)
            if (i + a >= 0 && i + a < map.width()) row[i + a] += w * wx[a];
        }
      }
    }
  }
}

}  // namespace

void gather_cells(const Image<LightPoint>& points, float cell_area, vec2 low, vec2 high, Image<float>& map) {
  if (points.width() < 2 || points.height() < 2 || map.empty()) return;
  const vec2 edge{static_cast<float>(map.width()) + 1.0f, static_cast<float>(map.height()) + 1.0f};
  low = glm::max(low, vec2{-2.0f});
  high = glm::min(high, edge);
  // Which cells reach which band of the map, in the cells' order: the same sums for any number of threads.
  const std::size_t rows = static_cast<std::size_t>(points.height() - 1);
  const std::size_t lists = (rows + kListRows - 1) / kListRows;
  const std::size_t bands = static_cast<std::size_t>((map.height() + kBandRows - 1) / kBandRows);
  std::vector<std::vector<Place>> reaching(lists * bands);
  parallel_for(lists, 1, [&](std::size_t begin, std::size_t end) {
    Cell cell;
    for (std::size_t list = begin; list < end; ++list)
      for (std::size_t r = list * kListRows; r < std::min(rows, (list + 1) * kListRows); ++r) {
        const LightPoint *upper = points.row(static_cast<int>(r)), *lower = points.row(static_cast<int>(r) + 1);
        for (int x = 0; x + 1 < points.width(); ++x) {
          if (!cell_of(upper + x, lower + x, cell) || !(cell.left <= high.x && cell.right >= low.x)) continue;
          // A sample counts a row and a half around it.
          const float first = std::max(cell.low - 1.51f, 0.0f), last = std::min(cell.high + 1.51f, edge.y - 1.0f);
          if (!(first <= last)) continue;
          const std::size_t top = static_cast<std::size_t>(first) / kBandRows;
          const std::size_t bottom = std::min(bands - 1, static_cast<std::size_t>(last) / kBandRows);
          for (std::size_t band = top; band <= bottom; ++band)
            reaching[list * bands + band].push_back({x, static_cast<int>(r)});
        }
      }
  });
  parallel_for(bands, 1, [&](std::size_t begin, std::size_t end) {
    Cell cell;
    for (std::size_t band = begin; band < end; ++band) {
      const int top = static_cast<int>(band) * kBandRows, bottom = std::min(top + kBandRows, map.height());
      for (std::size_t list = 0; list < lists; ++list)
        for (const Place place : reaching[list * bands + band]) {
          cell_of(points.row(place.y) + place.x, points.row(place.y + 1) + place.x, cell);
          add(cell, cell_area, low, high, top, bottom, map);
        }
    }
  });
}

}  // namespace meniscus
