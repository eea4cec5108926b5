#include "shading/ground_grain.h"

#include <numbers>

#include "shading/ground_noise.h"

namespace meniscus {
namespace {

/// Variance of a slope of value_noise().
constexpr float kNoiseSlopes = 0.74f;

/// One octave of noise.
struct Octave {
  float length;  ///< m between its places
  float shade;   ///< what it adds to the shade at most
  float height;  ///< m, of its bumps
};

/// One octave; `p` with swapped axes is for octaves without bumps.
void add(const Octave& octave, vec2 p, float width, std::uint64_t seed, Grain& grain) {
  const float part = resolved(octave.length, width);
  const float steep = octave.height / octave.length;
  grain.hidden_slopes += (1.0f - part * part) * kNoiseSlopes * steep * steep;
  if (!(part > 0)) return;
  const PlaneNoise noise = value_noise(p / octave.length, seed);
  grain.shade += part * octave.shade * noise.value;
  grain.slope += part * steep * noise.slope;
}

/// Broad mottling of 0.1 m and more.
void add_mottling(vec2 p, float width, std::uint64_t seed, float strength, Grain& grain) {
  add({1.7f, 0.5f * strength, 0}, p, width, seed + 1, grain);
  add({0.43f, 0.3f * strength, 0}, {p.y, p.x}, width, seed + 2, grain);
  add({0.11f, 0.25f * strength, 0}, p, width, seed + 3, grain);
}

/// Tread plate: lenses that lie along one diagonal and the other in turn, domes of height (1 - d^2)^2.
void add_treads(vec2 p, float width, Grain& grain) {
  constexpr float kPitch = 0.034f, kLength = 0.0135f, kWidth = 0.0042f, kHeight = 0.0013f;
  // Mean over a lens of the square of its slope, for one axis, times the part of the plate that lenses cover.
  constexpr float kSteep = 16.0f / 24.0f * kHeight * kHeight * (1.0f / (kLength * kLength) + 1.0f / (kWidth * kWidth));
  constexpr float kSlopes = 0.5f * kSteep * std::numbers::pi_v<float> * kLength * kWidth / (kPitch * kPitch);
  const float part = resolved(2.0f * kWidth, width);
  grain.hidden_slopes += (1.0f - part * part) * kSlopes;
  if (!(part > 0)) return;
  const vec2 q = p / kPitch;
  const std::int32_t i = cell_of(q.x), j = cell_of(q.y);
  const float side = ((i ^ j) & 1) != 0 ? 1.0f : -1.0f;
  const vec2 along = std::numbers::sqrt2_v<float> / 2.0f * vec2{1.0f, side}, across{-along.y, along.x};
  const vec2 off = kPitch * (q - vec2{static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f});
  const float u = off.x * along.x + off.y * along.y, w = off.x * across.x + off.y * across.y;
  const float rest = 1.0f - u * u / (kLength * kLength) - w * w / (kWidth * kWidth);
  if (!(rest > 0)) return;
  grain.slope -= part * 4.0f * kHeight * rest * (u / (kLength * kLength) * along + w / (kWidth * kWidth) * across);
  grain.relief += part * rest * rest;
}

}  // namespace

Grain asphalt_grain(vec2 p, float width, std::uint64_t seed) {
  Grain grain;
  add_mottling(p, width, seed, 0.22f, grain);
  add({0.043f, 0.13f, 0.0006f}, p, width, seed + 7, grain);
  add({0.019f, 0.12f, 0.0003f}, p, width, seed + 8, grain);
  // Stones in dark binder: the nearest centre among those of the cells around, each with its own radius.
  constexpr float kPitch = 0.0085f, kMeanCover = 0.61f, kStone = 0.45f, kHeight = 0.0009f, kSlopes = 0.042f;
  const float part = resolved(kPitch, width);
  grain.hidden_slopes += (1.0f - part * part) * kSlopes;
  if (part > 0) {
    // Broken stones are not round: their plane is warped.
    vec2 q = p / kPitch;
    q += 0.3f * vec2{value_noise(q * 2.3f, seed + 9).value, value_noise(q * 2.3f, seed + 10).value};
    const std::int32_t i = cell_of(q.x), j = cell_of(q.y);
    float best = 1e9f, radius = 1, bright = 0;
    vec2 from{0.0f};
    for (std::int32_t dj = -1; dj <= 1; ++dj)
      for (std::int32_t di = -1; di <= 1; ++di) {
        const std::uint64_t bits = place_bits(i + di, j + dj, seed + 4);
        const vec2 centre{static_cast<float>(i + di) + unit_of(bits, 0), static_cast<float>(j + dj) + unit_of(bits, 1)};
        const float r = 0.24f + 0.46f * unit_of(bits, 2);
        const vec2 off = q - centre;
        // In radii of the stone, so that large ones reach farther.
        const float d = (off.x * off.x + off.y * off.y) / (r * r);
        if (d < best) best = d, radius = r, from = off, bright = unit_of(bits, 3);
      }
    // Edges as soft as the beam is wide.
    const float soft = std::clamp(0.15f + width / (kPitch * radius), 0.15f, 1.0f);
    const float d = std::sqrt(best);
    const float inside = std::clamp((1.0f - d) / soft + 0.5f, 0.0f, 1.0f);
    const float stone = inside * inside * (3.0f - 2.0f * inside);
    grain.shade += part * kStone * (stone * (0.25f + 1.5f * bright) - kMeanCover);
    // A flattened dome of height (1 - d^4).
    if (d < 1.0f) grain.slope -= (part * stone * kHeight / kPitch * 4.0f * best / (radius * radius)) * from;
    grain.relief = part * (2.0f * stone * (1.0f - 0.5f * best * stone) - 1.0f);
  }
  add({0.0022f, 0.12f, 0.00022f}, p, width, seed + 5, grain);
  add({0.0009f, 0.10f, 0.00008f}, p, width, seed + 6, grain);
  return grain;
}

Grain concrete_grain(vec2 p, float width, std::uint64_t seed) {
  Grain grain;
  add_mottling(p, width, seed + 16, 0.2f, grain);
  // Faint bands that the boards of the formwork have left.
  const float boards = resolved(0.12f, width);
  if (boards > 0) grain.shade += boards * 0.04f * value_noise({p.x / 2.5f, p.y / 0.12f}, seed + 20).value;
  add({0.028f, 0.04f, 0.0004f}, p, width, seed + 21, grain);
  add({0.006f, 0.07f, 0.00025f}, p, width, seed + 22, grain);
  add({0.0016f, 0.13f, 0.00014f}, p, width, seed + 23, grain);
  // Pores: a few small dark holes.
  constexpr float kPitch = 0.013f, kMean = 0.0021f;
  const float part = resolved(0.5f * kPitch, width);
  if (part > 0) {
    const vec2 q = p / kPitch;
    const std::int32_t i = cell_of(q.x), j = cell_of(q.y);
    const std::uint64_t bits = place_bits(i, j, seed + 24);
    if (unit_of(bits, 3) < 0.35f) {
      const float radius = 0.05f + 0.08f * unit_of(bits, 2) * unit_of(bits, 2);
      const vec2 centre{static_cast<float>(i) + 0.15f + 0.7f * unit_of(bits, 0),
                        static_cast<float>(j) + 0.15f + 0.7f * unit_of(bits, 1)};
      const vec2 off = q - centre;
      const float blur = radius + 0.5f * width / kPitch;
      const float d = (off.x * off.x + off.y * off.y) / (blur * blur);
      const float dark = d < 1 ? (1.0f - d) * (1.0f - d) * (radius * radius) / (blur * blur) : 0.0f;
      grain.shade -= part * 0.75f * dark;
      grain.relief -= part * dark;
    }
    grain.shade += part * kMean;
  }
  return grain;
}

Grain steel_grain(vec2 p, float width, std::uint64_t seed) {
  Grain grain;
  add_mottling(p, width, seed + 32, 0.12f, grain);
  // Brushed along the first axis: long fine scratches.
  constexpr float kAcross = 0.0011f, kHeight = 0.00004f;
  const float part = resolved(kAcross, width), steep = kHeight / kAcross;
  grain.hidden_slopes += (1.0f - part * part) * kNoiseSlopes * steep * steep;
  if (part > 0) {
    const PlaneNoise noise = value_noise({p.x / 0.11f, p.y / kAcross}, seed + 36);
    grain.shade += part * 0.07f * noise.value;
    grain.slope.y += part * steep * noise.slope.y;
  }
  const float broad = resolved(0.009f, width);
  if (broad > 0) grain.shade += broad * 0.05f * value_noise({p.x / 0.4f, p.y / 0.009f}, seed + 37).value;
  add_treads(p, width, grain);
  return grain;
}

}  // namespace meniscus
