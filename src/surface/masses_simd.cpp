#include "surface/masses.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surface/masses_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "surface/packet_kernels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

/// How far a density summed over CubicSplineSamples::bracket() is off, at most.
constexpr float kDoubt = 0.01f, kSmallDoubt = 0.0015f;

template <class Visit>
HWY_INLINE void for_each_near(const MassGroup& group, Visit visit) {
  for (std::size_t row = 0; row < MassGroup::kRows; ++row)
    for (std::size_t j = group.begin[row]; j < group.end[row]; ++j) visit(j);
}

/// Over W(0), at the particles l .. of a group, by a kernel that is as good as exact.
template <class Samples>
HWY_INLINE Vec bracket_sum(const MassRows& rows, const MassGroup& group, std::size_t l) {
  const Tag d;
  const Vec one = hn::Set(d, 1.0f), zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  const float *x = rows.x.data(), *y = rows.y.data(), *z = rows.z.data(), *fall = rows.fall.data();
  const std::size_t from = group.first + l;
  const Vec px = hn::Mul(half, hn::LoadU(d, x + from)), py = hn::Mul(half, hn::LoadU(d, y + from)),
            pz = hn::Mul(half, hn::LoadU(d, z + from)), most = hn::Add(one, hn::LoadU(d, fall + from));
  // A particle's own part is known.
  Vec sum = hn::Sub(one, Samples::bracket(one, one));
  for_each_near(group, [&](std::size_t j) {
    // 1 - |p - q|^2 / h^2 = 1 - |p|^2 / h^2 - |q|^2 / h^2 + 2 p . q / h^2
    Vec s = hn::Add(most, hn::Set(d, fall[j]));
    s = hn::MulAdd(px, hn::Set(d, x[j]), s);
    s = hn::MulAdd(py, hn::Set(d, y[j]), s);
    s = hn::Max(hn::MulAdd(pz, hn::Set(d, z[j]), s), zero);
    sum = hn::Add(sum, Samples::bracket(s, one));
  });
  return sum;
}

template <class Shape>
HWY_NOINLINE Vec exact_sum(const MassRows& rows, const MassGroup& group, std::size_t l) {
  const Tag d;
  const float *x = rows.x.data(), *y = rows.y.data(), *z = rows.z.data();
  const std::size_t from = group.first + l;
  const Vec px = hn::LoadU(d, x + from), py = hn::LoadU(d, y + from), pz = hn::LoadU(d, z + from);
  const Vec per_h = hn::Set(d, 0.5f);  // lengths are in halves of h
  Vec sum = hn::Zero(d);
  for_each_near(group, [&](std::size_t j) {
    const Vec dx = hn::Sub(px, hn::Set(d, x[j])), dy = hn::Sub(py, hn::Set(d, y[j])),
              dz = hn::Sub(pz, hn::Set(d, z[j]));
    sum = hn::Add(sum, Shape::at(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))), per_h));
  });
  return sum;
}

template <class Samples, class Shape>
HWY_NOINLINE void find_in_groups(const RaycastField& field, const MassRows& rows, std::span<const MassGroup> groups,
                                 float thin, std::vector<MassException>& exceptions) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const Vec scale = hn::Set(d, field.scale), least = hn::Set(d, thin + kDoubt),
            most = hn::Set(d, kPackedDensity - kSmallDoubt), more = hn::Set(d, kSmallDoubt);
  alignas(64) float density[kPacket];
  for (const MassGroup& group : groups)
    for (std::size_t l = 0; l < group.count; l += lanes) {
      Vec sum = hn::Mul(bracket_sum<Samples>(rows, group, l), scale);
      const auto here = hn::FirstN(d, group.count - l);
      if (HWY_LIKELY(hn::AllFalse(d, hn::And(here, hn::Or(hn::Lt(sum, least), hn::Gt(sum, most)))))) continue;
      if (hn::AllFalse(d, hn::And(here, hn::Lt(sum, least))))
        sum = hn::Add(sum, more);
      else
        sum = hn::Mul(exact_sum<Shape>(rows, group, l), scale);
      hn::Store(sum, d, density);
      for (std::size_t k = 0; k < std::min<std::size_t>(lanes, group.count - l); ++k)
        if (density[k] < thin || density[k] > kPackedDensity)
          exceptions.push_back({group.sorted + static_cast<std::uint32_t>(l + k), density[k]});
    }
}

}  // namespace

void AddToRows(const RaycastField& field, vec3 middle, BandGrid::Run sorted, MassRows& rows) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const BandGrid& grid = field.grid;
  const float to_halves = 2.0f / field.options.smoothing_length;
  const Vec scale = hn::Set(d, to_halves), quarter = hn::Set(d, -0.25f);
  const Vec mx = hn::Set(d, middle.x), my = hn::Set(d, middle.y), mz = hn::Set(d, middle.z);
  float *to_x = rows.x.data() + rows.count, *to_y = rows.y.data() + rows.count, *to_z = rows.z.data() + rows.count,
        *to_fall = rows.fall.data() + rows.count;
  for (std::size_t i = sorted.begin, to = 0; i < sorted.end; i += lanes, to += lanes) {
    const Vec x = hn::Mul(hn::Sub(hn::LoadU(d, grid.x() + i), mx), scale),
              y = hn::Mul(hn::Sub(hn::LoadU(d, grid.y() + i), my), scale),
              z = hn::Mul(hn::Sub(hn::LoadU(d, grid.z() + i), mz), scale);
    hn::StoreU(x, d, to_x + to);
    hn::StoreU(y, d, to_y + to);
    hn::StoreU(z, d, to_z + to);
    hn::StoreU(hn::Mul(quarter, hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)))), d, to_fall + to);
  }
  rows.count += sorted.end - sorted.begin;
}

void FindExceptions(const RaycastField& field, const MassRows& rows, std::span<const MassGroup> groups, float thin,
                    std::vector<MassException>& exceptions) {
  switch (field.options.kernel) {
    case Kernel::cubic_spline:
      return find_in_groups<CubicSplineSamples, CubicSplineShape>(field, rows, groups, thin, exceptions);
    case Kernel::poly6:
      return find_in_groups<Poly6Samples, Poly6Shape>(field, rows, groups, thin, exceptions);
    case Kernel::wyvill:
      return find_in_groups<WyvillSamples, WyvillShape>(field, rows, groups, thin, exceptions);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(AddToRows);
HWY_EXPORT(FindExceptions);

void MassRows::add(const RaycastField& field, vec3 middle, BandGrid::Run sorted) {
  const std::size_t wanted = count + (sorted.end - sorted.begin) + 2 * kPacket;
  for (auto axis : {&MassRows::x, &MassRows::y, &MassRows::z, &MassRows::fall}) (this->*axis).reserve(wanted, count);
  HWY_DYNAMIC_DISPATCH(AddToRows)(field, middle, sorted, *this);
}

void find_exceptions(const RaycastField& field, const MassRows& rows, std::span<const MassGroup> groups, float thin,
                     std::vector<MassException>& exceptions) {
  HWY_DYNAMIC_DISPATCH(FindExceptions)(field, rows, groups, thin, exceptions);
}

}  // namespace meniscus
#endif
