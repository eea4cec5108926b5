// What wet ground looks like.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/field_axes.h"
#include "meniscus/formulas.h"
#include "meniscus/shading.h"
#include "meniscus/sim.h"
#include "shading/ground_grain.h"
#include "shading/ground_noise.h"
#include "sim/puddle_levels.h"

namespace meniscus {
namespace {

constexpr float kWaterIor = 1.333f;
/// Of the film of water once it is full, of dry and of wet steel.
constexpr float kFilmRoughness = 0.07f, kSteelRoughness = 0.4f, kWetSteelRoughness = 0.16f;
/// A coat that mirrors as much as weathered steel does, straight on.
constexpr float kSteelIor = 3.0f, kSteelMirrors = 0.25f;
/// What is left of its albedo under water.
constexpr float kSunkSteel = 0.65f;
/// m under a puddle's level over which the film's coat goes, so that rounding leaves no seam; m above the level over
/// which the film becomes as smooth as the puddle is.
constexpr float kUnder = 0.00003f, kShore = 0.0016f;
/// Two materials are told apart along a line between them; to beams as wide as a cell they are mixed.
constexpr float kSharpness = 14.0f;
/// m of film that saturated ground shows without any water on it.
constexpr float kDampFilm = 0.00004f;
/// m of water in the dark spot of a drop, and m between spots.
constexpr float kSpotDepth = 0.00015f, kSpots = 0.02f;

float smooth(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/// The state of a cell, and of a place between cells.
struct Wet {
  float saturation = 0;  ///< 0 .. 1, of what it can soak up
  float dark = 0;        ///< 0 .. 1, of its face
  float depth = 0;       ///< m of water
};

/// Shares of a place, by GroundMaterial.
using Materials = std::array<float, 3>;

class WetGroundCover final : public GroundCover {
 public:
  WetGroundCover(const WetGround& ground, const WetLook& look)
      : look_(look),
        axes_(ground.options().up),
        low_(ground.options().low),
        cell_(ground.options().cell),
        width_(ground.width()),
        height_(ground.height()),
        puddles_(ground),
        cells_(ground.size()),
        materials_(ground.size()) {
    if (!(look.film_full > 0) || !std::isfinite(look.film_full) || !(look.bumpiness >= 0) ||
        !std::isfinite(look.bumpiness))
      throw Error(ErrorCode::invalid_argument, "the film of wet ground is not above zero, or its bumps are below");
    for (const vec3& albedo : look.albedo)
      if (!(albedo.x >= 0 && albedo.y >= 0 && albedo.z >= 0 && albedo.x <= 1 && albedo.y <= 1 && albedo.z <= 1))
        throw Error(ErrorCode::invalid_argument, "an albedo of the ground is not in [0, 1]");
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const double capacity = ground.capacity(i);
      cells_[i].saturation = capacity > 0 ? static_cast<float>(std::clamp(ground.soaked(i) / capacity, 0.0, 1.0)) : 0;
      // Drops fall anywhere in a cell: each darkens its share of what the others left dry.
      const auto darkened = [](double soaked) { return 1.0 - std::exp(-soaked / static_cast<double>(kSpotDepth)); };
      if (capacity > 0)
        cells_[i].dark = static_cast<float>(std::clamp(darkened(ground.soaked(i)) / darkened(capacity), 0.0, 1.0));
      cells_[i].depth = static_cast<float>(std::max(ground.depth(i), 0.0));
      materials_[i] = static_cast<std::uint8_t>(ground.material(i));
    }
    for (std::size_t i = 1; i < materials_.size(); ++i) alone_ = alone_ && materials_[i] == materials_[0];
  }

  void cover(std::span<const vec3> points, std::span<const vec3> directions, std::span<const float> widths,
             std::span<SolidHit> hits) const override {
    for (std::size_t i = 0; i < hits.size(); ++i) cover_one(points[i], directions[i], widths[i], hits[i]);
  }

 private:
  /// Place of a coordinate in cells, on the mirror image beyond the border.
  static float folded(float x, int count) {
    if (!std::isfinite(x)) return 0;
    const float period = 2.0f * static_cast<float>(count);
    const float t = x - period * std::floor(x / period);
    return std::min(t, period - t);
  }

  /// Calls with index and weight of the nine cells around: a quadratic B-spline makes round spots without corners.
  template <class With>
  void around(vec2 p, With with) const {
    const float x = folded((p.x - low_.x) / cell_, width_), y = folded((p.y - low_.y) / cell_, height_);
    const int i = std::min(static_cast<int>(x), width_ - 1), j = std::min(static_cast<int>(y), height_ - 1);
    const auto weights = [](float t, float(&w)[3]) {
      w[0] = 0.5f * (1.0f - t) * (1.0f - t);
      w[2] = 0.5f * t * t;
      w[1] = 1.0f - w[0] - w[2];
    };
    float wx[3], wy[3];
    weights(x - static_cast<float>(i), wx);
    weights(y - static_cast<float>(j), wy);
    for (int dj = 0; dj < 3; ++dj) {
      const int row = std::clamp(j + dj - 1, 0, height_ - 1);
      for (int di = 0; di < 3; ++di) {
        const int column = std::clamp(i + di - 1, 0, width_ - 1);
        with(static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column),
             wx[di] * wy[dj]);
      }
    }
  }

  Wet state(vec2 p) const {
    Wet sum;
    around(p, [&](std::size_t i, float w) {
      sum.saturation += w * cells_[i].saturation;
      sum.dark += w * cells_[i].dark;
      sum.depth += w * cells_[i].depth;
    });
    return sum;
  }

  /// Materials do not fade into each other, but as far as the beam mixes them.
  Materials materials(vec2 p, float print) const {
    Materials shares{};
    if (alone_) {
      shares[materials_[0]] = 1;
      return shares;
    }
    around(p, [&](std::size_t i, float w) { shares[materials_[i]] += w; });
    const float sharpness = 1.0f + (kSharpness - 1.0f) * resolved(2.0f * cell_, print);
    float sum = 0;
    for (float& share : shares) {
      // Raised to a power the largest share takes all.
      if (share > 0.0f && share < 0.999f) share = std::pow(share, sharpness);
      sum += share;
    }
    for (float& share : shares) share /= sum;
    return shares;
  }

  /// A place's height above the level of the puddle that it is near, m; infinity far from all. Beyond the cells that of
  /// the mirror image.
  float above_puddle(vec2 place, float height) const {
    if (puddles_.empty()) return std::numeric_limits<float>::infinity();
    const float x = (place.x - low_.x) / cell_, y = (place.y - low_.y) / cell_;
    const vec2 cell{folded(x, width_), folded(y, height_)};
    const vec2 there = low_ + cell_ * cell;
    const float level = puddles_.level(there);
    // Beyond the outermost cells' middles no puddle has a surface of its own: its mirror image is a film's.
    const bool beyond =
        x < 0.5f || y < 0.5f || x > static_cast<float>(width_) - 0.5f || y > static_cast<float>(height_) - 0.5f;
    return beyond ? std::max(puddles_.bed(there) - level, 0.0f) : height - level;
  }

  /// How dark a place is where a part of the ground around it is: all or nothing, but for soft edges, to narrow beams.
  float spotted(float dark, vec2 place, float print) const {
    const float part = resolved(kSpots, print);
    if (!(part > 0 && dark > 1e-3f && dark < 0.999f)) return dark;
    // Spots around scattered points, some larger: the nearest by its own measure. Were the points scattered without any
    // grid, `level` would take all values in [0, 1] alike.
    const vec2 q = place / kSpots;
    const std::int32_t i = cell_of(q.x), j = cell_of(q.y);
    float nearest = 1e9f;
    for (std::int32_t dj = -1; dj <= 1; ++dj)
      for (std::int32_t di = -1; di <= 1; ++di) {
        const std::uint64_t bits = place_bits(i + di, j + dj, look_.seed + 67);
        const vec2 off =
            q - vec2{static_cast<float>(i + di) + unit_of(bits, 0), static_cast<float>(j + dj) + unit_of(bits, 1)};
        const float size = unit_of(bits, 2);
        nearest = std::min(nearest, (off.x * off.x + off.y * off.y) / (0.05f + 2.2f * size * size * size));
      }
    // The mean of those sizes is 0.6.
    const float level = 1.0f - std::exp(-std::numbers::pi_v<float> * 0.6f * nearest);
    const float soft = std::max(dark * (1.0f - dark), 1e-3f);
    return glm::mix(dark, smooth((dark - level) / soft + 0.5f), part);
  }

  void cover_one(vec3 point, vec3 direction, float width, SolidHit& hit) const {
    // Places that are none are somewhere all the same.
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(point[axis])) point[axis] = 0;
    if (!(width >= 0)) width = 0;
    // The plane of the grain: the one of two axes that the face lies in most.
    int u = axes_.a, v = axes_.b;
    const vec3 across = glm::abs(hit.face_normal);
    if (across[axes_.a] > std::max(across[axes_.up], across[axes_.b])) u = axes_.b, v = axes_.up;
    if (across[axes_.b] > std::max(across[axes_.up], across[axes_.a])) u = axes_.a, v = axes_.up;
    const vec2 p{point[u], point[v]};
    // The beam's print is longer than wide at a slant; as much is lost in between.
    const float cos_in = std::max(-glm::dot(direction, hit.face_normal), 0.02f);
    const float print = width / std::sqrt(cos_in);

    // Where it is looked up wavers a little, so that no row of cells shows.
    vec2 place{point[axes_.a], point[axes_.b]};
    const float waver = resolved(2.0f * cell_, print);
    if (waver > 0) {
      place.x += 0.3f * waver * cell_ * value_noise(place / (1.7f * cell_), look_.seed + 64).value;
      place.y += 0.3f * waver * cell_ * value_noise(place / (1.3f * cell_), look_.seed + 65).value;
    }
    // A steep face belongs to the ground that stands behind it.
    const vec3 inwards = -hit.face_normal;
    const vec2 behind = 1.5f * cell_ * vec2{inwards[axes_.a], inwards[axes_.b]};
    place += behind;
    Wet wet = state(place);
    const Materials materials = this->materials(vec2{point[axes_.a], point[axes_.b]} + behind, print);
    // Water runs off what is steep.
    const float level_ground = smooth((glm::dot(hit.face_normal, axes_.place(0, 0, 1)) - 0.5f) / 0.35f);
    wet.depth *= level_ground;
    const float above = level_ground > 0 ? above_puddle({point[axes_.a], point[axes_.b]}, point[axes_.up])
                                         : std::numeric_limits<float>::infinity();
    const float puddle = smooth(-above / kUnder);

    const float dark = spotted(wet.dark, place, print);
    // Films are not even: ground is not flat below a cell either.
    float unevenness = 1;
    if (wet.depth > 0)
      for (const float length : {0.07f, 0.31f})
        if (const float part = resolved(length, print); part > 0)
          unevenness += 0.33f * part * value_noise(place / length, look_.seed + 66).value;

    vec3 albedo{0.0f};
    float roughness = 0, ior = 0, hidden = 0, near_shore = 0;
    vec2 slope{0.0f};
    for (int m = 0; m < 3; ++m) {
      const float share = materials[static_cast<std::size_t>(m)];
      if (!(share > 1e-3f)) continue;
      const auto material = static_cast<GroundMaterial>(m);
      const Grain grain = material == GroundMaterial::asphalt    ? asphalt_grain(p, print, look_.seed)
                          : material == GroundMaterial::concrete ? concrete_grain(p, print, look_.seed)
                                                                 : steel_grain(p, print, look_.seed);
      const vec3 dry = glm::clamp(look_.albedo[static_cast<std::size_t>(m)] * grain.shade, vec3{0.0f}, vec3{1.0f});
      // Water stands lower on what stands out.
      const float film =
          std::max(wet.depth * (1.0f - 0.5f * grain.relief) * unevenness, 0.0f) + kDampFilm * wet.saturation;
      const float full = smooth(film / look_.film_full);
      // At a shore the film is as smooth and level as the puddle, but for what stands out of it.
      const float shore = level_ground * (1.0f - smooth(std::max(above, 0.0f) * (1.0f + 0.8f * grain.relief) / kShore));
      near_shore += share * shore;
      const float filled = material == GroundMaterial::steel ? 0.3f : 0.88f;  // treads stand out of a film
      const float bumps = look_.bumpiness * (1.0f - filled * full) * (1.0f - shore);
      slope += share * bumps * grain.slope;
      float own = 1, own_ior = kWaterIor;
      if (material == GroundMaterial::steel) {
        // Its albedo is that of mirror image and body together, straight on. Under water it is dull: a mirror image
        // there would have to leave the water again.
        const float film_roughness = glm::mix(kSteelRoughness, kWetSteelRoughness, full);
        const vec3 mirrored{(1.0f - film_roughness) * kSteelMirrors};
        const vec3 body = glm::clamp((dry - mirrored) / (1.0f - mirrored), vec3{0.0f}, vec3{1.0f});
        // The body under the mirror image is rough oxide.
        albedo += share * glm::mix(glm::mix(body, wetted(body), full), wetted(kSunkSteel * dry), puddle);
        own = glm::mix(film_roughness, 1.0f, puddle);
        own_ior = kSteelIor;
      } else {
        albedo += share * glm::mix(dry, wetted(dry), std::max(dark, full));
        own = glm::mix(glm::mix(1.0f, kFilmRoughness, full) * (1.0f - shore), 1.0f, puddle);
      }
      // Bumps that are not seen widen the mirror image: directions turn by twice the normals' angle.
      const float cone = 0.8f * own * own;
      const float wider = std::sqrt(cone * cone + 4.0f * bumps * bumps * grain.hidden_slopes);
      hidden += share * std::min(1.0f, std::sqrt(wider / 0.8f));
      roughness += share * own;
      ior += share * own_ior;
    }
    hit.albedo = albedo;
    hit.roughness = std::min(std::max(roughness, hidden), 1.0f);
    hit.ior = ior;
    if (near_shore > 0) {
      const vec3 levelled = glm::mix(hit.normal, axes_.place(0, 0, 1), near_shore);
      if (glm::dot(levelled, direction) < 0) hit.normal = glm::normalize(levelled);
    }
    tilt(u, v, slope, direction, hit);
  }

  static vec3 wetted(vec3 dry) {
    // wet_albedo() with its share found once.
    static const float kept = 1.0f - (1.0f - formulas::diffuse_reflectance(kWaterIor)) / (kWaterIor * kWaterIor);
    return (1.0f - kept) * dry / (1.0f - kept * dry);
  }

  /// Turns the normal against the slope of bumps along two axes, no farther than that the ray's origin still sees it.
  static void tilt(int u, int v, vec2 slope, vec3 direction, SolidHit& hit) {
    if (slope == vec2{0.0f}) return;
    vec3 along{0.0f};
    along[u] = slope.x;
    along[v] = slope.y;
    along -= glm::dot(along, hit.normal) * hit.normal;
    vec3 normal = glm::normalize(hit.normal - along);
    constexpr float kLeast = 1e-3f;
    const float towards = glm::dot(normal, direction);
    if (towards > -kLeast) normal = glm::normalize(normal - (towards + kLeast) * direction);
    hit.normal = normal;
  }

  WetLook look_;
  FieldAxes axes_;
  vec2 low_;
  float cell_;
  int width_, height_;
  PuddleLevels puddles_;
  std::vector<Wet> cells_;
  std::vector<std::uint8_t> materials_;  ///< GroundMaterial, one a cell
  bool alone_ = true;                    ///< one material everywhere
};

}  // namespace

std::shared_ptr<const GroundCover> wet_ground_cover(const WetGround& ground, const WetLook& look) {
  return std::make_shared<WetGroundCover>(ground, look);
}

}  // namespace meniscus
