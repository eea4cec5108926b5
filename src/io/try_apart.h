/// Work that may bring down the program, tried in a copy of it first.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace meniscus::io {

/// Does the work in a copy of this process, whose memory and output nothing here sees, and waits for its end.
///
/// The first call leaves a copy of the process behind, which makes the copies for all work: to copy the process itself
/// each time would have the system watch all that it writes from then on. It ends with this process. Where the system
/// refuses, the work is not done and counts as survived. For several threads, one after the other.
/// @param work     takes the request; it knows what the process knew at the first call, no other thread is there
/// @param seconds  of processor time that it may take, 1 or more
/// @return         nothing where the work came to its end, if by an exception; else what stopped it: "signal 11
///                 (Segmentation fault)"
std::optional<std::string> what_stops(void (*work)(std::string_view request), std::string_view request, int seconds);

}  // namespace meniscus::io
