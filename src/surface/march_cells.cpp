#include "surface/march_cells.h"

#include <algorithm>
#include <cmath>

#include "surface/packet.h"
#include "surface/sized_field.h"

namespace meniscus {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kLayers = 4;  ///< of cells in one piece of work
/// Above the iso-value by this part of what is left up to one, a corner is well inside.
constexpr float kWellInside = 0.5f;

}  // namespace

MarchCells::MarchCells(const RaycastField& field) {
  if (field.grid.size() == 0) return;
  Bounds box;
  std::size_t particles = 0;
  for_each_level(field, [&](const RaycastField& level) {
    box.add(level.grid.bounds().grown(level.options.smoothing_length + 0.01f * level.options.spacing));
    particles += level.grid.size();
  });
  low_ = box.low;
  size_ = field.least_spacing;
  const double most = 64.0 * static_cast<double>(particles) + (1 << 20);
  const auto cells = [&] {
    double count = 1;
    for (int k = 0; k < 3; ++k) {
      const double along = std::floor(static_cast<double>(box.extent()[k]) / static_cast<double>(size_)) + 1;
      n_[k] = static_cast<int>(std::min(along, 1e9));
      count *= along;
    }
    return count;
  };
  while (cells() > most) size_ *= 2.0f;
  per_size_ = 1.0f / size_;
  kind_.assign(static_cast<std::size_t>(n_[0]) * static_cast<std::size_t>(n_[1]) * static_cast<std::size_t>(n_[2]),
               outside);
  for_each_level(field, [&](const RaycastField& level) { mark_reached(level); });
  if (size_ == field.least_spacing) mark_inside(field);
}

void MarchCells::mark_reached(const RaycastField& field) {
  const BandGrid& grid = field.grid;
  const float reach = field.options.smoothing_length;  // no entry sphere is larger
  const auto cell = [&](float value, int axis) {
    return std::clamp(static_cast<int>((value - low_[axis]) * per_size_), 0, n_[axis] - 1);
  };
  const auto mark = [&](std::size_t begin, std::size_t end, int first, int last) {
    for (std::size_t i = begin; i < end; ++i) {
      const vec3 p = grid.position(i);
      const float r = field.entry_radius[i];
      const int z0 = std::max(cell(p.z - r, 2), first), z1 = std::min(cell(p.z + r, 2), last);
      const int y0 = cell(p.y - r, 1), y1 = cell(p.y + r, 1), x0 = cell(p.x - r, 0), x1 = cell(p.x + r, 0);
      for (int z = z0; z <= z1; ++z)
        for (int y = y0; y <= y1; ++y)
          std::fill_n(kind_.begin() + static_cast<std::ptrdiff_t>(index(x0, y, z)), x1 - x0 + 1,
                      static_cast<std::uint8_t>(unknown));
    }
  };
  for (int block = 0; block < grid.blocks(); ++block) {  // the cells whose particles are left out or have no sphere
    if (grid.all_open(block)) continue;
    for (int i = 0; i < BandGrid::kCells; ++i) {
      if (grid.kinds(block)[i] == BandGrid::open) continue;
      const vec3 low = grid.low(block) + grid.cell_size() * vec3(i % 8, i / 8 % 8, i / 64),
                 high = low + grid.cell_size();
      for (int z = cell(low.z, 2); z <= cell(high.z, 2); ++z)
        for (int y = cell(low.y, 1); y <= cell(high.y, 1); ++y)
          for (int x = cell(low.x, 0); x <= cell(high.x, 0); ++x)
            kind_[index(x, y, z)] = static_cast<std::uint8_t>(unknown);
    }
  }
  parallel_for(static_cast<std::size_t>((n_[2] + kLayers - 1) / kLayers), 1, [&](std::size_t piece, std::size_t) {
    const int first = static_cast<int>(piece) * kLayers, last = std::min(first + kLayers, n_[2]) - 1;
    const Bounds all = grid.bounds();
    const vec3 from{all.low.x, all.low.y, low_.z + static_cast<float>(first) * size_ - reach};
    const vec3 to{all.high.x, all.high.y, low_.z + static_cast<float>(last + 1) * size_ + reach};
    grid.for_each_run(from, to, [&](std::size_t begin, std::size_t end) { mark(begin, end, first, last); });
  });
}

void MarchCells::mark_inside(const RaycastField& field) {
  // Corners well inside; blocks of 4 x 2 x 2 corners are one packet.
  const int mx = n_[0] + 1, my = n_[1] + 1, mz = n_[2] + 1;
  const auto corner = [&](int x, int y, int z) {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(my) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(mx) +
           static_cast<std::size_t>(x);
  };
  std::vector<std::uint8_t> high(static_cast<std::size_t>(mx) * static_cast<std::size_t>(my) *
                                 static_cast<std::size_t>(mz));
  const float enough = field.options.iso + kWellInside * std::max(1.0f - field.options.iso, 0.1f);
  const auto is_reached = [&](int x, int y, int z) {  // any of the eight cells around a corner
    for (int k = 0; k < 8; ++k) {
      const int cx = x - (k & 1), cy = y - (k >> 1 & 1), cz = z - (k >> 2);
      if (cx >= 0 && cy >= 0 && cz >= 0 && cx < n_[0] && cy < n_[1] && cz < n_[2] &&
          kind_[index(cx, cy, cz)] != outside)
        return true;
    }
    return false;
  };
  parallel_for(static_cast<std::size_t>((mz + 1) / 2), 1, [&](std::size_t piece, std::size_t) {
    thread_local PacketList list;
    const int z0 = 2 * static_cast<int>(piece);
    for (int y0 = 0; y0 < my; y0 += 2)
      for (int x0 = 0; x0 < mx; x0 += 4) {
        PacketPoints points;
        PacketMask mask = 0;
        for (int l = 0; l < kPacket; ++l) {
          const int x = x0 + (l & 3), y = y0 + (l >> 2 & 1), z = z0 + (l >> 3);
          if (x < mx && y < my && z < mz && is_reached(x, y, z)) mask |= 1u << l;
          points.x[l] = low_.x + static_cast<float>(x) * size_;
          points.y[l] = low_.y + static_cast<float>(y) * size_;
          points.z[l] = low_.z + static_cast<float>(z) * size_;
        }
        if (mask == 0) continue;
        alignas(64) float density[kPacket];
        density_packet(field, points, mask, false, list, density);
        for (; mask != 0; mask &= mask - 1) {
          const int l = __builtin_ctz(mask);
          high[corner(x0 + (l & 3), y0 + (l >> 2 & 1), z0 + (l >> 3))] = density[l] >= enough;
        }
      }
  });
  parallel_for(static_cast<std::size_t>(n_[2]), 4, [&](std::size_t begin, std::size_t end) {
    for (int z = static_cast<int>(begin); z < static_cast<int>(end); ++z)
      for (int y = 0; y < n_[1]; ++y)
        for (int x = 0; x < n_[0]; ++x) {
          bool all = true;
          for (int k = 0; k < 8 && all; ++k) all = high[corner(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))] != 0;
          if (all) kind_[index(x, y, z)] = inside;
        }
  });
}

MarchCells::Kind MarchCells::at(vec3 point) const {
  const vec3 c = (point - low_) * per_size_;
  if (!(c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < static_cast<float>(n_[0]) && c.y < static_cast<float>(n_[1]) &&
        c.z < static_cast<float>(n_[2])))
    return outside;
  return static_cast<Kind>(kind_[index(static_cast<int>(c.x), static_cast<int>(c.y), static_cast<int>(c.z))]);
}

float MarchCells::leave(const Ray& ray, float t, float limit, Kind kind) const {
  if (kind_.empty()) return kind == outside ? kInfinity : t;

  // The part of the ray within the table.
  float enter = t, exit = limit;
  for (int k = 0; k < 3; ++k) {
    const float low = low_[k], high = low + static_cast<float>(n_[k]) * size_;
    const float o = ray.origin[k], d = ray.direction[k];
    if (std::abs(d) < 1e-12f) {
      if (o < low || o > high) exit = -kInfinity;
      continue;
    }
    const float a = (low - o) / d, b = (high - o) / d;
    enter = std::max(enter, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  if (!(enter < exit)) return kind == outside ? kInfinity : t;
  if (enter > t && kind != outside) return t;

  // From cell to cell.                                                                  [AmanatidesWoo1987]
  int c[3], step[3];
  float next[3], width[3];
  for (int k = 0; k < 3; ++k) {
    const float o = ray.origin[k] - low_[k], d = ray.direction[k];
    c[k] = std::clamp(static_cast<int>((o + enter * d) * per_size_), 0, n_[k] - 1);
    step[k] = d > 0 ? 1 : -1;
    width[k] = std::abs(d) < 1e-12f ? kInfinity : size_ / std::abs(d);
    next[k] = std::abs(d) < 1e-12f ? kInfinity : (static_cast<float>(c[k] + (d > 0)) * size_ - o) / d;
  }
  float here = enter;
  for (;;) {
    if (kind_[index(c[0], c[1], c[2])] != kind) return here;
    const int k = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    here = std::max(here, next[k]);
    if (!(here <= exit)) break;
    next[k] += width[k];
    c[k] += step[k];
    if (c[k] < 0 || c[k] >= n_[k]) break;
  }
  return kind == outside || here > limit ? kInfinity : here;
}

}  // namespace meniscus
