/// The ground's cells and the water on and in them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/field_axes.h"
#include "meniscus/sim.h"
#include "sim/ground_cells.h"
#include "sim/ground_constants.h"

namespace meniscus {

WetGround::WetGround(GroundOptions options) : options_(std::move(options)) {
  const GroundSize size = checked_ground_size(options_);
  width_ = size.width;
  height_ = size.height;
  material_ = ground_materials(options_, size);
  bed_ = ground_heights(options_, size, material_);
  depth_.assign(bed_.size(), 0.0);
  soaked_.assign(bed_.size(), 0.0);
}

std::optional<std::size_t> WetGround::cell_at(vec3 point) const {
  const FieldAxes axes(options_.up);
  const double cell = options_.cell;
  const double i = (static_cast<double>(point[axes.a]) - static_cast<double>(options_.low.x)) / cell;
  const double j = (static_cast<double>(point[axes.b]) - static_cast<double>(options_.low.y)) / cell;
  if (!(i >= 0 && j >= 0 && i <= width_ && j <= height_)) return std::nullopt;
  const auto column = static_cast<std::size_t>(std::min(static_cast<int>(i), width_ - 1));
  const auto row = static_cast<std::size_t>(std::min(static_cast<int>(j), height_ - 1));
  return column + row * static_cast<std::size_t>(width_);
}

vec3 WetGround::place(std::size_t cell) const {
  const std::size_t width = static_cast<std::size_t>(width_);
  const float a = static_cast<float>(cell % width) + 0.5f, b = static_cast<float>(cell / width) + 0.5f;
  return FieldAxes(options_.up)
      .place(options_.low.x + a * options_.cell, options_.low.y + b * options_.cell, bed_[cell]);
}

double WetGround::capacity(std::size_t cell) const { return traits_of(material_[cell]).capacity; }

Wetness WetGround::wetness(std::size_t cell) const {
  const double depth = depth_[cell];
  if (depth >= 0.010) return Wetness::puddle_10mm;
  if (depth >= 0.005) return Wetness::puddle_5mm;
  if (depth >= 0.003) return Wetness::puddle_3mm;
  const double room = capacity(cell);
  const bool dry = room > 0 ? soaked_[cell] < room : depth < kLeastFilm;
  return dry ? Wetness::dry : Wetness::wet;
}

double WetGround::soak(std::size_t cell, double depth) {
  const double capacity = this->capacity(cell), room = capacity - soaked_[cell];
  if (room <= 0) return depth;
  if (depth < room) {
    soaked_[cell] += depth;
    return 0;
  }
  soaked_[cell] = capacity;
  return depth - room;
}

void WetGround::rain(double depth) {
  if (!(depth >= 0 && depth <= kMostWater))
    throw Error(ErrorCode::invalid_argument, {"the rain's depth is out of range",
                                              fmt::format("0 to {:g} m", kMostWater),
                                              fmt::format("{:g} m", depth),
                                              {},
                                              {},
                                              {},
                                              {}});
  if (depth == 0) return;
  const double cell = options_.cell;
  fallen_ += depth * cell * cell * static_cast<double>(size());
  parallel_for(size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) depth_[c] += soak(c, depth);
  });
  stir_all();
}

WaterBudget WetGround::budget() const {
  const double area = static_cast<double>(options_.cell) * static_cast<double>(options_.cell);
  WaterBudget budget;
  for (std::size_t c = 0; c < size(); ++c) {
    budget.soaked += soaked_[c];
    budget.standing += depth_[c];
  }
  budget.soaked *= area;
  budget.standing *= area;
  budget.fallen = fallen_;
  budget.drained = drained_;
  return budget;
}

}  // namespace meniscus
