#include "shading/virtual_eye_map.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace meniscus {
namespace {

constexpr std::size_t kTexels = static_cast<std::size_t>(CubeMap::kSide) * CubeMap::kSide;
/// A map is never larger than this.
constexpr std::size_t kMostBytes = std::size_t{512} << 20;
/// Stand for a tile that is being drawn and for one that holds nothing.
const std::array<MapTexel, kTexels> kBusy{}, kNothing{};

}  // namespace

CubeMap::CubeMap(int size, Draw draw)
    : size_(size),
      tiles_across_((size + kTile - 1) / kTile),
      draw_(std::move(draw)),
      tiles_(6 * static_cast<std::size_t>(tiles_across_) * static_cast<std::size_t>(tiles_across_)) {}

CubeMap::~CubeMap() {
  for (const auto& tile : tiles_)
    if (const Tile* held = tile.load(); held != &kNothing) delete held;
}

CubeMap::Cell CubeMap::at(vec3 direction) const {
  const vec3 size = glm::abs(direction);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int face = 2 * axis + (direction[axis] < 0 ? 1 : 0);
  const float half = 0.5f * static_cast<float>(size_), scale = half / size[axis];
  const float last = static_cast<float>(size_) - 1e-3f;
  const float u = std::clamp(direction[(axis + 1) % 3] * scale + half, 0.0f, last);
  const float v = std::clamp(direction[(axis + 2) % 3] * scale + half, 0.0f, last);
  const int x = std::min(static_cast<int>(u), size_ - 1), y = std::min(static_cast<int>(v), size_ - 1);
  const int row = face * tiles_across_ + y / kTile;
  const Tile* held = tile(static_cast<std::size_t>(row) * static_cast<std::size_t>(tiles_across_) +
                          static_cast<std::size_t>(x / kTile));
  if (!held) return {};
  return {held->data() + y % kTile * kSide + x % kTile, u - static_cast<float>(x), v - static_cast<float>(y)};
}

const CubeMap::Tile* CubeMap::tile(std::size_t index) const {
  const Tile* held = tiles_[index].load(std::memory_order_acquire);
  if (!held || held == &kBusy) [[unlikely]]
    held = draw_tile(index);
  return held == &kNothing ? nullptr : held;
}

const CubeMap::Tile* CubeMap::draw_tile(std::size_t index) const {
  std::atomic<const Tile*>& place = tiles_[index];
  const Tile* held = nullptr;
  if (!place.compare_exchange_strong(held, &kBusy, std::memory_order_acquire)) {
    while (held == &kBusy) {
      place.wait(&kBusy, std::memory_order_acquire);
      held = place.load(std::memory_order_acquire);
    }
    return held ? held : draw_tile(index);  // null: the other thread failed
  }
  const std::size_t across = static_cast<std::size_t>(tiles_across_);
  const int face = static_cast<int>(index / (across * across)), axis = face / 2;
  const int x0 = static_cast<int>(index % across) * kTile, y0 = static_cast<int>(index / across % across) * kTile;
  try {
    auto fresh = std::make_unique<Tile>();
    std::array<vec3, kTexels> directions;
    for (int k = 0; k < kSide * kSide; ++k) {
      vec3 direction;
      direction[axis] = face % 2 == 0 ? 1.0f : -1.0f;
      direction[(axis + 1) % 3] = static_cast<float>(2 * (x0 + k % kSide)) / static_cast<float>(size_) - 1.0f;
      direction[(axis + 2) % 3] = static_cast<float>(2 * (y0 + k / kSide)) / static_cast<float>(size_) - 1.0f;
      directions[static_cast<std::size_t>(k)] = glm::normalize(direction);
    }
    const bool filled = draw_(directions, *fresh);
    if (filled && filled_ * sizeof(Tile) > kMostBytes)
      throw Error(ErrorCode::limit_exceeded, {"the maps of virtual eyes need too much memory",
                                              "less than 512 MiB",
                                              "more",
                                              {},
                                              {},
                                              {},
                                              "choose smaller maps"});
    held = filled ? fresh.release() : &kNothing;
    ++drawn_;
    filled_ += filled;
  } catch (...) {
    place.store(nullptr, std::memory_order_release);
    place.notify_all();
    throw;
  }
  place.store(held, std::memory_order_release);
  place.notify_all();
  return held;
}

std::vector<std::size_t> map_layers(std::span<const Cone> cones) {
  std::vector<std::size_t> layers(cones.size());
  std::vector<std::vector<std::size_t>> held;  // cones of each layer
  for (std::size_t i = 0; i < cones.size(); ++i) {
    const auto meets = [&](std::size_t other) {
      const float cosine = std::clamp(glm::dot(cones[i].axis, cones[other].axis), -1.0f, 1.0f);
      return std::acos(cosine) < cones[i].half_angle + cones[other].half_angle;
    };
    std::size_t layer = 0;
    while (layer < held.size() && std::any_of(held[layer].begin(), held[layer].end(), meets)) ++layer;
    if (layer == held.size()) held.emplace_back();
    held[layer].push_back(i);
    layers[i] = layer;
  }
  return layers;
}

}  // namespace meniscus
