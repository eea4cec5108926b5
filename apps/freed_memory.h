/// What becomes of memory that the program has freed.
#pragma once

namespace meniscus::apps {

/// It is kept for the next frame, whose buffers have the same sizes: having the system clear it anew takes an eighth of
/// the time of a small frame, and half of the time in which a large one is read. Not for runs that must stay below a
/// limit.
void keep_freed_memory();
}  // namespace meniscus::apps
