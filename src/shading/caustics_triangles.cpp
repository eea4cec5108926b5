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

double sum(vec3 v) { return static_cast<double>(v.x) + static_cast<double>(v.y) + static_cast<double>(v.z); }

/// What a point of the screen is for a map.
struct Vertex {
  vec2 at{0.0f};  ///< in the map, px
  bool wet = false, landed = false, drawn = false;
};

class Triangles {
 public:
  Triangles(const VirtualScreen& screen, const LightSource& light, const Image<Landing>& landings, const View& view,
            const SceneMap& solids)
      : screen_(screen), light_(light), landings_(landings), view_(view), vertices_(screen.width, screen.height) {
    parallel_for(vertices_.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Landing& landing = landings_[i];
        Vertex& vertex = vertices_[i];
        vertex.wet = landing.state != LandingState::dry;
        vertex.landed = landing.state == LandingState::landed;
        if (!vertex.landed) continue;
        const vec3 at = view_.project(landing.point);
        vertex.at = {at.x, at.y};
        vertex.drawn =
            -glm::dot(landing.normal, view_.forward) > kGrazingCosine && !solids.hides(landing.point, landing.normal);
      }
    });
  }

  /// The two triangles of the cell whose upper left point is (x, y).
  void add_cell(int x, int y, std::vector<LightPolygon>& list, LightBalance& balance) const {
    // Alternating diagonals: no direction is preferred.
    if ((x + y) % 2 == 0) {
      add({x, y}, {x + 1, y}, {x, y + 1}, list, balance);
      add({x + 1, y + 1}, {x, y + 1}, {x + 1, y}, list, balance);
    } else {
      add({x + 1, y}, {x + 1, y + 1}, {x, y}, list, balance);
      add({x, y + 1}, {x, y}, {x + 1, y + 1}, list, balance);
    }
  }

 private:
  struct Point {
    int x, y;
  };
  const Landing& landing(Point p) const { return landings_(p.x, p.y); }
  const Vertex& vertex(Point p) const { return vertices_(p.x, p.y); }

  /// Power that meets a triangle on the water.
  vec3 arriving(vec3 a, vec3 b, vec3 c) const {
    const vec3 middle = (a + b + c) / 3.0f;
    const float across = 0.5f * std::abs(glm::dot(glm::cross(b - a, c - a), light_.towards(middle)));
    return across * light_.irradiance(middle);
  }

  bool together(Point p, Point q) const {
    const Landing &a = landing(p), &b = landing(q);
    if (a.left != b.left) return false;
    const vec3 chord = b.from - a.from;
    const float length_squared = glm::dot(chord, chord);
    const vec3 step = screen_.beside(q.x, q.y, a.from) - a.from;
    if (length_squared <= kNear * kNear * glm::dot(step, step)) return true;
    const float limit = kSteepest * std::sqrt(length_squared);
    return std::abs(glm::dot(chord, screen_.seen.normal(p.x, p.y))) < limit &&
           std::abs(glm::dot(chord, screen_.seen.normal(q.x, q.y))) < limit;
  }

  void add(Point a, Point b, Point c, std::vector<LightPolygon>& list, LightBalance& balance) const {
    const Vertex &va = vertex(a), &vb = vertex(b), &vc = vertex(c);
    if (!(va.wet || vb.wet || vc.wet)) return;
    if (va.landed && vb.landed && vc.landed && together(a, b) && together(b, c) && together(c, a) &&
        va.drawn == vb.drawn && vb.drawn == vc.drawn) {
      const Landing &la = landing(a), &lb = landing(b), &lc = landing(c);
      const vec3 power = arriving(la.from, lb.from, lc.from);
      const vec3 passed = (la.passed + lb.passed + lc.passed) / 3.0f;
      account(power, passed, (entering(la) + entering(lb) + entering(lc)) / 3.0f, va.drawn, balance);
      if (!va.drawn) return;
      LightPolygon polygon;
      polygon.corner[0] = va.at;
      polygon.corner[1] = vb.at;
      polygon.corner[2] = vc.at;
      polygon.flux = power * passed;
      ++balance.triangles;
      list.push_back(polygon);
      return;
    }
    if (va.wet) add_shard(a, b, c, list, balance);
    if (vb.wet) add_shard(b, c, a, list, balance);
    if (vc.wet) add_shard(c, a, b, list, balance);
  }

  /// The third of the triangle that is nearest to `a`, as if the water and the solid went on around it as they are
  /// there.
  void add_shard(Point a, Point b, Point c, std::vector<LightPolygon>& list, LightBalance& balance) const {
    const Landing& here = landing(a);
    const vec3 from = here.state == LandingState::landed ? here.from : screen_.point(a.x, a.y);
    const vec3 to_b = screen_.beside(b.x, b.y, from) - from, to_c = screen_.beside(c.x, c.y, from) - from;
    const vec3 power = arriving(from, from + to_b, from + to_c) / 3.0f;
    const Vertex& v = vertex(a);
    if (!v.landed) {
      balance.lost += sum(power * here.transmittance);
      balance.entered += sum(power * here.transmittance);
      return;
    }
    account(power, here.passed, entering(here), v.drawn, balance);
    if (!v.drawn) return;
    const auto across = [&](vec3 offset) {
      const vec3 at = view_.project(here.point + offset);
      return vec2{at.x, at.y};
    };
    LightPolygon polygon;
    polygon.corners = 4;
    polygon.corner[0] = v.at;
    polygon.corner[1] = across(0.5f * to_b);
    polygon.corner[2] = across((to_b + to_c) / 3.0f);
    polygon.corner[3] = across(0.5f * to_c);
    polygon.flux = power * here.passed;
    ++balance.shards;
    list.push_back(polygon);
  }

  /// The part of the arriving light that enters: none in a solid's shadow.
  static float entering(const Landing& landing) { return landing.passed == vec3{0.0f} ? 0.0f : landing.transmittance; }

  static void account(vec3 power, vec3 passed, float entering, bool drawn, LightBalance& balance) {
    const double in = sum(power * entering), out = sum(power * passed);
    balance.entered += in;
    balance.absorbed += in - out;
    (drawn ? balance.drawn : balance.hidden) += out;
  }

  const VirtualScreen& screen_;
  const LightSource& light_;
  const Image<Landing>& landings_;
  const View& view_;
  Image<Vertex> vertices_;
};

}  // namespace

void LightBalance::add(const LightBalance& other) {
  entered += other.entered;
  absorbed += other.absorbed;
  drawn += other.drawn;
  hidden += other.hidden;
  lost += other.lost;
  triangles += other.triangles;
  shards += other.shards;
}

std::vector<std::vector<LightPolygon>> caustics_triangles(const VirtualScreen& screen, const LightSource& light,
                                                          const Image<Landing>& landings, const View& view,
                                                          const SceneMap& solids, LightBalance* balance) {
  const Triangles triangles(screen, light, landings, view, solids);
  const int rows = std::max(0, screen.height - 1);
  const std::size_t count = static_cast<std::size_t>((rows + kRowsOfAList - 1) / kRowsOfAList);
  std::vector<std::vector<LightPolygon>> lists(count);
  std::vector<LightBalance> balances(count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l) {
      const int y0 = static_cast<int>(l) * kRowsOfAList, y1 = std::min(rows, y0 + kRowsOfAList);
      lists[l].reserve(static_cast<std::size_t>(2 * (y1 - y0) * screen.width));
      for (int y = y0; y < y1; ++y)
        for (int x = 0; x + 1 < screen.width; ++x) triangles.add_cell(x, y, lists[l], balances[l]);
    }
  });
  if (balance)
    for (const LightBalance& part : balances) balance->add(part);
  return lists;
}

}  // namespace meniscus
