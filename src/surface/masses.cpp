#include "surface/masses.h"

namespace meniscus {
namespace {

/// Particles that are looked at together lie in so many cells along each axis.
constexpr int kTogether = 2;

class MassBlock {
 public:
  MassBlock(RaycastField& field, const MassRule& rule) : field_(field), rule_(rule) {}

  void find(int block) {
    const BandGrid& grid = field_.grid;
    const BandGrid::Run all = grid.run(block);
    if (all.begin == all.end) return;
    for (int z = 0; z < BandGrid::kSide; z += kTogether)
      for (int y = 0; y < BandGrid::kSide; y += kTogether)
        for (int x = 0; x < BandGrid::kSide; x += kTogether) find_cells(block, x, y, z);
  }

 private:
  /// The particles of a few cells.
  void find_cells(int block, int x, int y, int z) {
    const BandGrid& grid = field_.grid;
    const BandGrid::Kind* kinds = grid.kinds(block);
    for (int dz = 0; dz < kTogether; ++dz)
      for (int dy = 0; dy < kTogether; ++dy)
        for (int dx = 0; dx < kTogether; ++dx) {
          const int cell = ((z + dz) * BandGrid::kSide + y + dy) * BandGrid::kSide + x + dx;
          if (kinds[cell] != BandGrid::open) continue;
          const BandGrid::Run run = grid.run(block, cell);
          for (std::size_t i = run.begin; i < run.end; ++i) add(i);
        }
    flush();
  }

  void add(std::size_t i) {
    if (points_.count == MassPoints::kMost) flush();
    points_.index[points_.count] = static_cast<std::uint32_t>(i);
    points_.x[points_.count] = field_.grid.x()[i];
    points_.y[points_.count] = field_.grid.y()[i];
    points_.z[points_.count] = field_.grid.z()[i];
    ++points_.count;
  }

  void flush() {
    if (points_.count == 0) return;
    for (std::size_t i = points_.count; i % kPacket != 0; ++i) {  // lanes that are not looked at
      points_.x[i] = points_.x[0];
      points_.y[i] = points_.y[0];
      points_.z[i] = points_.z[0];
    }
    unit_densities(field_, points_, list_, density_);
    for (std::size_t i = 0; i < points_.count; ++i) {
      field_.mass[points_.index[i]] = mass_at(rule_, density_[i]);
      field_.entry_radius[points_.index[i]] = entry_radius_at(field_.options, density_[i]);
    }
    points_.count = 0;
  }

  RaycastField& field_;
  const MassRule& rule_;
  MassPoints points_;
  PacketList list_;
  alignas(64) float density_[MassPoints::kMost];
};

}  // namespace

void find_masses(RaycastField& field) {
  constexpr std::size_t kBlocks = 8;
  const MassRule rule = mass_rule(field.options);
  parallel_for(static_cast<std::size_t>(field.grid.blocks()), kBlocks, [&](std::size_t begin, std::size_t end) {
    MassBlock piece(field, rule);
    for (std::size_t block = begin; block < end; ++block) piece.find(static_cast<int>(block));
  });
}

}  // namespace meniscus
