/// Work that may bring down the program, tried in a copy of it first.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace meniscus::io {

/// Does the work in a copy of this process, whose memory and output nothing here sees, and waits for its end.
///
/// Where the system has no such copies, or refuses one, the work is not done and counts as survived.
/// @param work     opens what it needs itself and uses one thread: no other is there
/// @param seconds  of processor time that it may take, 1 or more
/// @return         nothing where the work came to its end, if by an exception; else what stopped it: "signal 11
///                 (Segmentation fault)"
std::optional<std::string> what_stops(const std::function<void()>& work, int seconds);

}  // namespace meniscus::io
