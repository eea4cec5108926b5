#include "render/rain_streaks.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr float kFading = 0.3f;  ///< of the reach, at its end, over which streaks fade
constexpr float kMost = 12;      ///< m/s that no drop is faster than by itself
// A wide-angle lens of 32 mm at f/8: what is near is out of focus.
constexpr float kAperture = 0.004f;  ///< m across
constexpr float kFocus = 4;          ///< m

/// Radius, m, of the spot that a point at a distance is blurred to, measured there.
float blurred(float away) { return 0.5f * kAperture * std::abs(1 - away / kFocus); }

/// Whether a ball may be seen through the view.
class Seen {
 public:
  explicit Seen(const View& view) : view_(view) {
    const float aspect = static_cast<float>(view.width) / static_cast<float>(view.height);
    half_ = {view.half_height * aspect, view.half_height};
    // Of the frustum's sides, per unit of the half size there.
    lean_ = {std::sqrt(1 + half_.x * half_.x), std::sqrt(1 + half_.y * half_.y)};
  }
  bool operator()(vec3 point, float radius) const {
    if (view_.projection == Projection::cube) return true;
    const vec3 off = point - view_.eye;
    const float depth = glm::dot(off, view_.forward);
    if (depth < -radius) return false;
    const float x = std::abs(glm::dot(off, view_.right)), y = std::abs(glm::dot(off, view_.up));
    if (view_.projection == Projection::orthographic) return x <= half_.x + radius && y <= half_.y + radius;
    return x <= half_.x * depth + lean_.x * radius && y <= half_.y * depth + lean_.y * radius;
  }

 private:
  const View& view_;
  vec2 half_, lean_;
};

}  // namespace

void add_streaks(const Rain& rain, const Flights& flights, const RainSettings& settings, double time, const View& view,
                 std::vector<WaterPiece>& pieces) {
  const Seen seen(view);
  const double opens = time - 0.5 * settings.shutter, closes = time + 0.5 * settings.shutter;
  const float longest = settings.shutter * (kMost + glm::length(settings.rain.wind.velocity));
  const float top = rain.options().level + rain.options().top;
  const int up = static_cast<int>(rain.options().up);
  flights.each([&](const Flight& flight) {
    const float above = static_cast<float>(flight.drop.time - time) * flight.fall + rain.options().level;
    if (above > top + 1 || flight.hit <= opens) return;
    const vec3 middle = rain.position(flight.drop, time);
    const float away = glm::distance(middle, view.eye);
    if (view.projection == Projection::perspective && away > settings.streak_reach) return;
    if (!seen(middle, longest)) return;
    WaterPiece piece;
    piece.kind = WaterPiece::Kind::streak;
    piece.from = rain.position(flight.drop, opens);
    piece.to = rain.position(flight.drop, std::min(closes, flight.hit));
    // As wide as one drop that hides as much as all that it stands for, and as the lens blurs it: then it hides less.
    const float drop = 0.5f * flight.drop.diameter * std::sqrt(flight.drop.weight);
    const bool perspective = view.projection == Projection::perspective;
    piece.radius = perspective ? std::hypot(drop, blurred(away)) : drop;
    const float thinned = drop * drop / (piece.radius * piece.radius);
    // Near the end of what is drawn, and where drops come in, they fade.
    const float left = (settings.streak_reach - away) / (kFading * settings.streak_reach);
    const float below = top - middle[up];
    piece.opacity = thinned * std::clamp(std::min(perspective ? left : 1.0f, below), 0.0f, 1.0f);
    if (piece.opacity > 0) pieces.push_back(piece);
  });
}

}  // namespace meniscus
