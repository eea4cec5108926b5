#include "io/fluid.h"

#include <algorithm>
#include <atomic>

#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr std::size_t kGrain = 1 << 16;
constexpr float kFluidType = 3;
constexpr float kFirstBoundaryMk = 10;
constexpr float kMostMk = 65535;

/// The attribute of one component of that name, in any case.
const Attribute* scalar_of(const Particles& particles, std::string_view name) {
  for (const Attribute& attribute : particles.attributes)
    if (attribute.components == 1 && lower(attribute.name) == name) return &attribute;
  return nullptr;
}

/// Whether all values are whole numbers from 0 to `most`.
bool are_classes(const std::vector<float>& values, float most) {
  std::atomic<bool> all{true};
  parallel_for(values.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float value = values[i];
      if (!(value >= 0 && value <= most && value == static_cast<float>(static_cast<int>(value)))) {
        all.store(false, std::memory_order_relaxed);
        return;
      }
    }
  });
  return all;
}

template <class IsFluid>
std::vector<std::uint8_t> marked(const std::vector<float>& values, IsFluid is_fluid) {
  std::vector<std::uint8_t> marks(values.size());
  parallel_for(values.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) marks[i] = is_fluid(values[i]) ? 1 : 0;
  });
  return marks;
}

}  // namespace

std::optional<FluidChoice> choose_fluid(const Particles& particles, bool& boundaries_only) {
  boundaries_only = false;
  if (particles.empty()) return std::nullopt;
  FluidChoice choice;
  const Attribute* type = scalar_of(particles, "type");
  const Attribute* mk = scalar_of(particles, "mk");
  const Attribute* tag = scalar_of(particles, "tag");
  const Attribute* part = scalar_of(particles, "part type");
  // Other programs have a type, too: here it is DualSPHysics' if it is written as that writes it, or beside its others.
  const bool is_type = type != nullptr && (type->name == "Type" || mk != nullptr || scalar_of(particles, "idp"));
  if (is_type && are_classes(type->values, kFluidType)) {
    choice.is_fluid = marked(type->values, [](float value) { return value == kFluidType; });
    choice.reason = "their Type says boundary (0, 1) or floating body (2), not fluid (3)";
  } else if (type == nullptr && mk != nullptr && mk->name == "Mk" && are_classes(mk->values, kMostMk)) {
    choice.is_fluid = marked(mk->values, [](float value) { return value < kFirstBoundaryMk; });
    choice.reason = "their Mk says boundary (10 and above), not fluid";
  } else if (tag != nullptr && scalar_of(particles, "gid") && scalar_of(particles, "pid") &&
             are_classes(tag->values, 2)) {
    choice.is_fluid = marked(tag->values, [](float value) { return value == 0; });
    choice.reason = "their tag says that they are copies (1 of another process, 2 ghosts)";
    if (std::find(choice.is_fluid.begin(), choice.is_fluid.end(), 1) == choice.is_fluid.end()) return std::nullopt;
  } else if (part != nullptr && (scalar_of(particles, "part id") || scalar_of(particles, "part flags")) &&
             are_classes(part->values, 3)) {
    choice.is_fluid = marked(part->values, [](float value) { return value == 0; });
    choice.reason = "their Part type says boundary (1), vertex (2) or test point (3), not fluid (0)";
  } else {
    return std::nullopt;
  }
  const auto fluids = std::count(choice.is_fluid.begin(), choice.is_fluid.end(), 1);
  boundaries_only = fluids == 0;
  if (fluids == 0 || fluids == static_cast<std::ptrdiff_t>(choice.is_fluid.size())) return std::nullopt;
  return choice;
}

}  // namespace meniscus::io
