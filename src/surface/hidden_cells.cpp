#include "surface/hidden_cells.h"

namespace meniscus {
namespace {

/// Of the particles that a cell inside the water holds, the share that counts as well filled.
constexpr float kWellFilled = 0.4f;

/// out(i) = whether `flags` hold at i - 1, i and i + 1 along one axis; cells at the border of the grid do not.
void erode(std::vector<std::uint8_t>& flags, std::size_t count, std::size_t stride, std::size_t length) {
  parallel_for(count / length, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t line = begin; line < end; ++line) {
      // Lines along an axis of this stride start at the cells whose coordinate along it is zero.
      const std::size_t first = line / stride * stride * length + line % stride;
      std::uint8_t before = 0, here = flags[first];
      for (std::size_t i = 0; i < length; ++i) {
        const std::size_t at = first + i * stride;
        const std::uint8_t after = i + 1 < length ? flags[at + stride] : std::uint8_t{0};
        flags[at] = before & here & after;
        before = here;
        here = after;
      }
    }
  });
}

/// Keeps the flags of cells whose 26 neighbours are flagged, too.
void erode_by_one(const ParticleGrid& grid, std::vector<std::uint8_t>& flags) {
  const auto nx = static_cast<std::size_t>(grid.cells_x()), ny = static_cast<std::size_t>(grid.cells_y()),
             nz = static_cast<std::size_t>(grid.cells_z());
  erode(flags, flags.size(), 1, nx);
  erode(flags, flags.size(), nx, ny);
  erode(flags, flags.size(), nx * ny, nz);
}

}  // namespace

void SphereSet::add(vec3 centre, float r) {
  x.push_back(centre.x);
  y.push_back(centre.y);
  z.push_back(centre.z);
  radius.push_back(r);
}

void find_hidden_cells(RaycastField& field) {
  const ParticleGrid& grid = field.grid;
  field.hidden.clear();
  if (grid.size() == 0 || !grid.dense()) return;
  const float cell_in_spacings = grid.cell_size() / field.options.spacing;
  const auto well_filled =
      static_cast<std::size_t>(std::max(1.0f, kWellFilled * cell_in_spacings * cell_in_spacings * cell_in_spacings));
  const std::size_t cells = grid.cell_count();
  const auto nz = static_cast<std::size_t>(grid.cells_z());
  field.hidden.assign(cells, 0);
  parallel_for(nz, 1, [&](std::size_t cz, std::size_t) {
    for (int cy = 0; cy < grid.cells_y(); ++cy)
      for (int cx = 0; cx < grid.cells_x(); ++cx) {
        const ParticleGrid::Run run = grid.run(cx, cx, cy, static_cast<int>(cz));
        field.hidden[grid.cell_index(cx, cy, static_cast<int>(cz))] = run.end - run.begin >= well_filled;
      }
  });
  erode_by_one(grid, field.hidden);
}

SphereSet entry_spheres(const RaycastField& field) {
  const ParticleGrid& grid = field.grid;
  SphereSet spheres;
  if (grid.size() == 0) return spheres;
  if (field.hidden.empty()) {
    spheres.x.assign(grid.x(), grid.x() + grid.size());
    spheres.y.assign(grid.y(), grid.y() + grid.size());
    spheres.z.assign(grid.z(), grid.z() + grid.size());
    spheres.radius = field.entry_radius;
    return spheres;
  }
  // A hidden cell's sphere holds the cell alone: the spheres of particles that are left out reach no farther than
  // into the hidden cells around theirs, because no radius is larger than a cell.
  const float cell = grid.cell_size();
  const float around_cell = 0.5f * std::sqrt(3.0f) * cell;
  std::vector<std::uint8_t> midst(field.hidden);
  erode_by_one(grid, midst);
  std::vector<SphereSet> layers(static_cast<std::size_t>(grid.cells_z()));
  parallel_for(layers.size(), 1, [&](std::size_t layer, std::size_t) {
    const int z = static_cast<int>(layer);
    SphereSet& mine = layers[layer];
    for (int y = 0; y < grid.cells_y(); ++y)
      for (int x = 0; x < grid.cells_x(); ++x) {
        const std::size_t at = grid.cell_index(x, y, z);
        if (midst[at]) continue;
        const ParticleGrid::Run run = grid.run(x, x, y, z);
        for (std::size_t i = run.begin; i < run.end; ++i) mine.add(grid.position(i), field.entry_radius[i]);
        if (field.hidden[at]) mine.add(grid.bounds().low + cell * (vec3{x, y, z} + vec3{0.5f}), around_cell);
      }
  });
  std::size_t total = 0;
  for (const SphereSet& layer : layers) total += layer.size();
  for (auto member : {&SphereSet::x, &SphereSet::y, &SphereSet::z, &SphereSet::radius}) {
    (spheres.*member).reserve(total);
    for (const SphereSet& layer : layers)
      (spheres.*member).insert((spheres.*member).end(), (layer.*member).begin(), (layer.*member).end());
  }
  return spheres;
}

}  // namespace meniscus
