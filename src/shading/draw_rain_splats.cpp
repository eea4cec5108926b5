#include "shading/draw_rain_splats.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "meniscus/formulas/optics.h"

namespace meniscus {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
/// Pieces nearer than this to the eye's plane are not drawn, m.
constexpr float kNearest = 1e-3f;
/// Streaks fade out on their way to the eye between these distances, m: a camera's lens would blur them away.
constexpr float kStreakGone = 0.15f, kStreakWhole = 0.45f;
/// Dots are no narrower, px.
constexpr float kLeastDot = 0.6f;
/// Balls up to this radius are drawn as dots, px.
constexpr float kDotRadius = 1.25f;
/// Piles up to this width of their base are drawn as lines, px.
constexpr float kLineWidth = 2.0f;
bool finite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// A point of the picture.
struct Spot {
  vec2 place;       ///< px
  float depth;      ///< along forward, m
  float distance;   ///< along the ray, m
  vec3 direction;   ///< unit, from the eye
  float per_metre;  ///< px, across the ray; a little more off the picture's middle, as there pixels see less
};

class Maker {
 public:
  Maker(const View& view, const RainLight& light, const RainLook& look) : view_(view), light_(light), look_(look) {
    perspective_ = view.projection == Projection::perspective;
    focal_ = 1.0f / view.pixel_size(1);
    middle_ = 0.5f * vec2{static_cast<float>(view.width), static_cast<float>(view.height)};
  }

  /// @return  whether there is something to draw; else the splat is undefined
  bool make(const WaterPiece& piece, Splat& splat) const {
    if (!(piece.opacity > 0) || !finite(piece.from)) return false;
    switch (piece.kind) {
      case WaterPiece::Kind::sphere:
        return sphere(piece, piece.opacity, splat);
      case WaterPiece::Kind::streak:
        return streak(piece, splat);
      case WaterPiece::Kind::pyramid:
        return pyramid(piece, splat);
      case WaterPiece::Kind::disk:
        return disk(piece, splat);
    }
    return false;
  }

  /// Pixels that it may touch; none if it is out of the picture.
  std::optional<TileRange> range(const Splat& splat, const WaterPiece& piece) const {
    vec2 low{splat.x, splat.y}, high = low;
    float reach = kRainFilter + 0.5f * std::max(splat.w0, splat.w1);
    if (splat.kind == Splat::Kind::line) {
      const vec2 end{splat.x + splat.length * splat.ux, splat.y + splat.length * splat.uy};
      low = glm::min(low, end);
      high = glm::max(high, end);
    } else if (splat.kind == Splat::Kind::pyramid) {
      // The tip, and the base within half a diagonal.
      const vec3 tip = view_.project(piece.to);
      low = glm::min(low - splat.w0, vec2{tip});
      high = glm::max(high + splat.w0, vec2{tip});
      reach = kRainFilter;
    }
    low -= reach;
    high += reach;
    const auto w = static_cast<float>(view_.width), h = static_cast<float>(view_.height);
    if (!(low.x < w && low.y < h && high.x > 0 && high.y > 0)) return {};
    const auto tile = [](float x, int size) {
      return static_cast<std::int16_t>(static_cast<int>(std::clamp(x, 0.0f, static_cast<float>(size - 1))) / kRainTile);
    };
    return TileRange{tile(low.x, view_.width), tile(low.y, view_.height), tile(high.x, view_.width),
                     tile(high.y, view_.height)};
  }

 private:
  bool spot(vec3 point, Spot& spot) const {
    const vec3 way = point - view_.eye;
    const float z = glm::dot(way, view_.forward);
    if (!(z > kNearest)) return false;
    const float scale = perspective_ ? focal_ / z : focal_;
    spot.place = {middle_.x + scale * glm::dot(way, view_.right), middle_.y - scale * glm::dot(way, view_.up)};
    spot.depth = z;
    if (perspective_) {
      spot.distance = std::sqrt(glm::dot(way, way));
      spot.direction = way * (1.0f / spot.distance);
      spot.per_metre = scale * std::sqrt(spot.distance / z);
    } else {
      spot.distance = z;
      spot.direction = view_.forward;
      spot.per_metre = scale;
    }
    return std::isfinite(spot.place.x + spot.place.y);
  }

  static void start(Splat& splat, const Spot& spot, float opacity) {
    splat.round = false;
    splat.x = spot.place.x;
    splat.y = spot.place.y;
    splat.w0 = splat.w1 = splat.length = 0;
    splat.t0 = splat.t1 = spot.distance;
    splat.alpha = std::min(opacity, 1.0f);
  }

  /// A square of this area, px^2; not much less than a pixel wide, so that it goes smoothly from one to the next.
  static void make_dot(Splat& splat, float area) {
    splat.kind = Splat::Kind::dot;
    splat.w0 = splat.w1 = std::max(kLeastDot, std::sqrt(area));
    splat.alpha *= area / (splat.w0 * splat.w0);
  }

  vec3 ball_colour(const Spot& spot, vec3 point) const {
    vec3 colour = light_.ball(spot.place);
    if (light_.has_lamps()) colour += light_.lamps(point, spot.direction);
    return colour;
  }

  bool sphere(const WaterPiece& piece, float opacity, Splat& splat) const {
    Spot centre;
    if (!(piece.radius > 0) || !spot(piece.from, centre) || !(centre.distance > 1.05f * piece.radius)) return false;
    const float radius = piece.radius * centre.per_metre;
    if (!std::isfinite(radius)) return false;
    start(splat, centre, opacity);
    splat.soft = piece.radius;
    splat.colour = ball_colour(centre, piece.from);
    if (look_.level_of_detail && radius < kDotRadius) {
      make_dot(splat, kPi * radius * radius);
      return true;
    }
    splat.kind = Splat::Kind::ball;
    // Seen from near, more of the picture is covered than its radius says.
    const float near = piece.radius / centre.distance;
    splat.w0 = splat.w1 =
        2.0f * radius *
        (perspective_ ? centre.distance / centre.depth / std::sqrt(1.0f - std::min(near * near, 0.95f)) : 1.0f);
    return true;
  }

  bool streak(const WaterPiece& piece, Splat& splat) const {
    if (!(piece.radius > 0) || !finite(piece.to)) return false;
    // The part of the way before the eye.
    vec3 from = piece.from, to = piece.to;
    const float z0 = glm::dot(from - view_.eye, view_.forward), z1 = glm::dot(to - view_.eye, view_.forward);
    const float least = perspective_ ? std::max(2.0f * kNearest, piece.radius) : 2.0f * kNearest;
    if (!(z0 > least) && !(z1 > least)) return false;
    const vec3 whole_way = to - from;
    if (z0 < least) from += whole_way * ((least - z0) / (z1 - z0));
    if (z1 < least) to -= whole_way * ((least - z1) / (z0 - z1));
    Spot first, last;
    if (!spot(from, first) || !spot(to, last)) return false;
    float opacity = std::min(piece.opacity, 1.0f);
    if (perspective_) {
      // Nearest to the eye on the whole way.
      const float way2 = glm::dot(whole_way, whole_way);
      const float s = way2 > 0 ? std::clamp(glm::dot(view_.eye - piece.from, whole_way) / way2, 0.0f, 1.0f) : 0.0f;
      opacity *= glm::smoothstep(kStreakGone, kStreakWhole, glm::length(piece.from + s * whole_way - view_.eye));
      if (!(opacity > 0)) return false;
    }
    const vec2 way = last.place - first.place;
    const float length = glm::length(way);
    const float r0 = piece.radius * first.per_metre, r1 = piece.radius * last.per_metre;
    const float radius = 0.5f * (r0 + r1);
    if (!std::isfinite(length) || !std::isfinite(radius)) return false;
    if (length < 0.5f * radius) {
      WaterPiece still = piece;
      still.kind = WaterPiece::Kind::sphere;
      still.from = 0.5f * (from + to);
      return sphere(still, std::min(1.0f, opacity * look_.streak_strength), splat);
    }
    start(splat, first, opacity);
    splat.t1 = last.distance;
    splat.soft = piece.radius;
    const Spot middle{0.5f * (first.place + last.place), 0.5f * (first.depth + last.depth),
                      0.5f * (first.distance + last.distance), glm::normalize(first.direction + last.direction),
                      0.5f * (first.per_metre + last.per_metre)};
    splat.colour = ball_colour(middle, 0.5f * (from + to));
    // The ball's area, spread over its way and the mean length of its chords.
    const float covered = kPi * radius * radius, stretch = length + 0.5f * kPi * radius;
    splat.alpha *= look_.streak_strength;
    if (stretch < 1.0f && radius < 0.5f) {
      make_dot(splat, covered);
      splat.x = middle.place.x;
      splat.y = middle.place.y;
      splat.t0 = splat.t1 = middle.distance;
      splat.alpha = std::min(splat.alpha, 1.0f);
      return true;
    }
    make_line(splat, way, length, stretch, 2.0f * r0, 2.0f * r1);
    splat.alpha = std::min(1.0f, splat.alpha * covered / (stretch * 2.0f * radius));
    splat.round = true;
    return true;
  }

  /// A line from the splat's place on along `way`, longer than it by the same at both ends.
  static void make_line(Splat& splat, vec2 way, float length, float stretch, float w0, float w1) {
    splat.kind = Splat::Kind::line;
    splat.ux = way.x / length;
    splat.uy = way.y / length;
    splat.length = stretch;
    splat.x -= 0.5f * (stretch - length) * splat.ux;
    splat.y -= 0.5f * (stretch - length) * splat.uy;
    splat.w0 = w0;
    splat.w1 = w1;
  }

  bool pyramid(const WaterPiece& piece, Splat& splat) const {
    const vec3 axis = piece.to - piece.from;
    const float half2 = glm::dot(piece.across, piece.across), height2 = glm::dot(axis, axis);
    Spot base, tip;
    if (!(half2 > 0) || !(height2 > 0) || !std::isfinite(half2 * height2)) return false;
    if (!spot(piece.from, base) || !spot(piece.to, tip)) return false;
    const float half = std::sqrt(half2);
    if (!(base.depth > half + kNearest)) return false;
    start(splat, base, std::min(piece.opacity, 1.0f) * look_.pile_opacity);
    splat.t1 = tip.distance;
    splat.soft = half;
    const vec2 way = tip.place - base.place;
    // Of the base, across the axis: the longer of its diagonals as seen.
    const vec3 across = glm::cross(axis, base.direction);
    const float aside2 = glm::dot(across, across);
    float reach = half;
    if (aside2 > 1e-6f * height2) {
      const float one = glm::dot(piece.across, across), other = glm::dot(glm::cross(axis, piece.across), across);
      reach = std::sqrt(std::max(one * one, other * other / height2) / aside2);
    }
    const float length2 = glm::dot(way, way), width = 2.0f * reach * base.per_metre;
    if (!std::isfinite(length2) || !std::isfinite(width)) return false;
    splat.colour = light_.jet(base.place + 0.4f * way, way);
    if (light_.has_lamps()) splat.colour += light_.lamps(piece.from, base.direction);
    if (!look_.level_of_detail || width > kLineWidth) {
      splat.kind = Splat::Kind::pyramid;
      splat.w0 = splat.w1 = 1.2f * half * base.per_metre * (perspective_ ? base.distance / base.depth : 1.0f);
      return true;
    }
    // The faces cover the shadow of the sides or that of the base, whichever is larger.
    const float length = std::sqrt(length2), cosine = std::abs(glm::dot(axis, base.direction)) / std::sqrt(height2);
    const float area = std::max(0.5f * width * length, 2.0f * half2 * base.per_metre * base.per_metre * cosine);
    if (length < 1.0f || length < width) {
      splat.x += way.x / 3.0f;
      splat.y += way.y / 3.0f;
      splat.t0 = splat.t1 = splat.t0 + (splat.t1 - splat.t0) / 3.0f;
      make_dot(splat, area);
      return true;
    }
    make_line(splat, way, length, length, 2.0f * area / length, 0.0f);
    return true;
  }

  bool disk(const WaterPiece& piece, Splat& splat) const {
    if (!(piece.radius > 0) || !finite(piece.across) || !(glm::length(piece.across) > 0)) return false;
    Spot centre;
    if (!spot(piece.from, centre) || !(centre.depth > piece.radius + kNearest)) return false;
    vec3 normal = glm::normalize(piece.across);
    if (glm::dot(normal, centre.direction) > 0) normal = -normal;
    const float cosine = -glm::dot(normal, centre.direction);
    const float major = piece.radius * centre.per_metre, minor = major * cosine;
    if (!std::isfinite(major)) return false;
    start(splat, centre, piece.opacity);
    // It lies on what is solid, wholly before it.
    splat.soft = piece.radius;
    splat.t0 = splat.t1 = std::max(0.0f, centre.distance - piece.radius);
    if (!look_.level_of_detail || minor > 1.0f) {
      splat.kind = Splat::Kind::disk;
      splat.w0 = splat.w1 = 2.0f * major * (perspective_ ? centre.distance / centre.depth : 1.0f) * 1.1f;
      return true;
    }
    // Its mirror image, and at the rim what is around; the ground shows through the rest.
    const float mirrored = formulas::fresnel_reflectance(cosine, look_.ior), around = 0.13f * (1.0f - mirrored);
    const vec3 mirror = formulas::mirrored(centre.direction, normal);
    splat.colour =
        (mirrored * light_.parts().radiance(mirror, 0.35f) + around * light_.parts().radiance(-mirror, 0.9f)) /
        (mirrored + around);
    splat.alpha *= mirrored + around;
    const float area = kPi * major * minor;
    if (major < 1.0f) {
      make_dot(splat, area);
      return true;
    }
    // Along the line in which the disk meets the plane across the ray.
    const vec3 along = glm::cross(normal, centre.direction);
    const vec2 way{glm::dot(along, view_.right), -glm::dot(along, view_.up)};
    const float size = glm::length(way);
    if (!(size > 0)) return false;
    const float length = 0.5f * kPi * major;
    splat.x -= 0.5f * length * way.x / size;
    splat.y -= 0.5f * length * way.y / size;
    make_line(splat, way, size, size, area / length, area / length);
    splat.length = length;
    return true;
  }

  const View& view_;
  const RainLight& light_;
  const RainLook& look_;
  bool perspective_ = true;
  float focal_ = 1;  ///< px per metre at 1 m
  vec2 middle_{0.0f};
};

}  // namespace

Splats make_splats(const View& view, std::span<const WaterPiece> pieces, const RainLight& light, const RainLook& look) {
  const std::size_t runs = (pieces.size() + Splats::kRun - 1) / Splats::kRun;
  Splats all{std::make_unique_for_overwrite<Splat[]>(runs * Splats::kRun),
             std::make_unique_for_overwrite<TileRange[]>(runs * Splats::kRun), std::vector<std::size_t>(runs), false};
  std::atomic<bool> looks_behind{false};
  const Maker maker(view, light, look);
  parallel_for(runs, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t run = begin; run < end; ++run) {
      std::size_t next = run * Splats::kRun;
      bool behind = false;
      for (std::size_t i = run * Splats::kRun; i < std::min(pieces.size(), (run + 1) * Splats::kRun); ++i) {
        Splat& splat = all.splats[next];
        if (!maker.make(pieces[i], splat) || !(splat.alpha > 0)) continue;
        const std::optional<TileRange> range = maker.range(splat, pieces[i]);
        if (!range) continue;
        splat.piece = static_cast<std::uint32_t>(i);
        behind = behind || splat.kind >= Splat::Kind::ball;
        all.ranges[next] = *range;
        ++next;
      }
      all.counts[run] = next - run * Splats::kRun;
      if (behind) looks_behind = true;
    }
  });
  all.looks_behind = looks_behind;
  return all;
}

}  // namespace meniscus
