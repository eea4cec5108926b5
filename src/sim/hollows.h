/// Where water that has been poured over a terrain comes to rest.
#pragma once

#include <span>

namespace meniscus {

/// Water runs down to the hollows of a terrain, fills them to one level each, and runs over into the next hollow or
/// over the border, as often as it must: a tree of hollows within hollows, each filled in one go.  [Barnes2021]
///
/// Water runs to the lowest of the four neighbours; equal heights count as falling with the index. A cell of the border
/// without a lower neighbour lets all water go. On its way down from where it fell, water first fills the `room` of the
/// cells that it comes over, and so does a lake under its level; what spills from a full hollow does not wet its way
/// into the next. O(N log N); in one thread.
///
/// @param ground  m, heights of width x height cells, i + width * j
/// @param room    m, >= 0, that a cell swallows before water stands on it or passes
/// @param water   m on each cell that is free to go; afterwards where it lies, `room` included
/// @return        m on one cell that ran over the border
double settle_in_hollows(int width, int height, std::span<const double> ground, std::span<const double> room,
                         std::span<double> water);

}  // namespace meniscus
