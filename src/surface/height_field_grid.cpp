#include "surface/height_field_grid.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "surface/height_field_axes.h"

namespace meniscus {

HeightField blank_field(Axis up, const Bounds& region, float step) {
  const FieldAxes axes(up);
  const auto fail = [](ErrorCode code, std::string problem, std::string expected, std::string found) {
    throw Error(code, ErrorDetail{std::move(problem), std::move(expected), std::move(found), {}, {}, {}, {}});
  };
  const vec3 extent = region.high - region.low;
  if (!std::isfinite(extent.x + extent.y + extent.z) || !(extent[axes.a] > 0) || !(extent[axes.b] > 0) ||
      !(extent[axes.up] >= 0))
    fail(ErrorCode::invalid_argument, "the region of a height field has no extent",
         "finite bounds, the lower below the higher", fmt::format("{} x {} x {} m", extent.x, extent.y, extent.z));
  if (!(step > 0) || !std::isfinite(step))
    fail(ErrorCode::invalid_argument, "the step of a height field is out of range", "more than 0 m",
         fmt::format("{} m", step));
  const auto cells = [&](float length) {
    // A step that fits the length but for rounding is kept.
    return std::max(1.0, std::ceil(static_cast<double>(length) / static_cast<double>(step) - 1e-4));
  };
  const double cells_a = cells(extent[axes.a]), cells_b = cells(extent[axes.b]);
  if ((cells_a + 1) * (cells_b + 1) > static_cast<double>(kMostColumns))
    fail(ErrorCode::limit_exceeded, "the height field would have too many columns",
         fmt::format("{} at most", kMostColumns), fmt::format("{:.0f} x {:.0f}", cells_a + 1, cells_b + 1));
  HeightField field;
  field.up = up;
  field.low = {region.low[axes.a], region.low[axes.b]};
  field.step = {static_cast<float>(static_cast<double>(extent[axes.a]) / cells_a),
                static_cast<float>(static_cast<double>(extent[axes.b]) / cells_b)};
  field.floor = region.low[axes.up];
  field.height = Image<float>(static_cast<int>(cells_a) + 1, static_cast<int>(cells_b) + 1,
                              -std::numeric_limits<float>::infinity());
  return field;
}

}  // namespace meniscus
