#include "shading/water_block.h"

#include <algorithm>
#include <limits>
#include <numbers>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/water_block_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace meniscus {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = HWY_CAPPED(float, 16);
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

// As in shading/sample.cpp.
constexpr float kPerPi = 1.0f / std::numbers::pi_v<float>;
constexpr float kLeastCosine = 0.02f;
constexpr float kBackFromDeep = 0.9f, kBackFromThin = 0.3f;
constexpr float kLeastGlareVariance = 1.2e-4f;
constexpr float kBrightestGlare = 24.0f;
constexpr float kLargestVariance = 0.25f;

HWY_INLINE Vec all(float value) { return hn::Set(Tag(), value); }
HWY_INLINE Vec load(const float* from) { return hn::Load(Tag(), from); }
HWY_INLINE void store(Vec v, float* to) { hn::Store(v, Tag(), to); }
HWY_INLINE Vec mixed(Vec a, Vec b, Vec t) { return hn::MulAdd(t, hn::Sub(b, a), a); }
HWY_INLINE Vec smoothstep(float low, float high, Vec v) {
  const Vec t = hn::Min(hn::Max(hn::Mul(hn::Sub(v, all(low)), all(1.0f / (high - low))), all(0.0f)), all(1.0f));
  return hn::Mul(hn::Mul(t, t), hn::NegMulAdd(all(2.0f), t, all(3.0f)));
}

/// One vector of vectors.
struct Triple {
  Vec x, y, z;
};
HWY_INLINE Triple load(const BlockVectors& from, std::size_t i) {
  return {load(from[0] + i), load(from[1] + i), load(from[2] + i)};
}
HWY_INLINE void store(const Triple& v, BlockVectors& to, std::size_t i) {
  store(v.x, to[0] + i);
  store(v.y, to[1] + i);
  store(v.z, to[2] + i);
}
HWY_INLINE Vec dot(const Triple& a, const Triple& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE Triple all(vec3 v) { return {all(v.x), all(v.y), all(v.z)}; }
HWY_INLINE Triple times(const Triple& a, Vec s) { return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)}; }
/// a + s b
HWY_INLINE Triple plus(const Triple& a, Vec s, const Triple& b) {
  return {hn::MulAdd(s, b.x, a.x), hn::MulAdd(s, b.y, a.y), hn::MulAdd(s, b.z, a.z)};
}
HWY_INLINE Triple minus(const Triple& a, const Triple& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Triple chosen(Mask m, const Triple& yes, const Triple& no) {
  return {hn::IfThenElse(m, yes.x, no.x), hn::IfThenElse(m, yes.y, no.y), hn::IfThenElse(m, yes.z, no.z)};
}
HWY_INLINE Triple unit(const Triple& v) { return times(v, hn::Div(all(1.0f), hn::Sqrt(dot(v, v)))); }

/// See facing().
HWY_INLINE Triple faced(Triple normal, const Triple& direction) {
  const Vec length = dot(normal, normal), least = all(kLeastCosine);
  const Mask sound = hn::And(hn::Gt(length, all(1e-12f)), hn::Lt(length, all(1e12f)));
  normal = times(normal, hn::Div(all(1.0f), hn::Sqrt(length)));
  const Vec along = dot(normal, direction);
  const Mask towards = hn::Le(along, hn::Neg(least));
  const Triple backwards{hn::Neg(direction.x), hn::Neg(direction.y), hn::Neg(direction.z)};
  if (!hn::AllTrue(Tag(), hn::And(sound, towards))) {
    const Triple tangential = plus(normal, hn::Neg(along), direction);
    const Vec rest = dot(tangential, tangential);
    const Vec scale = hn::Sqrt(hn::Div(all(1.0f - kLeastCosine * kLeastCosine), rest));
    const Triple turned = plus(times(tangential, scale), least, backwards);
    normal = chosen(towards, normal, chosen(hn::Gt(rest, all(1e-8f)), turned, backwards));
    normal = chosen(sound, normal, backwards);
  }
  return normal;
}

/// See interface_of().
HWY_INLINE void interface(const BlockOptics& optics, Vec cos_i, Vec& reflectance, Vec& cos_t) {
  const float eta = optics.material.ior;
  const Vec one = all(1.0f), e = all(eta), c = hn::Min(hn::Max(cos_i, all(0.0f)), one);
  cos_t = hn::Sqrt(hn::NegMulAdd(hn::NegMulAdd(c, c, one), all(1.0f / (eta * eta)), one));
  if (optics.fresnel == FresnelFormula::exact) {
    const Vec et = hn::Mul(e, cos_t), ec = hn::Mul(e, c);
    const Vec s = hn::Div(hn::Sub(c, et), hn::Add(c, et)), p = hn::Div(hn::Sub(ec, cos_t), hn::Add(ec, cos_t));
    reflectance = hn::Mul(all(0.5f), hn::MulAdd(s, s, hn::Mul(p, p)));
  } else {
    const float root = (eta - 1.0f) / (eta + 1.0f);
    const Vec d = hn::Sub(one, c), square = hn::Mul(d, d);
    reflectance = hn::MulAdd(all(1.0f - root * root), hn::Mul(hn::Mul(square, square), d), all(root * root));
  }
  reflectance = hn::Min(one, hn::Mul(reflectance, all(optics.material.specular)));
}

/// Squared change of the normals to the four next pixels, where none of these is beyond an edge. See NormalVariance.
HWY_INLINE void normals_inside(const float* normals, std::size_t row, std::size_t lane, WaterBlock& block) {
  const Tag d;
  const float* from = normals + 3 * block.indices[lane];
  Triple normal;
  hn::LoadInterleaved3(d, from, normal.x, normal.y, normal.z);
  store(normal, block.normal, lane);
  const auto is_zero = [](const Triple& v) HWY_ATTR {
    return hn::Eq(hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z))), all(0.0f));
  };
  Vec largest = all(0.0f);
  for (const float* other : {from - 3, from + 3, from - 3 * row, from + 3 * row}) {
    Triple neighbour;
    hn::LoadInterleaved3(d, other, neighbour.x, neighbour.y, neighbour.z);
    const Triple change = minus(normal, neighbour);
    const Vec square = hn::IfThenZeroElse(is_zero(neighbour), dot(change, change));
    largest = hn::IfThenElse(hn::Gt(square, largest), square, largest);
  }
  store(hn::IfThenZeroElse(is_zero(normal), hn::Min(largest, all(kLargestVariance))), block.variance + lane);
}

/// See diffuse_light().
HWY_INLINE Triple diffuse(const BlockOptics& optics, const Triple& normal, const Triple& sky, float wrap) {
  const Vec facing_sun = hn::Mul(hn::Add(dot(normal, all(optics.sun)), all(wrap)), all(1.0f / (1.0f + wrap)));
  return times(plus(sky, hn::Max(facing_sun, all(0.0f)), all(optics.sun_irradiance)), all(kPerPi));
}

/// See through_medium(), of one channel.
HWY_INLINE Vec through(Vec behind, Vec path, float extinction, float scattering, float body, Vec light) {
  const float sigma_t = extinction + scattering;
  const float albedo = scattering / (sigma_t > 1e-20f ? sigma_t : 1e-20f);
  const Vec left = hn::Exp(Tag(), hn::Max(hn::Mul(path, all(-sigma_t)), all(-87.0f)));
  const Vec scattered = hn::Mul(hn::Mul(all(body * albedo), light), hn::Sub(all(1.0f), left));
  return hn::MulAdd(behind, left, scattered);
}
HWY_INLINE Triple through(const Triple& behind, Vec path, const Material& m, const Triple& light) {
  return {through(behind.x, path, m.extinction.x, m.scattering.x, m.body.x, light.x),
          through(behind.y, path, m.extinction.y, m.scattering.y, m.body.y, light.y),
          through(behind.z, path, m.extinction.z, m.scattering.z, m.body.z, light.z)};
}

/// Factor of the sun's irradiance in a mirror. See mirrored_sun(), glare(), Environment::sun_glare().
HWY_INLINE Vec sun_in(const BlockOptics& optics, const Triple& normal, const Triple& direction, Vec variance) {
  const Tag d;
  const Vec s = hn::Add(variance, all(kLeastGlareVariance + Environment::kSunVariance));
  const Triple chord = minus(direction, all(optics.sun));
  const Vec above = hn::Mul(all(0.5f), dot(chord, chord));
  const Mask lit = hn::And(hn::Le(above, hn::Mul(all(30.0f), s)), hn::Gt(dot(normal, all(optics.sun)), all(0.0f)));
  if (hn::AllFalse(d, lit)) return all(0.0f);
  const Vec inverse = hn::Div(all(1.0f), s);
  const Vec backwards =
      hn::IfThenElseZero(hn::Gt(s, all(0.05f)), hn::Exp(d, hn::Max(hn::Mul(all(-2.0f), inverse), all(-87.0f))));
  const Vec exponent = hn::Max(hn::Neg(hn::Mul(above, inverse)), all(-87.0f));
  const Vec norm = hn::Mul(all(2.0f * std::numbers::pi_v<float>), hn::Mul(s, hn::Sub(all(1.0f), backwards)));
  const Vec factor = hn::Div(hn::Exp(d, exponent), norm);
  const vec3 sun = optics.sun_irradiance;
  const Vec peak = hn::Mul(factor, all(std::max(sun.x, std::max(sun.y, sun.z))));
  const Vec bounded = hn::Mul(factor, hn::Div(all(kBrightestGlare), hn::Add(all(kBrightestGlare), peak)));
  return hn::IfThenElseZero(lit, bounded);
}

}  // namespace

std::size_t LoadNormals(const Image<vec3>& normals, std::size_t lane, WaterBlock& block) {
  const auto lanes = hn::Lanes(Tag());
  const auto row = static_cast<std::size_t>(normals.width());
  if (lane + lanes > static_cast<std::size_t>(block.count)) return 0;
  const std::size_t first = block.indices[lane], last = block.indices[lane + lanes - 1];
  const std::size_t x = first % row;
  if (last - first != lanes - 1 || x == 0 || x + lanes >= row || first < row || last + row >= normals.size()) return 0;
  normals_inside(&normals.data()->x, row, lane, block);
  return lanes;
}

void Bend(const BlockOptics& optics, WaterBlock& block) {
  const Tag d;
  const Material& material = optics.material;
  const Vec zero = hn::Zero(d), infinity = all(std::numeric_limits<float>::infinity());
  const float cone = 0.8f * material.roughness * material.roughness;
  const float inverse_ior = 1.0f / material.ior;
  Mask down = hn::Lt(zero, zero);
  for (std::size_t i = 0; i < static_cast<std::size_t>(block.count); i += hn::Lanes(d)) {
    const Triple direction = load(block.rays.direction, i);
    const Triple normal = faced(load(block.normal, i), direction);
    store(normal, block.normal, i);
    down = hn::Or(down, hn::Lt(dot(normal, all(optics.up)), all(-0.17f)));
    const Vec depth = load(block.depth + i), given = load(block.thickness + i);
    const Vec thickness = hn::IfThenElseZero(hn::And(hn::Gt(given, zero), hn::Lt(given, infinity)), given);
    store(thickness, block.thickness + i);
    const Triple point = plus(load(block.rays.origin, i), depth, direction);

    const Vec along = dot(direction, normal), cos_i = hn::Neg(along);
    Vec reflectance, cos_t;
    interface(optics, cos_i, reflectance, cos_t);
    store(reflectance, block.mirrored + i);
    store(hn::Div(hn::Mul(thickness, cos_i), cos_t), block.path + i);
    const Vec turn = hn::MulSub(cos_i, all(inverse_ior), cos_t);
    store(point, block.inside.origin, i);
    store(unit(plus(times(direction, all(inverse_ior)), turn, normal)), block.inside.direction, i);
    store(point, block.onward.origin, i);
    store(direction, block.onward.direction, i);

    // See mirror_of().
    const Vec deviation = hn::Sqrt(load(block.variance + i));
    store(hn::Mul(deviation, all(1.0f - inverse_ior)), block.slopes + i);
    const Vec doubled = hn::Add(deviation, deviation);
    const Vec variance = hn::Add(load(block.variance + i), all(cone * cone));
    store(variance, block.glare + i);
    store(point, block.mirror.origin, i);
    store(unit(plus(direction, hn::Mul(all(-2.0f), along), normal)), block.mirror.direction, i);
    store(hn::MulAdd(all(optics.beam.spread), depth, all(optics.beam.width)), block.mirror_beams.width + i);
    store(hn::Add(doubled, all(optics.beam.spread + 2.0f * cone)), block.mirror_beams.spread + i);
    const Vec rough = hn::Min(hn::Sqrt(hn::Mul(hn::Sqrt(variance), all(1.0f / 0.8f))), all(1.0f));
    store(hn::IfThenElseZero(hn::Gt(variance, all(1e-6f)), rough), block.mirror_beams.roughness + i);
  }
  block.undersides = !hn::AllFalse(d, down);
}

bool Lean(const BlockOptics& optics, const float* floor, WaterBlock& block) {
  const Tag d;
  const Vec zero = hn::Zero(d);
  Mask any = hn::Lt(zero, zero);
  for (std::size_t i = 0; i < static_cast<std::size_t>(block.count); i += hn::Lanes(d)) {
    const Vec down = hn::Neg(dot(load(block.normal, i), all(optics.up))), distance = load(floor + i);
    const Mask there = hn::And(hn::Gt(down, all(0.17f)), hn::Lt(distance, all(std::numeric_limits<float>::infinity())));
    const Vec straight = hn::IfThenElseZero(there, distance);
    const Vec thicknesses = hn::Div(straight, hn::Max(load(block.thickness + i), all(1e-20f)));
    const Vec near = hn::Sub(all(1.0f), smoothstep(1.0f, 3.0f, thicknesses));
    const Vec weight = hn::IfThenElseZero(there, hn::Mul(smoothstep(0.17f, 0.42f, down), near));
    any = hn::Or(any, hn::Gt(weight, zero));
    store(straight, block.straight + i);
    store(weight, block.contact + i);
  }
  return !hn::AllFalse(d, any);
}

void GoOn(const BlockOptics& optics, const float* to_ground, WaterBlock& block) {
  const Tag d;
  const vec3 extinction = optics.material.extinction;
  const Vec tint = all(std::max(extinction.x, std::max(extinction.y, extinction.z)));
  for (std::size_t i = 0; i < static_cast<std::size_t>(block.count); i += hn::Lanes(d)) {
    const Vec ground = load(to_ground + i), free = load(block.path + i);
    const Mask on_ground = hn::Le(ground, free);
    const Vec path = hn::IfThenElse(on_ground, ground, free);
    store(path, block.path + i);
    const Vec deep = smoothstep(0.1f, 0.7f, hn::Mul(tint, load(block.thickness + i)));
    const Vec back = mixed(all(kBackFromThin), all(kBackFromDeep), deep);
    const Triple inside = load(block.inside.direction, i), point = load(block.inside.origin, i);
    const Triple bent = unit(plus(inside, back, minus(load(block.rays.direction, i), inside)));
    store(chosen(on_ground, inside, bent), block.onward.direction, i);
    store(plus(point, hn::IfThenZeroElse(on_ground, path), inside), block.onward.origin, i);
    const Vec slopes = load(block.slopes + i), way = hn::Add(load(block.depth + i), path);
    const Vec width = hn::MulAdd(all(optics.beam.spread), way, hn::MulAdd(slopes, path, all(optics.beam.width)));
    store(width, block.beams.width + i);
    store(hn::Add(slopes, all(optics.beam.spread)), block.beams.spread + i);
    store(hn::Zero(d), block.beams.roughness + i);
  }
}

void PutTogether(const BlockOptics& optics, const WaterBlock& block, const BlockVectors& sky,
                 const BlockVectors* behind, const BlockVectors* floor, const BlockVectors* image, BlockVectors& seen) {
  const Tag d;
  const Material& material = optics.material;
  for (std::size_t i = 0; i < static_cast<std::size_t>(block.count); i += hn::Lanes(d)) {
    const Triple normal = load(block.normal, i);
    const Triple light = diffuse(optics, normal, load(sky, i), behind ? 0.5f : 0.0f);
    Triple result;
    if (!behind) {
      const Triple body = all(material.body);
      result = {hn::Mul(light.x, body.x), hn::Mul(light.y, body.y), hn::Mul(light.z, body.z)};
    } else {
      result = through(load(*behind, i), load(block.path + i), material, light);
      if (floor) {
        const Triple straight = through(load(*floor, i), load(block.straight + i), material, light);
        result = plus(result, load(block.contact + i), minus(straight, result));
      }
    }
    if (image) {
      const Triple direction = load(block.mirror.direction, i);
      const Vec sun = sun_in(optics, normal, direction, load(block.glare + i));
      const Triple shown = plus(load(*image, i), sun, all(optics.sun_irradiance));
      result = plus(result, load(block.mirrored + i), minus(shown, result));
    }
    store(result, seen, i);
  }
}

void StorePixels(const std::size_t* indices, int count, const BlockVectors& colours, vec3* picture) {
  const Tag d;
  const auto lanes = hn::Lanes(d), end = static_cast<std::size_t>(count);
  for (std::size_t i = 0; i < end; i += lanes) {
    if (i + lanes <= end && indices[i + lanes - 1] - indices[i] == lanes - 1) {
      const Triple colour = load(colours, i);
      hn::StoreInterleaved3(colour.x, colour.y, colour.z, d, &picture[indices[i]].x);
    } else {
      for (std::size_t lane = i; lane < std::min(i + lanes, end); ++lane)
        picture[indices[lane]] = colours.get(static_cast<int>(lane));
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace meniscus
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace meniscus {

HWY_EXPORT(LoadNormals);
HWY_EXPORT(Bend);
HWY_EXPORT(Lean);
HWY_EXPORT(GoOn);
HWY_EXPORT(PutTogether);
HWY_EXPORT(StorePixels);

std::size_t load_normals(const Image<vec3>& normals, std::size_t lane, WaterBlock& block) {
  return HWY_DYNAMIC_DISPATCH(LoadNormals)(normals, lane, block);
}

void bend(const BlockOptics& optics, WaterBlock& block) { HWY_DYNAMIC_DISPATCH(Bend)(optics, block); }

bool lean(const BlockOptics& optics, const float* floor, WaterBlock& block) {
  return HWY_DYNAMIC_DISPATCH(Lean)(optics, floor, block);
}

void go_on(const BlockOptics& optics, const float* to_ground, WaterBlock& block) {
  HWY_DYNAMIC_DISPATCH(GoOn)(optics, to_ground, block);
}

void put_together(const BlockOptics& optics, const WaterBlock& block, const BlockVectors& sky,
                  const BlockVectors* behind, const BlockVectors* floor, const BlockVectors* image,
                  BlockVectors& seen) {
  HWY_DYNAMIC_DISPATCH(PutTogether)(optics, block, sky, behind, floor, image, seen);
}

void store_pixels(const std::size_t* indices, int count, const BlockVectors& colours, vec3* picture) {
  HWY_DYNAMIC_DISPATCH(StorePixels)(indices, count, colours, picture);
}

}  // namespace meniscus
#endif
