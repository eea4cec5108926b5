#include "surface/masses.h"

#include <algorithm>
#include <mutex>

namespace meniscus {
namespace {

constexpr int kSide = BandGrid::kSide, kWide = kSide + 2;

/// The open cells of one block after another, with what lies around them.
class MassBlock {
 public:
  MassBlock(RaycastField& field, const MassRule& rule) : field_(field), rule_(rule) {}

  void find(int block) {
    if (!find_wanted_rows(block)) return;
    find_blocks_around(block);
    take_rows(block);
    make_groups(block);
    exceptions_.clear();
    find_exceptions(field_, rows_, groups_, rule_.full_density, exceptions_);
    for (const MassException& exception : exceptions_) {
      field_.mass[exception.sorted] = mass_at(rule_, exception.density);
      const float radius = entry_radius_at(field_.options, exception.density);
      field_.entry_radius[exception.sorted] = radius;
      widest_ = std::max(widest_, radius);
    }
  }

  /// m, the widest entry radius that has been set.
  float widest() const { return widest_; }

 private:
  /// Rows of cells, -1 .. 8 along y and z, that hold an open cell with particles or are beside such a row.
  bool find_wanted_rows(int block) {
    const BandGrid& grid = field_.grid;
    const BandGrid::Kind* kinds = grid.kinds(block);
    wanted_.fill(0);
    bool any = false;
    for (int z = 0; z < kSide; ++z) {
      unsigned open = 0;
      for (int y = 0; y < kSide; ++y) {
        const int row = (z * kSide + y) * kSide;
        const BandGrid::Run run = grid.run(block, row, row + kSide - 1);
        if (run.begin < run.end && std::find(kinds + row, kinds + row + kSide, BandGrid::open) != kinds + row + kSide)
          open |= 1u << y;
      }
      open_[at(z)] = open;
      any = any || open != 0;
      for (int dz = 0; dz < 3; ++dz) wanted_[at(z + dz)] |= open | open << 1 | open << 2;
    }
    return any;
  }

  void find_blocks_around(int block) {
    const BandGrid& grid = field_.grid;
    const glm::ivec3 here = grid.corner(block) / kSide;
    std::size_t n = 0;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) around_[n++] = grid.find(here.x + x, here.y + y, here.z + z);
  }

  void take_rows(int block) {
    const BandGrid& grid = field_.grid;
    const vec3 middle = grid.low(block) + 0.5f * static_cast<float>(kSide) * grid.cell_size();
    rows_.count = 0;
    const auto side = [](int cell) { return cell < 0 ? 0 : cell < kSide ? 1 : 2; };
    for (int z = -1; z <= kSide; ++z)
      for (int y = -1; y <= kSide; ++y) {
        if ((wanted_[at(z + 1)] >> (y + 1) & 1u) == 0) continue;
        std::uint32_t* start = starts(z, y);
        const int row = ((z & (kSide - 1)) * kSide + (y & (kSide - 1))) * kSide;
        const std::size_t left = at((side(z) * 3 + side(y)) * 3);
        for (int x = -1; x <= kSide; ++x) {
          start[x + 1] = static_cast<std::uint32_t>(rows_.count);
          const int other = around_[left + at(side(x))];
          if (other < 0) continue;
          if (x == 0) {
            const BandGrid::Run all = grid.run(other, row, row + kSide - 1);
            for (int k = 1; k < kSide; ++k)
              start[k + 1] = static_cast<std::uint32_t>(rows_.count + (grid.run(other, row + k).begin - all.begin));
            if (all.begin < all.end) rows_.add(field_, middle, all);
            x = kSide - 1;
            continue;
          }
          const BandGrid::Run run = grid.run(other, row + (x & (kSide - 1)));
          if (run.begin < run.end) rows_.add(field_, middle, run);
        }
        start[kWide] = static_cast<std::uint32_t>(rows_.count);
      }
  }

  void make_groups(int block) {
    const BandGrid::Kind* kinds = field_.grid.kinds(block);
    groups_.clear();
    for (int z = 0; z < kSide; ++z)
      for (int y = 0; y < kSide; ++y) {
        if ((open_[at(z)] >> y & 1u) == 0) continue;
        const BandGrid::Kind* row = kinds + (z * kSide + y) * kSide;
        for (int first = 0; first < kSide; ++first) {
          if (row[first] != BandGrid::open) continue;
          int end = first + 1;
          while (end < kSide && row[end] == BandGrid::open) ++end;
          add_groups(block, z, y, first, end);
          first = end;
        }
      }
  }

  /// Of the cells first .. end - 1 of a row.
  void add_groups(int block, int z, int y, int first, int end) {
    const std::uint32_t* here = starts(z, y) + 1;
    const std::size_t sorted = field_.grid.run(block, (z * kSide + y) * kSide + first).begin;
    for (std::uint32_t from = here[first]; from < here[end]; from += kPacket) {
      MassGroup& group = groups_.emplace_back();
      group.sorted = static_cast<std::uint32_t>(sorted) + (from - here[first]);
      group.first = from;
      group.count = std::min<std::uint32_t>(kPacket, here[end] - from);
      int low = first, high = end - 1;
      while (here[low + 1] <= from) ++low;
      while (here[high] >= from + group.count) --high;
      std::size_t n = 0;
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy) {
          const std::uint32_t* near = starts(z + dz, y + dy) + 1;
          group.begin[n] = near[low - 1];
          group.end[n++] = near[high + 2];
        }
    }
  }

  static std::size_t at(int place) { return static_cast<std::size_t>(place); }
  /// Where in rows_ the particles of the cells -1 .. 9 begin.
  std::uint32_t* starts(int z, int y) { return &starts_[at(((z + 1) * kWide + y + 1) * (kWide + 1))]; }

  RaycastField& field_;
  const MassRule& rule_;
  float widest_ = 0;
  std::array<unsigned, kSide> open_;    ///< by z; bit y: the row holds an open cell
  std::array<unsigned, kWide> wanted_;  ///< by z + 1; bit y + 1
  std::array<int, 27> around_;          ///< blocks, or -1
  std::array<std::uint32_t, std::size_t{kWide} * kWide*(kWide + 1)> starts_;
  MassRows rows_;
  std::vector<MassGroup> groups_;
  std::vector<MassException> exceptions_;
};

}  // namespace

void find_masses(RaycastField& field) {
  constexpr std::size_t kBlocks = 8;
  const MassRule rule = mass_rule(field.options);
  std::mutex held;
  parallel_for(static_cast<std::size_t>(field.grid.blocks()), kBlocks, [&](std::size_t begin, std::size_t end) {
    MassBlock piece(field, rule);
    for (std::size_t block = begin; block < end; ++block) piece.find(static_cast<int>(block));
    const std::lock_guard lock(held);
    field.widest_entry = std::max(field.widest_entry, piece.widest() / field.options.smoothing_length);
  });
}

}  // namespace meniscus
