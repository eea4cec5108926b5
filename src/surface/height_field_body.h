/// The water between a floor and the heights of a field, as rays meet it.
#pragma once

#include <cstdint>
#include <vector>

#include "meniscus/surface.h"

namespace meniscus {

/// What a ray goes through when it comes into the water or out of it.
enum class Face : std::uint8_t {
  none,
  top,     ///< the heights
  side_a,  ///< the field's border across a
  side_b,  ///< the field's border across b
  hole,    ///< the border of a hole
  floor,
  start,  ///< the ray begins there
};

/// A ray in the field's own coordinates: columns along a and b, m along up; t stays in m along the ray.
struct FieldRay {
  double a, b, z;     ///< at t = 0
  double da, db, dz;  ///< per m
};

/// A stretch of a ray in the box around the water.
struct FieldStretch {
  double begin = 0, end = -1;  ///< m; nothing when end < begin
  Face first = Face::none, last = Face::none;
  bool found() const { return begin <= end; }
};

/// Where a ray changes sides.
struct FieldChange {
  double t = std::numeric_limits<double>::infinity();  ///< m; infinity: nowhere
  Face face = Face::none;
  bool found() const { return t < std::numeric_limits<double>::infinity(); }
};

/// The body of water: over each cell of four points from the floor to the bilinear patch through their heights, as far
/// as the bilinear mean of "is water" of the four points is at least one half. Points of a hole beside water take the
/// mean height of the water around them, so that the patches join.
///
/// Along a ray both a patch and the border of a hole are quadratic in t: crossings are the roots, in double precision.
/// Cells are skipped by a pyramid of least and greatest heights [Tevs2008].
class HeightFieldBody {
 public:
  explicit HeightFieldBody(const HeightField& field);

  /// Where the field lies: its axes in a vec3, its first point in m and columns per m.
  struct Frame {
    int a = 0, b = 2, up = 1;
    double low_a = 0, low_b = 0, per_a = 1, per_b = 1;
  };
  const Frame& frame() const { return frame_; }

  bool empty() const { return cells_a_ == 0; }
  int cells_a() const { return cells_a_; }
  int cells_b() const { return cells_b_; }
  float floor() const { return floor_; }
  float top() const { return top_; }
  bool has_holes() const { return holes_; }
  /// Heights of all points, those beside water filled in; row by row.
  const std::vector<float>& heights() const { return heights_; }

  FieldRay field_ray(const Ray& ray) const;
  /// The part of [from, limit] in the box of the water.
  FieldStretch clipped(const FieldRay& ray, double from, double limit) const;
  bool inside(const FieldRay& ray, double t) const;
  /// The first place in [t, end], within the box, that is in the water (or out of it, inside == false). At t itself the
  /// face is `start`.
  FieldChange first(const FieldRay& ray, double t, double end, bool inside) const;
  /// Water in [t, end], m.
  double length(const FieldRay& ray, double t, double end) const;

  /// Least and greatest height of a block of 2^level x 2^level cells; low is -infinity unless all of it is water.
  struct Block {
    float low, high;
  };
  struct Level {
    int width = 0, height = 0;
    std::vector<Block> blocks;
  };
  const std::vector<Level>& levels() const { return levels_; }
  /// How much of a cell is water.
  enum Kind : std::uint8_t { dry, cut, full };
  Kind kind(int i, int j) const { return kinds_[cell_index(i, j)]; }
  /// 1 at points of water, 0 in holes.
  const std::vector<std::uint8_t>& water() const { return water_; }

 private:
  struct Cell;
  std::size_t cell_index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(cells_a_) + static_cast<std::size_t>(i);
  }
  void fill_beside_water();
  void make_cells();
  void make_levels();
  Cell cell(const FieldRay& ray, int i, int j, double t) const;
  template <class Policy>
  void traverse(const FieldRay& ray, double t, double end, Policy& policy) const;

  int cells_a_ = 0, cells_b_ = 0;
  float floor_ = 0, top_ = 0;
  bool holes_ = false;
  Frame frame_;
  std::vector<float> heights_;
  std::vector<std::uint8_t> water_;
  std::vector<Kind> kinds_;
  std::vector<Level> levels_;
};

}  // namespace meniscus
