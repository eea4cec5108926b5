/// Names of attributes: what the formats call a thing, and what it is called here.
#pragma once

#include "meniscus/base.h"

namespace meniscus::io {

/// One component of a vector that stands in a column or array of its own.
struct Component {
  std::string base;  ///< "velocity" of "vx" or "Vel:0", "position" of "x" or "Points:0", "force" of "force_x"
  int index = 0;     ///< 0, 1, 2
};

/// The component that a name stands for: x vx pos_x force.y Vel:2 Points_1 a[0] ...; none for other names.
std::optional<Component> component_of(std::string_view name);

/// "velocity" and "density" for the many names of these; any other name as it is.
std::string common_name(std::string_view name, int components);

/// Joins attributes of one component that belong together (vx vy vz; u v w; force:0 force:1 force:2) to one of
/// three components, and gives all their common names. A name is given only once.
void unify_names(std::vector<Attribute>& attributes);

}  // namespace meniscus::io
