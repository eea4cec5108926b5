#include "shading/caustics_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr int kRowsOfAList = 4;
/// Neighbouring points of the water belong together when the way between them is nearly along the surface: the sine of
/// its angle with it, and the length, in distances of the screen's points, up to which nothing is asked.
constexpr float kSteepest = 0.6f;
constexpr float kNear = 3.0f;
/// A shard is no longer than this many distances of the screen's points.
constexpr float kLongest = 8.0f;
/// Light that leaves the water belongs together when it does so no farther apart than this many distances.
constexpr float kTorn = 5.0f;

double sum(vec3 v) { return static_cast<double>(v.x) + static_cast<double>(v.y) + static_cast<double>(v.z); }

/// Where a landing lies for a view.
enum class Layer : std::uint8_t { grazing = 0, seen = 1, behind = 2, both = 3 };
Layer common(Layer a, Layer b) { return static_cast<Layer>(static_cast<int>(a) & static_cast<int>(b)); }

/// Where polygons go.
struct Output {
  std::vector<LightPolygon>& seen;
  std::vector<LightPolygon>& behind;
  LightBalance& balance;
  void draw(const LightPolygon& polygon, Layer layer) const {
    if (common(layer, Layer::seen) != Layer::grazing) seen.push_back(polygon);
    if (common(layer, Layer::behind) != Layer::grazing) behind.push_back(polygon);
  }
};

/// What a point of the screen is for a map.
struct Vertex {
  vec2 at{0.0f};  ///< in the map, px
  bool wet = false, landed = false;
  bool with_right = false, with_below = false;  ///< belongs together with that neighbour
  Layer layer = Layer::grazing;
};

class Triangles {
 public:
  Triangles(const VirtualScreen& screen, const LightSource& light, const Image<LightLanding>& landings,
            const View& view, const SceneMap& solids, bool balanced)
      : screen_(screen),
        light_(light),
        landings_(landings),
        view_(view),
        balanced_(balanced),
        vertices_(screen.width, screen.height) {
    parallel_for(static_cast<std::size_t>(screen.height), 8, [&](std::size_t begin, std::size_t end) {
      for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
        for (int x = 0; x < screen.width; ++x) prepare(x, y, solids);
    });
  }

  /// The two triangles of the cell whose upper left point is (x, y).
  void add_cell(int x, int y, const Output& out) const {
    const Vertex &a = vertices_(x, y), &b = vertices_(x + 1, y), &c = vertices_(x, y + 1), &d = vertices_(x + 1, y + 1);
    if (!(a.wet || b.wet || c.wet || d.wet)) return;
    if (!balanced_ && a.layer == Layer::grazing && b.layer == Layer::grazing && c.layer == Layer::grazing &&
        d.layer == Layer::grazing)
      return;
    // Alternating diagonals: no direction is preferred.
    if ((x + y) % 2 == 0) {
      const bool across = together({x + 1, y}, {x, y + 1});
      add({x, y}, {x + 1, y}, {x, y + 1}, a.with_right && a.with_below && across, out);
      add({x + 1, y + 1}, {x, y + 1}, {x + 1, y}, c.with_right && b.with_below && across, out);
    } else {
      const bool across = together({x, y}, {x + 1, y + 1});
      add({x + 1, y}, {x + 1, y + 1}, {x, y}, a.with_right && b.with_below && across, out);
      add({x, y + 1}, {x, y}, {x + 1, y + 1}, c.with_right && a.with_below && across, out);
    }
  }

 private:
  struct Point {
    int x, y;
  };
  const LightLanding& landing(Point p) const { return landings_(p.x, p.y); }
  const Vertex& vertex(Point p) const { return vertices_(p.x, p.y); }

  void prepare(int x, int y, const SceneMap& solids) {
    const LightLanding& landing = landings_(x, y);
    Vertex& vertex = vertices_(x, y);
    vertex.wet = landing.state != LandingState::dry;
    vertex.landed = landing.state == LandingState::landed;
    if (!vertex.landed) return;
    vertex.with_right = x + 1 < screen_.width && together({x, y}, {x + 1, y});
    vertex.with_below = y + 1 < screen_.height && together({x, y}, {x, y + 1});
    if (!(-glm::dot(landing.normal, view_.forward) > kGrazingCosine)) return;
    const vec3 at = view_.project(landing.point);
    vertex.at = {at.x, at.y};
    const SceneMap::Hidden hidden = solids.hides(landing.point, landing.normal);
    vertex.layer = hidden.surely ? Layer::behind : hidden.perhaps ? Layer::both : Layer::seen;
  }

  /// Power that meets a triangle on the water.
  vec3 arriving(vec3 a, vec3 b, vec3 c) const {
    const vec3 middle = (a + b + c) / 3.0f;
    const float across = 0.5f * std::abs(glm::dot(glm::cross(b - a, c - a), light_.towards(middle)));
    return across * light_.irradiance(middle);
  }

  bool together(Point p, Point q) const {
    const LightLanding &a = landing(p), &b = landing(q);
    if (a.state != LandingState::landed || b.state != LandingState::landed || a.way != b.way) return false;
    const vec3 chord = b.from - a.from;
    const float length_squared = glm::dot(chord, chord);
    // Points stand no nearer to each other than across the view.
    const float least = least_step_squared(a.from);
    if (a.way != 0) {
      const vec3 apart = b.exit - a.exit;
      if (glm::dot(apart, apart) > kTorn * kTorn * std::max(least, length_squared)) return false;
    }
    if (length_squared <= kNear * kNear * least) return true;
    const vec3 step = screen_.beside(q.x, q.y, a.from) - a.from;
    if (length_squared <= kNear * kNear * glm::dot(step, step)) return true;
    const float limit = kSteepest * std::sqrt(length_squared);
    return std::abs(glm::dot(chord, screen_.seen.normal(p.x, p.y))) < limit &&
           std::abs(glm::dot(chord, screen_.seen.normal(q.x, q.y))) < limit;
  }

  float least_step_squared(vec3 point) const {
    const float step = std::min(screen_.step.x, screen_.step.y) *
                       screen_.view.pixel_size(glm::dot(point - screen_.view.eye, screen_.view.forward));
    return step * step;
  }

  /// @param joined  the corners belong together
  void add(Point a, Point b, Point c, bool joined, const Output& out) const {
    const Vertex &va = vertex(a), &vb = vertex(b), &vc = vertex(c);
    if (!(va.wet || vb.wet || vc.wet)) return;
    if (!balanced_ && va.layer == Layer::grazing && vb.layer == Layer::grazing && vc.layer == Layer::grazing) return;
    const Layer layer = common(va.layer, common(vb.layer, vc.layer));
    if (joined && (layer != Layer::grazing || (va.layer == vb.layer && vb.layer == vc.layer))) {
      const LightLanding &la = landing(a), &lb = landing(b), &lc = landing(c);
      const vec3 power = arriving(la.from, lb.from, lc.from) / 3.0f;
      const vec3 passed = la.covered * la.passed + lb.covered * lb.passed + lc.covered * lc.passed;
      if (balanced_)
        for (const LightLanding* corner : {&la, &lb, &lc}) account(power, *corner, layer, out.balance);
      if (layer == Layer::grazing) return;
      LightPolygon polygon;
      polygon.corner[0] = va.at;
      polygon.corner[1] = vb.at;
      polygon.corner[2] = vc.at;
      polygon.flux = power * passed;
      ++out.balance.triangles;
      out.draw(polygon, layer);
      return;
    }
    if (va.wet) add_shard(a, b, c, out);
    if (vb.wet) add_shard(b, c, a, out);
    if (vc.wet) add_shard(c, a, b, out);
  }

  /// The third of the triangle that is nearest to `a`, as if the water and the solid went on around it as they are
  /// there.
  void add_shard(Point a, Point b, Point c, const Output& out) const {
    const LightLanding& here = landing(a);
    const Vertex& v = vertex(a);
    if (!balanced_ && v.layer == Layer::grazing) return;
    const vec3 from = here.from;
    const vec3 to_b = screen_.beside(b.x, b.y, from) - from, to_c = screen_.beside(c.x, c.y, from) - from;
    const vec3 power = arriving(from, from + to_b, from + to_c) / 3.0f;
    account(power, here, v.layer, out.balance);
    if (v.layer == Layer::grazing) return;
    const vec3 b_on_solid = continued(a, b, from + to_b), c_on_solid = continued(a, c, from + to_c);
    const auto across = [&](vec3 offset) {
      const vec3 at = view_.project(here.point + offset);
      return vec2{at.x, at.y};
    };
    LightPolygon polygon;
    polygon.corners = 4;
    polygon.corner[0] = v.at;
    polygon.corner[1] = across(0.5f * b_on_solid);
    polygon.corner[2] = across((b_on_solid + c_on_solid) / 3.0f);
    polygon.corner[3] = across(0.5f * c_on_solid);
    polygon.flux = power * here.covered * here.passed;
    ++out.balance.shards;
    out.draw(polygon, v.layer);
  }

  /// From the landing of `a` to where light that enters at `b` would meet the plane of the solid at `a`: by its own way
  /// where the water goes on, else by one in parallel.
  /// @param beside  where the water would be at `b`
  vec3 continued(Point a, Point b, vec3 beside) const {
    const LightLanding &here = landing(a), &there = landing(b);
    const bool own = together(a, b) && glm::dot(there.direction, here.normal) < 0;
    const vec3 step = beside - here.from;
    // The rays of either point slide along themselves onto the plane.
    const vec3 offset = own ? there.point - here.point : step, direction = own ? there.direction : here.direction;
    const float towards = -glm::dot(direction, here.normal);
    if (!(towards > 0.05f)) return step;
    const vec3 slid = offset + direction * (glm::dot(offset, here.normal) / towards);
    // Nearly along the solid it may end anywhere.
    const float far = glm::length(slid), most = kLongest * glm::length(step);
    return far <= most ? slid : slid * (most / far);
  }

  /// @param power  that meets the point's part
  static void account(vec3 power, const LightLanding& landing, Layer layer, LightBalance& balance) {
    const double in = static_cast<double>(landing.covered * landing.transmittance) * sum(power);
    balance.entered += in;
    if (landing.state == LandingState::trapped)
      balance.trapped += in;
    else if (landing.state == LandingState::lost)
      balance.lost += in;
    else {
      const double out = static_cast<double>(landing.covered) * sum(power * landing.passed);
      const double kept = static_cast<double>(landing.later) * in;
      balance.mirrored += in - kept;
      balance.absorbed += kept - out;
      (layer == Layer::grazing ? balance.grazing : layer == Layer::behind ? balance.hidden : balance.drawn) += out;
    }
  }

  const VirtualScreen& screen_;
  const LightSource& light_;
  const Image<LightLanding>& landings_;
  const View& view_;
  bool balanced_;
  Image<Vertex> vertices_;
};

}  // namespace

void LightBalance::add(const LightBalance& other) {
  entered += other.entered;
  absorbed += other.absorbed;
  mirrored += other.mirrored;
  trapped += other.trapped;
  drawn += other.drawn;
  hidden += other.hidden;
  grazing += other.grazing;
  lost += other.lost;
  triangles += other.triangles;
  shards += other.shards;
}

TrianglesOfView caustics_triangles(const VirtualScreen& screen, const LightSource& light,
                                   const Image<LightLanding>& landings, const View& view, const SceneMap& solids,
                                   LightBalance* balance) {
  const Triangles triangles(screen, light, landings, view, solids, balance != nullptr);
  const int rows = std::max(0, screen.height - 1);
  const std::size_t count = static_cast<std::size_t>((rows + kRowsOfAList - 1) / kRowsOfAList);
  TrianglesOfView lists{PolygonLists(count), PolygonLists(count), false};
  std::vector<LightBalance> balances(count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l) {
      const int y0 = static_cast<int>(l) * kRowsOfAList, y1 = std::min(rows, y0 + kRowsOfAList);
      for (int y = y0; y < y1; ++y)
        for (int x = 0; x + 1 < screen.width; ++x)
          triangles.add_cell(x, y, {lists.seen[l], lists.behind[l], balances[l]});
    }
  });
  for (const auto& list : lists.behind) lists.any_behind = lists.any_behind || !list.empty();
  if (balance)
    for (const LightBalance& part : balances) balance->add(part);
  return lists;
}

}  // namespace meniscus
