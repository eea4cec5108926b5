#include <algorithm>

#include "meniscus/base.h"

namespace meniscus {

const Attribute* Particles::find(std::string_view name) const {
  const auto found =
      std::find_if(attributes.begin(), attributes.end(), [&](const Attribute& a) { return a.name == name; });
  return found == attributes.end() ? nullptr : &*found;
}

Bounds Particles::bounds() const {
  Bounds bounds;
  for (std::size_t i = 0; i < size(); ++i) bounds.add(position(i));
  return bounds;
}

}  // namespace meniscus
