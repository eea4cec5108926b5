#include "scene/direction_look_up.h"

#include <cstring>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/direction_look_up.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;
/// Three channels and one to spare; not of Highway, whose least instruction set has no four lanes.
using Colour = float __attribute__((vector_size(16)));

HWY_INLINE Colour load(const float* from) {
  Colour colour;
  std::memcpy(&colour, from, sizeof colour);
  return colour;
}
HWY_INLINE void store(Colour colour, float* to) { std::memcpy(to, &colour, sizeof colour); }
HWY_INLINE Colour mixed(Colour a, Colour b, float t) { return a + t * (b - a); }

/// Where directions lie on the unfolded octahedron, [-1, 1]^2. See DirectionMap::at().
HWY_INLINE void unfold(const UpFrame& frame, const BlockVectors& directions, int count, float* out_x, float* out_y) {
  const Tag d;
  const Vec one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); i += hn::Lanes(d)) {
    const Vec a = hn::Load(d, directions[0] + i), b = hn::Load(d, directions[1] + i),
              c = hn::Load(d, directions[2] + i);
    const auto along = [&](vec3 v) HWY_ATTR {
      return hn::MulAdd(a, hn::Set(d, v.x), hn::MulAdd(b, hn::Set(d, v.y), hn::Mul(c, hn::Set(d, v.z))));
    };
    const Vec east = along(frame.east), north = along(frame.north), up = along(frame.up);
    const Vec scale = hn::Div(one, hn::Add(hn::Add(hn::Abs(east), hn::Abs(north)), hn::Abs(up)));
    const Vec x = hn::Mul(east, scale), y = hn::Mul(north, scale);
    const auto signed_one = [&](Vec v) HWY_ATTR { return hn::IfThenElse(hn::Lt(v, zero), hn::Neg(one), one); };
    const Vec folded_x = hn::Mul(hn::Sub(one, hn::Abs(y)), signed_one(x));
    const Vec folded_y = hn::Mul(hn::Sub(one, hn::Abs(x)), signed_one(y));
    const auto under = hn::Lt(up, zero);
    hn::Store(hn::IfThenElse(under, folded_x, x), d, out_x + i);
    hn::Store(hn::IfThenElse(under, folded_y, y), d, out_y + i);
  }
}

/// A table as the look-up takes it.
struct Nodes {
  const float* first = nullptr;
  std::ptrdiff_t row = 0;  ///< floats
};

/// The interpolated value; its last channel means nothing.
HWY_INLINE Colour value_at(const Nodes& nodes, std::int32_t offset, float s, float t) {
  const float* low = nodes.first + offset;
  const float* high = low + nodes.row;
  return mixed(mixed(load(low), load(low + 3), s), mixed(load(high), load(high + 3), s), t);
}

/// Where in a table with this many cells the directions of a block lie.
struct Places {
  alignas(64) std::int32_t offset[BlockVectors::kLanes];  ///< floats from the first node
  alignas(64) float s[BlockVectors::kLanes], t[BlockVectors::kLanes];

  HWY_INLINE void set(std::size_t i, Vec x, Vec y, Vec cells) {
    const Tag d;
    const hn::RebindToSigned<Tag> di;
    const Vec half = hn::Mul(cells, hn::Set(d, 0.5f)), zero = hn::Zero(d), most = hn::Sub(cells, hn::Set(d, 1.0f));
    x = hn::MulAdd(half, x, half);
    y = hn::MulAdd(half, y, half);
    // What is no number becomes the first cell.
    const auto cell = [&](Vec v) HWY_ATTR { return hn::Floor(hn::IfThenElseZero(hn::Gt(v, zero), hn::Min(v, most))); };
    const Vec column = cell(x), row = cell(y);
    hn::Store(hn::Sub(x, column), d, s + i);
    hn::Store(hn::Sub(y, row), d, t + i);
    const Vec node = hn::MulAdd(row, hn::Add(cells, hn::Set(d, 1.0f)), column);
    hn::Store(hn::ConvertTo(di, hn::Mul(node, hn::Set(d, 3.0f))), di, offset + i);
  }
};

}  // namespace

void LookUp(const DirectionLevels& levels, const UpFrame& frame, float scale, const BlockVectors& directions,
            const float* roughness, const std::int32_t* wanted, int count, BlockVectors& result) {
  const Tag d;
  const hn::RebindToSigned<Tag> di;
  const auto end = static_cast<std::size_t>(count);
  alignas(64) float x[BlockVectors::kLanes], y[BlockVectors::kLanes], colours[4 * BlockVectors::kLanes];
  unfold(frame, directions, count, x, y);
  Nodes nodes[DirectionLevels::kBlurred + 1];
  float cells[DirectionLevels::kBlurred + 1];
  for (int k = 0; k <= (roughness ? DirectionLevels::kBlurred : 0); ++k) {
    const DirectionMap& map = *levels.maps[k];
    nodes[k] = {&map.nodes()->x, 3 * static_cast<std::ptrdiff_t>(map.cells() + 1)};
    cells[k] = static_cast<float>(map.cells());
  }

  // The two tables of each lane; one is enough for all where nothing is blurred.
  Places low, high;
  alignas(64) std::int32_t lower[BlockVectors::kLanes];
  alignas(64) float part[BlockVectors::kLanes];
  bool blurred = false;
  for (std::size_t i = 0; i < end; i += hn::Lanes(d)) {
    const Vec here_x = hn::Load(d, x + i), here_y = hn::Load(d, y + i);
    Vec low_cells = hn::Set(d, cells[0]), level = hn::Zero(d);
    if (roughness) {
      constexpr auto kMost = static_cast<float>(DirectionLevels::kBlurred);
      const Vec bounded = hn::Min(hn::Max(hn::Load(d, roughness + i), hn::Zero(d)), hn::Set(d, 1.0f));
      level = hn::Mul(bounded, hn::Set(d, kMost));
      level = hn::IfThenElseZero(hn::Gt(level, hn::Set(d, 1e-3f)), level);
    }
    if (hn::AllTrue(d, hn::Eq(level, hn::Zero(d)))) {
      hn::Store(hn::Zero(di), di, lower + i);
      hn::Store(hn::Zero(d), d, part + i);
    } else {
      blurred = true;
      const Vec whole = hn::Min(hn::Floor(level), hn::Set(d, static_cast<float>(DirectionLevels::kBlurred - 1)));
      Vec high_cells = hn::Set(d, cells[1]);
      for (int k = 1; k < DirectionLevels::kBlurred; ++k) {
        const auto above = hn::Ge(whole, hn::Set(d, static_cast<float>(k)));
        low_cells = hn::IfThenElse(above, hn::Set(d, cells[k]), low_cells);
        high_cells = hn::IfThenElse(above, hn::Set(d, cells[k + 1]), high_cells);
      }
      high.set(i, here_x, here_y, high_cells);
      hn::Store(hn::ConvertTo(di, whole), di, lower + i);
      hn::Store(hn::Sub(level, whole), d, part + i);
    }
    low.set(i, here_x, here_y, low_cells);
  }

  for (int lane = 0; lane < count; ++lane) {
    float* out = colours + 4 * lane;
    if (wanted && wanted[lane] == 0) {
      store(Colour{}, out);
      continue;
    }
    const std::int32_t k = lower[lane];
    const Colour first = value_at(nodes[k], low.offset[lane], low.s[lane], low.t[lane]);
    if (!blurred || part[lane] == 0) {
      store(first, out);
      continue;
    }
    const Colour second = value_at(nodes[k + 1], high.offset[lane], high.s[lane], high.t[lane]);
    store(mixed(first, second, part[lane]), out);
  }
  const Vec factor = hn::Set(d, scale);
  for (std::size_t i = 0; i < end; i += hn::Lanes(d)) {
    Vec r, g, b, spare;
    hn::LoadInterleaved4(d, colours + 4 * i, r, g, b, spare);
    hn::Store(hn::Mul(r, factor), d, result[0] + i);
    hn::Store(hn::Mul(g, factor), d, result[1] + i);
    hn::Store(hn::Mul(b, factor), d, result[2] + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(LookUp);

void look_up(const DirectionLevels& levels, const UpFrame& frame, float scale, const BlockVectors& directions,
             const float* roughness, const std::int32_t* wanted, int count, BlockVectors& result) {
  HWY_DYNAMIC_DISPATCH(LookUp)(levels, frame, scale, directions, roughness, wanted, count, result);
}

}  // namespace meniscus
#endif
