// Rays through the body of water of a height field, one after another.
#include <algorithm>
#include <cmath>

#include "surface/height_field_body.h"

namespace meniscus {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kFirstLevel = 3;  ///< of the pyramid, where a ray begins: water is mostly met soon

/// c + b s + a s^2.
struct Quadratic {
  double a, b, c;
  Quadratic operator-() const { return {-a, -b, -c}; }

  /// The first s >= 0 where the value is negative, or not positive where it begins there; infinity: nowhere.
  double first_negative(bool or_zero) const {
    if (c < 0 || (c == 0 && (or_zero || b < 0 || (b == 0 && a < 0)))) return 0;
    if (c == 0) return b > 0 && a < 0 ? -b / a : kInfinity;
    const double discriminant = b * b - 4 * a * c;
    if (!(discriminant >= 0)) return kInfinity;
    const double root = std::sqrt(discriminant);
    if (b < 0) return 2 * c / (root - b);
    return a < 0 ? -(b + root) / (2 * a) : kInfinity;
  }
};

/// Stretches of [0, end] where a quadratic is not positive: at most two.
struct Stretches {
  double from[2], to[2];
  int count = 0;
  void add(double a, double b, double end) {
    a = std::max(a, 0.0);
    b = std::min(b, end);
    if (!(a < b)) return;
    from[count] = a;
    to[count++] = b;
  }
};

Stretches not_positive(const Quadratic& q, double end) {
  Stretches found;
  const double discriminant = q.b * q.b - 4 * q.a * q.c;
  if (q.a == 0 && q.b == 0 ? q.c <= 0 : !(discriminant > 0) && q.a <= 0 && q.c <= 0) {
    found.add(0, kInfinity, end);
  } else if (q.a == 0) {
    if (q.b > 0) found.add(0, -q.c / q.b, end);
    if (q.b < 0) found.add(-q.c / q.b, kInfinity, end);
  } else if (discriminant > 0) {
    // Of the two forms of a root the one without cancellation.
    const double sum = -0.5 * (q.b + std::copysign(std::sqrt(discriminant), q.b));
    const auto [low, high] = std::minmax({sum / q.a, q.c / sum});
    if (q.a > 0) {
      found.add(low, high, end);
    } else {
      found.add(0, low, end);
      found.add(high, kInfinity, end);
    }
  }
  return found;
}

int cell_of(double place, int first, int last) {
  return place > first ? std::min(static_cast<int>(std::min(place, 2e9)), last) : first;
}

}  // namespace

/// A cell as a ray meets it: s runs from the place where it was asked for.
struct HeightFieldBody::Cell {
  Quadratic above;    ///< height of the ray over the patch: in the water where not positive
  Quadratic outside;  ///< how much more than half of the place is hole
  Kind kind;
};

FieldRay HeightFieldBody::field_ray(const Ray& ray) const {
  const auto of = [](float value) { return static_cast<double>(value); };
  return {(of(ray.origin[frame_.a]) - frame_.low_a) * frame_.per_a,
          (of(ray.origin[frame_.b]) - frame_.low_b) * frame_.per_b,
          of(ray.origin[frame_.up]),
          of(ray.direction[frame_.a]) * frame_.per_a,
          of(ray.direction[frame_.b]) * frame_.per_b,
          of(ray.direction[frame_.up])};
}

FieldStretch HeightFieldBody::clipped(const FieldRay& ray, double from, double limit) const {
  FieldStretch stretch{from, limit, Face::start, Face::none};
  if (empty()) return {};
  const auto clip = [&](double origin, double along, double low, double high, Face at_low, Face at_high) {
    if (along == 0) {
      if (origin < low || origin > high) stretch.end = -kInfinity;
      return;
    }
    const double to_low = (low - origin) / along, to_high = (high - origin) / along;
    const double in = std::min(to_low, to_high), out = std::max(to_low, to_high);
    if (in > stretch.begin) stretch.begin = in, stretch.first = along > 0 ? at_low : at_high;
    if (out < stretch.end) stretch.end = out, stretch.last = along > 0 ? at_high : at_low;
  };
  clip(ray.a, ray.da, 0, cells_a_, Face::side_a, Face::side_a);
  clip(ray.b, ray.db, 0, cells_b_, Face::side_b, Face::side_b);
  clip(ray.z, ray.dz, static_cast<double>(floor_), static_cast<double>(top_), Face::floor, Face::top);
  return stretch;
}

HeightFieldBody::Cell HeightFieldBody::cell(const FieldRay& ray, int i, int j, double t) const {
  const auto width = static_cast<std::size_t>(cells_a_) + 1;
  const std::size_t p = static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i);
  const double u = ray.a + t * ray.da - i, v = ray.b + t * ray.db - j;
  // Bilinear in u and v, which are linear in s.
  const auto along = [&](double c00, double c10, double c01, double c11) {
    const double by_u = c10 - c00, by_v = c01 - c00, by_uv = c11 - c10 - c01 + c00;
    return Quadratic{by_uv * ray.da * ray.db, by_u * ray.da + by_v * ray.db + by_uv * (u * ray.db + v * ray.da),
                     c00 + by_u * u + by_v * v + by_uv * u * v};
  };
  const auto height = [&](std::size_t q) { return static_cast<double>(heights_[q]); };
  Cell cell{{0, 0, 1}, {0, 0, -1}, kinds_[cell_index(i, j)]};
  if (cell.kind == dry) return cell;
  const Quadratic patch = along(height(p), height(p + 1), height(p + width), height(p + width + 1));
  cell.above = {-patch.a, ray.dz - patch.b, ray.z + t * ray.dz - patch.c};
  if (cell.kind == cut) {
    const auto hole = [&](std::size_t q) { return water_[q] ? -0.5 : 0.5; };
    cell.outside = along(hole(p), hole(p + 1), hole(p + width), hole(p + width + 1));
  }
  return cell;
}

/// Goes through the blocks that a ray meets: policy.skip(block, least z, greatest z, from, to) tells whether the block
/// is done with as a whole, policy.visit(i, j, from, to) looks at one cell and tells whether to go on.
template <class Policy>
void HeightFieldBody::traverse(const FieldRay& ray, double t, double end, Policy& policy) const {
  const int top_level = static_cast<int>(levels_.size()) - 1;
  int i = cell_of(ray.a + t * ray.da, 0, cells_a_ - 1), j = cell_of(ray.b + t * ray.db, 0, cells_b_ - 1);
  const double per_da = 1.0 / ray.da, per_db = 1.0 / ray.db;
  for (int level = std::min(kFirstLevel, top_level);;) {
    const Level& of = levels_[static_cast<std::size_t>(level)];
    const int a0 = i >> level << level, b0 = j >> level << level;
    const int a1 = std::min(a0 + (1 << level), cells_a_), b1 = std::min(b0 + (1 << level), cells_b_);
    const double to_a = ray.da > 0 ? (a1 - ray.a) * per_da : ray.da < 0 ? (a0 - ray.a) * per_da : kInfinity;
    const double to_b = ray.db > 0 ? (b1 - ray.b) * per_db : ray.db < 0 ? (b0 - ray.b) * per_db : kInfinity;
    const double to = std::max(t, std::min({to_a, to_b, end}));
    const double z0 = ray.z + t * ray.dz, z1 = ray.z + to * ray.dz;
    const Block& block = of.blocks[static_cast<std::size_t>(j >> level) * static_cast<std::size_t>(of.width) +
                                   static_cast<std::size_t>(i >> level)];
    const bool skipped = policy.skip(block, std::min(z0, z1), std::max(z0, z1), t, to);
    if (!skipped && level > 0) {
      --level;
      continue;
    }
    if (!skipped && !policy.visit(i, j, t, to)) return;
    if (!(to < end)) return;
    // Across the nearer side into the next cell: counted, not computed, so that no cell is left out or met twice.
    const int last_i = i, last_j = j;
    if (to_a <= to_b) {
      i = ray.da > 0 ? a1 : a0 - 1;
      j = cell_of(ray.b + to * ray.db, b0, b1 - 1);
    } else {
      j = ray.db > 0 ? b1 : b0 - 1;
      i = cell_of(ray.a + to * ray.da, a0, a1 - 1);
    }
    if (i < 0 || j < 0 || i >= cells_a_ || j >= cells_b_) return;
    t = to;
    // Larger blocks only where one is left: within one that could not be skipped there is something near.
    if (skipped && level < top_level && ((i ^ last_i) | (j ^ last_j)) >> (level + 1) != 0) ++level;
  }
}

bool HeightFieldBody::inside(const FieldRay& ray, double t) const {
  const FieldStretch at = clipped(ray, t, t);
  if (!at.found()) return false;
  const Cell here =
      cell(ray, cell_of(ray.a + t * ray.da, 0, cells_a_ - 1), cell_of(ray.b + t * ray.db, 0, cells_b_ - 1), t);
  return here.above.c <= 0 && here.outside.c <= 0;
}

FieldChange HeightFieldBody::first(const FieldRay& ray, double t, double end, bool inside) const {
  struct Policy {
    const HeightFieldBody& body;
    const FieldRay& ray;
    double begin;
    bool inside;
    FieldChange found{};

    bool skip(const Block& block, double low, double high, double, double) const {
      return inside ? low > static_cast<double>(block.high) : high < static_cast<double>(block.low);
    }
    bool visit(int i, int j, double from, double to) {
      const Cell cell = body.cell(ray, i, j, from);
      if (inside) {
        if (cell.kind == dry) return true;
        if (cell.kind == full) {
          const double into = cell.above.first_negative(true);
          return into < to - from ? finish(from, into, 0) : true;
        }
        const Stretches wet = not_positive(cell.above, to - from), in = not_positive(cell.outside, to - from);
        for (int k = 0; k < wet.count; ++k)
          for (int l = 0; l < in.count; ++l)
            if (std::max(wet.from[k], in.from[l]) < std::min(wet.to[k], in.to[l]))
              return finish(from, std::max(wet.from[k], in.from[l]),
                            wet.from[k] >= in.from[l] ? cell.above.c : -kInfinity);
        return true;
      }
      if (cell.kind == dry) return finish(from, 0, -kInfinity);
      const double over = (-cell.above).first_negative(false);
      const double beside = cell.kind == cut ? (-cell.outside).first_negative(false) : kInfinity;
      if (std::min(over, beside) >= to - from) return true;
      return finish(from, std::min(over, beside), over <= beside ? 0 : -kInfinity);
    }
    bool finish(double from, double s, double top) {
      found = {from + s, top > -kInfinity ? Face::top : Face::hole};
      if (found.t <= begin) found.face = Face::start;
      return false;
    }
  };
  Policy policy{*this, ray, t, inside};
  if (!empty() && t <= end) traverse(ray, t, end, policy);
  return policy.found;
}

double HeightFieldBody::length(const FieldRay& ray, double t, double end) const {
  struct Policy {
    const HeightFieldBody& body;
    const FieldRay& ray;
    double sum = 0;

    bool skip(const Block& block, double low, double high, double from, double to) {
      if (low > static_cast<double>(block.high)) return true;
      if (!(high < static_cast<double>(block.low))) return false;
      sum += to - from;
      return true;
    }
    bool visit(int i, int j, double from, double to) {
      const Cell cell = body.cell(ray, i, j, from);
      if (cell.kind == dry) return true;
      const Stretches wet = not_positive(cell.above, to - from);
      if (cell.kind == full) {
        for (int k = 0; k < wet.count; ++k) sum += wet.to[k] - wet.from[k];
        return true;
      }
      const Stretches in = not_positive(cell.outside, to - from);
      for (int k = 0; k < wet.count; ++k)
        for (int l = 0; l < in.count; ++l)
          sum += std::max(0.0, std::min(wet.to[k], in.to[l]) - std::max(wet.from[k], in.from[l]));
      return true;
    }
  };
  Policy policy{*this, ray};
  if (empty() || !(t <= end)) return 0;
  // What lies deeper than the lowest place of the surface is water without looking.
  const double lowest = static_cast<double>(levels_.back().blocks[0].low);
  double deep_from = end, deep_to = end;
  if (ray.z + end * ray.dz < lowest && ray.dz < 0) deep_from = std::max(t, (lowest - ray.z) / ray.dz);
  if (ray.z + t * ray.dz < lowest) {
    deep_from = t;
    if (ray.dz > 0) deep_to = std::min(end, (lowest - ray.z) / ray.dz);
  }
  deep_from = std::min(deep_from, end);
  if (t < deep_from) traverse(ray, t, deep_from, policy);
  if (deep_to < end) traverse(ray, deep_to, end, policy);
  return policy.sum + (deep_to - deep_from);
}

}  // namespace meniscus
