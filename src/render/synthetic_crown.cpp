#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "meniscus/render.h"
#include "render/crown_shape.h"

namespace meniscus {
namespace {

constexpr std::size_t kFewest = 1000;
constexpr float kJitter = 0.2f;  ///< spacings
constexpr double kPi = 3.14159265358979323846;

/// Runs body(row) for all rows, in parallel.
template <class Body>
void for_each_row(std::size_t rows, const Body& body) {
  parallel_for(rows, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) body(row);
  });
}

/// Where the points of each row begin, and after the last the number of all.
std::vector<std::size_t> starts_of(const std::vector<std::size_t>& counts) {
  std::vector<std::size_t> starts(counts.size() + 1, 0);
  std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
  return starts;
}

/// Writes points one after another from a place on, each displaced a little.
class Writer {
 public:
  Writer(Particles& particles, std::size_t from, float spacing, std::uint64_t seed, std::uint64_t row)
      : particles_(particles), at_(from), jitter_(2 * kJitter * spacing * 0x1p-21f), draws_(seed, row) {}
  void operator()(vec3 p) {
    const std::uint64_t bits = draws_.bits();  // 21 bits an axis
    const auto moved = [&](float place, int shift) {
      const auto part = static_cast<std::int64_t>(bits >> shift & 0x1fffff) - 0x100000;
      return place + jitter_ * static_cast<float>(part);
    };
    particles_.x[at_] = moved(p.x, 0);
    particles_.y[at_] = moved(p.y, 21);
    particles_.z[at_] = moved(p.z, 42);
    ++at_;
  }

 private:
  Particles& particles_;
  std::size_t at_;
  float jitter_;
  Draws draws_;
};

/// The pool: columns in rows along x, the particles of each stretched between the floor and its height.
class Pool {
 public:
  explicit Pool(float spacing)
      : side_(std::max<std::size_t>(2, static_cast<std::size_t>(std::lround(2 * kPoolHalf / spacing)))),
        step_(2 * kPoolHalf / static_cast<float>(side_)),
        layer_(spacing * spacing * spacing / (step_ * step_)),
        heights_(side_ * side_) {
    for_each_row(side_, [&](std::size_t j) {
      for (std::size_t i = 0; i < side_; ++i) heights_[j * side_ + i] = crown_pool_height(place(i), place(j));
    });
  }
  std::size_t side() const { return side_; }
  float step() const { return step_; }
  float place(std::size_t i) const { return (static_cast<float>(i) + 0.5f) * step_ - kPoolHalf; }
  float height(std::size_t i, std::size_t j) const { return heights_[j * side_ + i]; }
  /// Particles in a column, when `more` of a layer is added to every column's height before it is rounded.
  std::size_t in_column(std::size_t i, std::size_t j, float more) const {
    return static_cast<std::size_t>(std::max(1.0f, height(i, j) / layer_ + more));
  }
  std::vector<std::size_t> in_rows(float more) const {
    std::vector<std::size_t> counts(side_, 0);
    for_each_row(side_, [&](std::size_t j) {
      for (std::size_t i = 0; i < side_; ++i) counts[j] += in_column(i, j, more);
    });
    return counts;
  }

 private:
  std::size_t side_;
  float step_;   ///< m between columns
  float layer_;  ///< m between the particles of a column, about
  std::vector<float> heights_;
};

/// The sheet: rows around the axis, one behind the other up the sheet and through it.
class Sheet {
 public:
  Sheet(const CrownShape& shape, float spacing)
      : shape_(shape),
        spacing_(spacing),
        rows_(static_cast<std::size_t>(std::max(2L, std::lround(shape.length() / spacing)))) {}
  std::size_t rows() const { return rows_; }
  /// Calls body(point) for the points of a row.
  template <class Body>
  void for_each(std::size_t row, const Body& body) const {
    const float v = (static_cast<float>(row) + 0.5f) / static_cast<float>(rows_);
    const CrownShape::Profile middle = shape_.profile(v);
    const float thickness = shape_.thickness(v);
    const auto layers = std::max(3L, std::lround(thickness / spacing_));
    for (long layer = 0; layer < layers; ++layer) {
      const float off = ((static_cast<float>(layer) + 0.5f) / static_cast<float>(layers) - 0.5f) * thickness;
      const double r = middle.r + off * middle.nr;
      const float y = middle.y + off * middle.ny;
      const long around = std::max(3L, std::lround(2 * kPi * r / spacing_));
      for (long i = 0; i < around; ++i) {
        const double angle =
            2 * kPi * (static_cast<double>(i) + 0.5 * static_cast<double>(row % 2)) / static_cast<double>(around);
        const vec3 point(r * std::cos(angle), y, r * std::sin(angle));
        if (v < shape_.end(static_cast<float>(angle)) &&
            point.y > crown_pool_height(point.x, point.z) + 0.5f * spacing_)
          body(point);
      }
    }
  }

 private:
  const CrownShape& shape_;
  float spacing_;
  std::size_t rows_;
};

/// Rim, jets and drops: the points of a lattice that are in a ball, over the pool and not in the sheet. A row is a
/// plane of constant z.
class Balls {
 public:
  Balls(const CrownShape& shape, float spacing) : shape_(shape), spacing_(spacing) {
    for (const CrownBall& ball : shape.balls()) {
      least_ = std::min(least_, index(ball.centre.z - ball.radius));
      rows_ = std::max(rows_, index(ball.centre.z + ball.radius) + 1);
    }
  }
  std::size_t rows() const { return static_cast<std::size_t>(rows_ - least_); }
  template <class Body>
  void for_each(std::size_t row, const Body& body) const {
    const float z = place(least_ + static_cast<long>(row));
    // What each column of the plane has in each ball, in order of columns, then from below.
    struct Piece {
      long i;
      float low, high;
    };
    std::vector<Piece> pieces;
    for (const CrownBall& ball : shape_.balls()) {
      const float across = ball.radius * ball.radius - (z - ball.centre.z) * (z - ball.centre.z);
      if (across <= 0) continue;
      const float reach = std::sqrt(across);
      for (long i = index(ball.centre.x - reach); i <= index(ball.centre.x + reach); ++i) {
        const float left = across - (place(i) - ball.centre.x) * (place(i) - ball.centre.x);
        if (left <= 0) continue;
        const float half = std::sqrt(left);
        pieces.push_back({i, ball.centre.y - half, ball.centre.y + half});
      }
    }
    std::sort(pieces.begin(), pieces.end(),
              [](const Piece& a, const Piece& b) { return a.i != b.i ? a.i < b.i : a.low < b.low; });
    long column = std::numeric_limits<long>::min(), next = 0;
    for (const Piece& piece : pieces) {
      const auto first = static_cast<long>(std::ceil(piece.low / spacing_ - 0.5f));
      const auto last = static_cast<long>(std::floor(piece.high / spacing_ - 0.5f));
      if (piece.i != column) next = first;
      column = piece.i;
      for (long k = std::max(first, next); k <= last; ++k) {
        const vec3 point(place(piece.i), place(k), z);
        if (point.y > crown_pool_height(point.x, point.z) + 0.5f * spacing_ && !shape_.near_sheet(point)) body(point);
      }
      next = std::max(next, last + 1);
    }
  }

 private:
  long index(float at) const { return static_cast<long>(std::floor(at / spacing_)); }
  float place(long i) const { return (static_cast<float>(i) + 0.5f) * spacing_; }

  const CrownShape& shape_;
  float spacing_;
  long least_ = std::numeric_limits<long>::max(), rows_ = std::numeric_limits<long>::min();
};

template <class Part>
std::vector<std::size_t> in_rows(const Part& part) {
  std::vector<std::size_t> counts(part.rows(), 0);
  for_each_row(part.rows(), [&](std::size_t row) { part.for_each(row, [&](vec3) { ++counts[row]; }); });
  return counts;
}

std::size_t total(const std::vector<std::size_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

/// m^3 in the pool, by the middles of squares.
double pool_volume() {
  constexpr int kSquares = 512;
  constexpr double kEdge = 2.0 * kPoolHalf / kSquares;
  double sum = 0;
  for (int j = 0; j < kSquares; ++j)
    for (int i = 0; i < kSquares; ++i)
      sum += crown_pool_height(static_cast<float>((i + 0.5) * kEdge) - kPoolHalf,
                               static_cast<float>((j + 0.5) * kEdge) - kPoolHalf);
  return sum * kEdge * kEdge;
}

/// The spacing at which `count` particles fill the shape. Sheet and drops hold more where the spacing is coarser than
/// they are, so that it is approached in steps.
float spacing_for(std::size_t count, std::uint64_t seed) {
  const double pool = pool_volume();
  const auto many = static_cast<double>(count);
  double spacing = std::cbrt(pool / many);
  for (int i = 0; i < 4; ++i) {
    // The volume of sheet and drops hardly changes where the spacing is fine: a coarser one tells it.
    const auto at = static_cast<float>(std::max(spacing, i < 2 ? 0.006 : 0.004));
    const CrownShape shape(at, seed);
    const auto above = static_cast<double>(total(in_rows(Sheet(shape, at))) + total(in_rows(Balls(shape, at))));
    spacing = std::cbrt((pool + above * std::pow(static_cast<double>(at), 3.0)) / many);
  }
  return static_cast<float>(spacing);
}

}  // namespace

Particles synthetic_crown(std::size_t count, std::uint64_t seed) {
  if (count < kFewest)
    throw Error(
        ErrorCode::invalid_argument,
        {"a crown of too few particles", fmt::format("{} or more", kFewest), std::to_string(count), {}, {}, {}, {}});
  const float spacing = spacing_for(count, seed);
  const CrownShape shape(spacing, seed);
  const Pool pool(spacing);
  const Sheet sheet(shape, spacing);
  const Balls balls(shape, spacing);
  const std::vector<std::size_t> in_sheet = in_rows(sheet), in_balls = in_rows(balls);
  const std::size_t above = total(in_sheet) + total(in_balls);

  // What is left is the pool's: each column's particles are rounded up from the part of a layer that gives enough in
  // all. Few columns are that close to the next whole layer that some of their floor's particles must be left out.
  const std::size_t left = count - above;
  float low = -8, high = 8;
  while (total(pool.in_rows(high)) < left) high *= 2;
  for (int i = 0; i < 28; ++i) {
    const float middle = 0.5f * (low + high);
    (total(pool.in_rows(middle)) < left ? low : high) = middle;
  }
  std::vector<std::size_t> in_pool = pool.in_rows(high);
  std::size_t excess = total(in_pool) - left;
  std::vector<std::size_t> left_out(pool.side(), 0);  // of each row, one of each of its first columns
  for (std::size_t j = 0; j < pool.side() && excess > 0; ++j) {
    left_out[j] = std::min(excess, pool.side());
    in_pool[j] -= left_out[j];
    excess -= left_out[j];
  }

  Particles particles;
  particles.format = "synthetic";
  particles.spacing = spacing;
  particles.up = Axis::y;
  for (auto* axis : {&particles.x, &particles.y, &particles.z}) axis->resize(count);
  const std::vector<std::size_t> pool_starts = starts_of(in_pool);
  for_each_row(pool.side(), [&](std::size_t j) {
    Writer write(particles, pool_starts[j], spacing, seed, j);
    for (std::size_t i = 0; i < pool.side(); ++i) {
      const std::size_t layers = pool.in_column(i, j, high) - (i < left_out[j] ? 1 : 0);
      const float layer = pool.height(i, j) / static_cast<float>(layers);
      for (std::size_t k = 0; k < layers; ++k)
        write({pool.place(i), (static_cast<float>(k) + 0.5f) * layer, pool.place(j)});
    }
  });
  const auto write_part = [&](const auto& part, const std::vector<std::size_t>& counts, std::size_t from,
                              std::uint64_t part_seed) {
    const std::vector<std::size_t> starts = starts_of(counts);
    for_each_row(part.rows(), [&](std::size_t row) {
      Writer write(particles, from + starts[row], spacing, part_seed, row);
      part.for_each(row, [&](vec3 point) { write(point); });
    });
  };
  write_part(sheet, in_sheet, left, mixed(seed ^ 1));
  write_part(balls, in_balls, left + total(in_sheet), mixed(seed ^ 2));
  return particles;
}

View crown_view(int width, int height) {
  const float elevation = 0.71f, azimuth = 0.20f;  // radians
  const vec3 towards(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                     std::cos(elevation) * std::cos(azimuth));
  const vec3 target(-0.149f, 0.19f, 0.030f);  // the middle of what is seen of the pool, whose near corner is the right
  return perspective_view(target + 4.25f * towards, target, {0, 1, 0}, 0.56f, width, height);
}

}  // namespace meniscus
