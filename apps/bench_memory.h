/// How much memory there is, and how much a part of a bench has taken.
#pragma once

#include <cstdint>

namespace meniscus::apps {

/// Bytes that could be had now: what the machine has free, or what is left of the limit of addresses (`ulimit -v`).
/// Where the system does not tell, more than there can be.
std::uint64_t available_bytes();

/// Lets peak_rss_bytes() begin anew with what is held now; where the system does not allow it, it stays the peak of all
/// that was before.
void forget_peak();

}  // namespace meniscus::apps
