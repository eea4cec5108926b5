#include "surface/beam.h"

namespace meniscus {

void RayList::reserve(std::size_t wanted, bool sizes) {
  for (AlignedFloats* values : {&place, &core, &mass}) values->reserve(wanted, 0);
  if (sizes) per_h.reserve(wanted, 0);
}

}  // namespace meniscus
