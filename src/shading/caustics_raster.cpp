#include "shading/caustics_raster.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace meniscus {
namespace {

/// Rows that one piece of work fills.
constexpr int kBandRows = 16;
/// Polygons of a smaller area, texels^2, are drawn as lines: their covered areas would be noise of rounding.
constexpr double kSliver = 1e-5;
/// Texels along a side of what is drawn in floats; the doubled area from which on their rounding does no harm.
constexpr int kSmall = 20;
constexpr float kSmallSliver = 1e-2f;
/// Thin polygons shorter than this are a point.
constexpr float kTiny = 0.3f;

/// Adds to one row: coverage as differences along x, so that the prefix sum is the covered area of each texel.
class Row {
 public:
  explicit Row(int width) : difference_(static_cast<std::size_t>(width) + 2) {}

  void clear(int first, int last) {
    std::fill(difference_.begin() + first, difference_.begin() + std::min<int>(last + 3, size()), 0.0);
    first_ = first;
    last_ = last;
  }

  /// The area to the right of a piece of an edge within the row. x0, x1 in [0, width]; dy signed.
  void add(double x0, double x1, double dy) {
    const double left = std::min(x0, x1), right = std::max(x0, x1);
    const int i0 = std::clamp(static_cast<int>(left), first_, last_);
    const int i1 = std::clamp(static_cast<int>(std::ceil(right)) - 1, i0, last_);
    if (i1 == i0) {
      const double middle = std::clamp(0.5 * (left + right) - i0, 0.0, 1.0);
      at(i0) += dy * (1.0 - middle);
      at(i0 + 1) += dy * middle;
      return;
    }
    // Covered area of column i by the edge's height profile: the integral of a ramp.
    const double slope = dy / (right - left);
    double before = 0;  // area that is already in the prefix sum
    for (int i = i0; i <= i1; ++i) {
      const double a = std::max(left, static_cast<double>(i)), b = std::min(right, i + 1.0);
      const double risen = slope * (a - left), rising = slope * (b - a);
      const double area = risen * (b - a) + 0.5 * rising * (b - a) + (risen + rising) * (i + 1.0 - b);
      at(i) += area - before;
      before = area;
    }
    at(i1 + 1) += dy - before;
  }

  void pour(vec3* texels, double scale, vec3 flux) const {
    double sum = 0;
    for (int i = first_; i <= last_; ++i) {
      sum += difference_[static_cast<std::size_t>(i)];
      texels[i] += static_cast<float>(std::abs(sum) * scale) * flux;
    }
  }

 private:
  int size() const { return static_cast<int>(difference_.size()); }
  double& at(int i) { return difference_[static_cast<std::size_t>(i)]; }
  std::vector<double> difference_;
  int first_ = 0, last_ = 0;
};

struct Polygon {
  vec2 corner[10];
  int corners = 0;
};

/// The part of the polygon where sign * (p[axis] - bound) >= 0.
Polygon clipped(const Polygon& polygon, int axis, float bound, float sign) {
  Polygon result;
  for (int i = 0; i < polygon.corners; ++i) {
    const vec2 a = polygon.corner[i], b = polygon.corner[(i + 1) % polygon.corners];
    const float da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
    if (da >= 0 && result.corners < 10) result.corner[result.corners++] = a;
    if ((da >= 0) != (db >= 0) && result.corners < 10) {
      vec2 cut = a + (da / (da - db)) * (b - a);
      cut[axis] = bound;
      result.corner[result.corners++] = cut;
    }
  }
  return result;
}

double area_of(const Polygon& polygon) {
  double doubled = 0;
  for (int i = 1; i + 1 < polygon.corners; ++i) {
    const glm::dvec2 u = glm::dvec2(polygon.corner[i]) - glm::dvec2(polygon.corner[0]);
    const glm::dvec2 v = glm::dvec2(polygon.corner[i + 1]) - glm::dvec2(polygon.corner[0]);
    doubled += u.x * v.y - u.y * v.x;
  }
  return 0.5 * std::abs(doubled);
}

/// A square of one texel around a point.
void add_square(vec2 point, vec3 flux, Image<vec3>& image, int top, int bottom) {
  const vec2 corner = point - 0.5f, base = glm::floor(corner), part = corner - base;
  for (int n = 0; n < 4; ++n) {
    const float x = base.x + static_cast<float>(n & 1), y = base.y + static_cast<float>(n >> 1);
    if (!(x >= 0 && x < static_cast<float>(image.width()) && y >= static_cast<float>(top) &&
          y < static_cast<float>(bottom)))
      continue;
    image(static_cast<int>(x), static_cast<int>(y)) +=
        flux * ((n & 1 ? part.x : 1.0f - part.x) * (n >> 1 ? part.y : 1.0f - part.y));
  }
}

/// A polygon of no area: its flux along its longest side, in points between texel centres.
void draw_line(const LightPolygon& polygon, Image<vec3>& image, int top, int bottom) {
  vec2 a = polygon.corner[0], b = a;
  float longest = -1;
  for (int i = 0; i < polygon.corners; ++i)
    for (int j = i + 1; j < polygon.corners; ++j)
      if (const vec2 side = polygon.corner[j] - polygon.corner[i]; glm::dot(side, side) > longest) {
        longest = glm::dot(side, side);
        a = polygon.corner[i];
        b = polygon.corner[j];
      }
  const int points = std::min(1 << 14, 1 + static_cast<int>(2.0f * std::sqrt(longest)));
  const vec3 share = polygon.flux / static_cast<float>(points);
  for (int k = 0; k < points; ++k)
    add_square(a + (static_cast<float>(k) + 0.5f) / static_cast<float>(points) * (b - a), share, image, top, bottom);
}

/// Polygons in a few texels, of which there are most: the same sums in floats beside their first texel.
/// @return  false: too large, or beside the image
bool draw_small(const LightPolygon& light, Image<vec3>& image, int top, int bottom) {
  const int corners = light.corners;
  vec2 low = light.corner[0], high = low;
  for (int i = 1; i < corners; ++i) {
    low = glm::min(low, light.corner[i]);
    high = glm::max(high, light.corner[i]);
  }
  if (!(low.x >= 0 && low.y >= 0 && high.x < static_cast<float>(image.width()) &&
        high.y < static_cast<float>(image.height())))
    return false;
  const int x0 = static_cast<int>(low.x), y0 = static_cast<int>(low.y);
  const int columns = static_cast<int>(high.x) - x0 + 1, rows = static_cast<int>(high.y) - y0 + 1;
  if (columns > kSmall || rows > kSmall) return false;
  const vec2 base{static_cast<float>(x0), static_cast<float>(y0)};
  vec2 corner[4];
  for (int i = 0; i < corners; ++i) corner[i] = light.corner[i] - base;
  float doubled = 0;
  for (int i = 1; i + 1 < corners; ++i) {
    const vec2 u = corner[i] - corner[0], v = corner[i + 1] - corner[0];
    doubled += u.x * v.y - u.y * v.x;
  }
  if (!(std::abs(doubled) > kSmallSliver)) {
    if (std::max(high.x - low.x, high.y - low.y) < kTiny)
      add_square(0.5f * (low + high), light.flux, image, top, bottom);
    else
      draw_line(light, image, top, bottom);
    return true;
  }
  const vec3 per_area = light.flux * (2.0f / doubled);

  // Differences along x of the covered area, one row for each of the texels.
  float difference[kSmall][kSmall + 1];
  for (int y = 0; y < rows; ++y) std::fill(difference[y], difference[y] + columns + 1, 0.0f);
  for (int i = 0; i < corners; ++i) {
    const vec2 a = corner[i], b = corner[i + 1 < corners ? i + 1 : 0];
    const float sign = a.y < b.y ? 1.0f : -1.0f;
    const vec2 upper = a.y < b.y ? a : b, lower = a.y < b.y ? b : a;
    const float height = lower.y - upper.y;
    if (!(height > 0)) continue;
    const float slope = (lower.x - upper.x) / height;
    const float left_end = std::min(a.x, b.x), right_end = std::max(a.x, b.x);
    const auto x_at = [&](float y) { return std::clamp(upper.x + slope * (y - upper.y), left_end, right_end); };
    float from = upper.y, x = upper.x;
    for (int y = static_cast<int>(from); from < lower.y; ++y) {
      const float to = std::min(lower.y, static_cast<float>(y + 1)), x_to = to < lower.y ? x_at(to) : lower.x;
      const float dy = sign * (to - from), left = std::min(x, x_to), right = std::max(x, x_to);
      float* row = difference[y];
      const int c0 = static_cast<int>(left), c1 = static_cast<int>(right);
      if (c0 == c1) {
        const float middle = 0.5f * (left + right) - static_cast<float>(c0);
        row[c0] += dy * (1.0f - middle);
        row[c0 + 1] += dy * middle;
      } else {
        const float rise = dy / (right - left);
        float before = 0;
        for (int c = c0; c <= c1; ++c) {
          const float at = static_cast<float>(c);
          const float p = std::max(left, at), q = std::min(right, at + 1.0f);
          const float risen = rise * (p - left), rising = rise * (q - p);
          const float area = (risen + 0.5f * rising) * (q - p) + (risen + rising) * (at + 1.0f - q);
          row[c] += area - before;
          before = area;
        }
        row[c1 + 1] += dy - before;
      }
      from = to;
      x = x_to;
    }
  }
  // One sign for all edges: with `doubled` positive the edges on the right go down.
  for (int y = std::max(0, top - y0); y < std::min(rows, bottom - y0); ++y) {
    vec3* texels = image.row(y0 + y) + x0;
    float sum = 0;
    for (int c = 0; c < columns; ++c) {
      sum += difference[y][c];
      texels[c] -= sum * per_area;
    }
  }
  return true;
}

void draw(const LightPolygon& light, Image<vec3>& image, int top, int bottom, Row& row) {
  if (draw_small(light, image, top, bottom)) return;
  Polygon polygon;
  polygon.corners = light.corners;
  std::copy(light.corner, light.corner + light.corners, polygon.corner);
  const double whole = area_of(polygon);
  if (!(whole > kSliver)) {
    draw_line(light, image, top, bottom);
    return;
  }
  vec2 low = polygon.corner[0], high = low;
  for (int i = 1; i < polygon.corners; ++i) {
    low = glm::min(low, polygon.corner[i]);
    high = glm::max(high, polygon.corner[i]);
  }
  const float width = static_cast<float>(image.width());
  if (low.x < 0) polygon = clipped(polygon, 0, 0.0f, 1.0f);
  if (high.x > width) polygon = clipped(polygon, 0, width, -1.0f);
  if (polygon.corners < 3) return;
  low.x = std::clamp(low.x, 0.0f, width);
  high.x = std::clamp(high.x, 0.0f, width);
  const int first = std::min(static_cast<int>(low.x), image.width() - 1);
  const int last = std::clamp(static_cast<int>(std::ceil(high.x)) - 1, first, image.width() - 1);
  const int y0 = std::max(top, static_cast<int>(std::floor(low.y)));
  const int y1 = std::min(bottom, static_cast<int>(std::ceil(high.y)));
  for (int y = y0; y < y1; ++y) {
    row.clear(first, last);
    for (int i = 0; i < polygon.corners; ++i) {
      const vec2 a = polygon.corner[i], b = polygon.corner[i + 1 < polygon.corners ? i + 1 : 0];
      const bool down = a.y < b.y;
      const vec2 upper = down ? a : b, lower = down ? b : a;
      const double from = std::max<double>(upper.y, y), to = std::min<double>(lower.y, y + 1.0);
      if (!(from < to)) continue;
      const double slope = (static_cast<double>(lower.x) - upper.x) / (static_cast<double>(lower.y) - upper.y);
      const auto x_at = [&](double at) {
        return std::clamp(upper.x + slope * (at - upper.y), static_cast<double>(low.x), static_cast<double>(high.x));
      };
      row.add(x_at(from), x_at(to), down ? to - from : from - to);
    }
    row.pour(image.row(y), 1.0 / whole, light.flux);
  }
}

}  // namespace

float doubled_area(const LightPolygon& polygon) {
  float doubled = 0;
  for (int i = 1; i + 1 < polygon.corners; ++i) {
    const vec2 u = polygon.corner[i] - polygon.corner[0], v = polygon.corner[i + 1] - polygon.corner[0];
    doubled += u.x * v.y - u.y * v.x;
  }
  return doubled;
}

namespace {

/// Draws polygons whose longer side along the axes is in [least, most), in texels of `scale` texels of theirs.
/// @return  whether there are any
bool draw_level(const std::vector<std::vector<LightPolygon>>& lists, Image<vec3>& image, float scale, float least,
                float most) {
  const std::size_t bands = static_cast<std::size_t>((image.height() + kBandRows - 1) / kBandRows);
  const float width = static_cast<float>(image.width()), height = static_cast<float>(image.height());
  // Which polygons touch which band, list by list and in their order.
  std::vector<std::vector<std::uint32_t>> touching(lists.size() * bands);
  parallel_for(lists.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t l = begin; l < end; ++l)
      for (std::size_t p = 0; p < lists[l].size(); ++p) {
        const LightPolygon& polygon = lists[l][p];
        vec2 low = polygon.corner[0], high = low;
        for (int i = 1; i < polygon.corners; ++i) {
          low = glm::min(low, polygon.corner[i]);
          high = glm::max(high, polygon.corner[i]);
        }
        const float side = std::max(high.x - low.x, high.y - low.y);
        low /= scale;
        high /= scale;
        // One texel more: lines are that wide. Corners that are not numbers fail all comparisons.
        if (!(side >= least && side < most && low.y - 1.0f < height && high.y + 1.0f > 0 && high.x + 1.0f > 0 &&
              low.x - 1.0f < width && glm::dot(polygon.flux, vec3{1.0f}) > 0))
          continue;
        const int first = static_cast<int>(std::max(low.y - 1.0f, 0.0f)) / kBandRows;
        const int last = std::min(image.height() - 1, static_cast<int>(std::min(high.y + 1.0f, height))) / kBandRows;
        for (int band = first; band <= last; ++band)
          touching[l * bands + static_cast<std::size_t>(band)].push_back(static_cast<std::uint32_t>(p));
      }
  });
  if (std::all_of(touching.begin(), touching.end(), [](const auto& list) { return list.empty(); })) return false;
  parallel_for(bands, 1, [&](std::size_t begin, std::size_t end) {
    Row row(image.width());
    for (std::size_t band = begin; band < end; ++band) {
      const int top = static_cast<int>(band) * kBandRows, bottom = std::min(top + kBandRows, image.height());
      for (std::size_t l = 0; l < lists.size(); ++l)
        for (const std::uint32_t p : touching[l * bands + band]) {
          LightPolygon polygon = lists[l][p];
          if (scale != 1.0f)
            for (vec2& corner : polygon.corner) corner /= scale;
          draw(polygon, image, top, bottom, row);
        }
    }
  });
  return true;
}

/// Adds a picture of texels `factor` times as large, linear between their centres.
void add_coarse(const Image<vec3>& coarse, int factor, Image<vec3>& image) {
  const float scale = 1.0f / static_cast<float>(factor), share = scale * scale;
  const auto place = [&](int x, int count, int& first, int& next) {
    const float at = (static_cast<float>(x) + 0.5f) * scale - 0.5f;
    const int i = static_cast<int>(std::floor(at));
    first = std::clamp(i, 0, count - 1);
    next = std::clamp(i + 1, 0, count - 1);
    return at - static_cast<float>(i);
  };
  parallel_for(static_cast<std::size_t>(image.height()), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      int j = 0, j1 = 0;
      const float t = place(y, coarse.height(), j, j1);
      for (int x = 0; x < image.width(); ++x) {
        int i = 0, i1 = 0;
        const float s = place(x, coarse.width(), i, i1);
        image(x, y) += share * ((1.0f - t) * ((1.0f - s) * coarse(i, j) + s * coarse(i1, j)) +
                                t * ((1.0f - s) * coarse(i, j1) + s * coarse(i1, j1)));
      }
    }
  });
}

}  // namespace

void draw_polygons(const std::vector<std::vector<LightPolygon>>& lists, Image<vec3>& image) {
  if (!image.empty()) draw_level(lists, image, 1.0f, 0.0f, std::numeric_limits<float>::infinity());
}

void draw_light(const std::vector<std::vector<LightPolygon>>& lists, Image<vec3>& image) {
  if (image.empty()) return;
  constexpr float kFew = 18.0f;
  draw_level(lists, image, 1.0f, 0.0f, kFew);
  for (int factor = 4; factor <= 64; factor *= 4) {
    Image<vec3> coarse((image.width() + factor - 1) / factor, (image.height() + factor - 1) / factor);
    const float scale = static_cast<float>(factor), least = 0.25f * scale * kFew;
    const float most = factor == 64 ? std::numeric_limits<float>::infinity() : scale * kFew;
    if (draw_level(lists, coarse, scale, least, most)) add_coarse(coarse, factor, image);
  }
}

}  // namespace meniscus
