/// What `render --dry-run` prints.
#pragma once

#include <string>

#include "json.h"

namespace meniscus::apps {

/// A few lines for people.
std::string estimate_text(const RunEstimate& run, const std::string& output);
Json json_of(const RunEstimate& run);

}  // namespace meniscus::apps
