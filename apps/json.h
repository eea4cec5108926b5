/// What the program says to machines.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "meniscus/render.h"

namespace meniscus::apps {

using Json = nlohmann::ordered_json;

/// The shortest decimal number that gives the same float; null if it is not finite.
Json json_of(float value);
Json json_of(vec3 point);
Json json_of(const StageTimes& times);
/// {"frames": [...], "peak_rss_bytes": N}
Json json_of(const SequenceReport& report);

/// dump() that replaces what is not UTF-8, as file names may be.
std::string text_of(const Json& json, int indent = -1);

}  // namespace meniscus::apps
