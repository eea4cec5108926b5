// Density on a regular grid by metaball discs, four planes at a time [Iwasaki2008] 4.1, 4.2.
#include "surface/density.h"

#include <fmt/format.h>

#include "surface/density_tile.h"
#include "surface/masses.h"
#include "surface/packet.h"

namespace meniscus {
namespace {

constexpr int kPlanes = 4;
constexpr int kStripRows = 32;  ///< of a slab, splatted by one thread while they stay in its nearest caches

void check(const DensityGrid& grid) {
  if (grid.nx < 2 || grid.ny < 2 || grid.nz < 2)
    throw Error(ErrorCode::invalid_argument, ErrorDetail{"a grid of density has too few points",
                                                         "2 or more along each axis",
                                                         fmt::format("{} x {} x {}", grid.nx, grid.ny, grid.nz),
                                                         {},
                                                         {},
                                                         {},
                                                         {}});
  for (int axis = 0; axis < 3; ++axis)
    if (!(grid.step[axis] > 0) || !std::isfinite(grid.step[axis]) || !std::isfinite(grid.low[axis]))
      throw Error(ErrorCode::invalid_argument,
                  ErrorDetail{"a grid of density has no proper place",
                              "finite coordinates and steps of more than 0 m",
                              fmt::format("from {} by {} m", grid.low[axis], grid.step[axis]),
                              {},
                              {},
                              {},
                              {}});
  if (static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.ny) > std::size_t{1} << 31)
    throw Error(ErrorCode::limit_exceeded, ErrorDetail{"a plane of the grid has too many points",
                                                       "2^31 points at most",
                                                       fmt::format("{} x {}", grid.nx, grid.ny),
                                                       {},
                                                       {},
                                                       {},
                                                       "take a larger step"});
}

float place(float low, float step, int i) {
  return static_cast<float>(static_cast<double>(low) + static_cast<double>(step) * i);
}

std::size_t bytes_of(const RaycastField& field) {
  // the grid; mass and entry radius of each particle
  return field.grid.memory_bytes() + field.grid.size() * 2 * sizeof(float);
}

}  // namespace

RaycastField make_density_field(const Particles& particles, const DensityOptions& options, bool cull,
                                std::span<const vec3> colours, StageTimes* times) {
  RaycastOptions as_raycast;
  as_raycast.spacing = options.spacing;
  as_raycast.smoothing_length = options.smoothing_length;
  as_raycast.kernel = options.kernel;
  as_raycast.iso = options.iso;
  as_raycast.keep_thin = options.keep_thin;
  RaycastField field = [&] {
    StageTimer timer(times, "sort");
    return make_field(particles, as_raycast, colours, cull ? Keep::all_kinds : Keep::all);
  }();
  StageTimer timer(times, "masses");
  if (options.keep_thin) find_masses(field);
  return field;
}

void splat_density(const Particles& particles, const DensityOptions& options, const DensityGrid& grid,
                   FunctionRef<void(int k, int planes, std::span<const float> values)> on_slab, StageTimes* times,
                   std::size_t* working_bytes) {
  check(grid);
  // The clusters of 4.2 are the layers of cells: a run of the sorted particles for every slab.
  const RaycastField field = make_density_field(particles, options, true, {}, times);
  const auto row = static_cast<std::size_t>(grid.nx), plane = row * static_cast<std::size_t>(grid.ny);
  std::vector<float> slab(plane * static_cast<std::size_t>(std::min(kPlanes, grid.nz)));
  if (working_bytes)
    *working_bytes = slab.size() * sizeof(float) + bytes_of(field) +
                     static_cast<std::size_t>(thread_count()) * DensityTile::pitch_of(grid.nx) * kStripRows * kPlanes *
                         sizeof(float);
  for (int k = 0; k < grid.nz; k += kPlanes) {
    const int planes = std::min(kPlanes, grid.nz - k);
    {
      StageTimer timer(times, "splat density");
      parallel_for(static_cast<std::size_t>(grid.ny), kStripRows, [&](std::size_t begin, std::size_t end) {
        thread_local AlignedFloats scratch;
        const std::size_t rows = end - begin;
        DensityTile strip;
        strip.low = {grid.low.x, place(grid.low.y, grid.step.y, static_cast<int>(begin)),
                     place(grid.low.z, grid.step.z, k)};
        strip.step = grid.step;
        strip.nx = grid.nx;
        strip.ny = static_cast<int>(end - begin);
        strip.nz = planes;
        strip.row_pitch = DensityTile::pitch_of(grid.nx);
        strip.plane_pitch = strip.row_pitch * rows;
        scratch.reserve(strip.plane_pitch * static_cast<std::size_t>(planes), 0);
        strip.values = scratch.data();
        splat_into_tile(field, strip);
        for (std::size_t p = 0; p < static_cast<std::size_t>(planes); ++p)
          for (std::size_t j = 0; j < rows; ++j)
            std::copy_n(scratch.data() + p * strip.plane_pitch + j * strip.row_pitch, row,
                        slab.data() + p * plane + (begin + j) * row);
      });
    }
    on_slab(k, planes, {slab.data(), plane * static_cast<std::size_t>(planes)});
  }
}

std::vector<float> splat_density(const Particles& particles, const DensityOptions& options, const DensityGrid& grid,
                                 StageTimes* times) {
  check(grid);
  std::vector<float> whole(grid.size());
  const auto plane = static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.ny);
  splat_density(
      particles, options, grid,
      [&](int k, int, std::span<const float> values) {
        std::copy(values.begin(), values.end(),
                  whole.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(k) * plane));
      },
      times);
  return whole;
}

}  // namespace meniscus
