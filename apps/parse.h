/// Option values of several parts. All throw UsageError naming the option and what was expected.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "meniscus/scene.h"

namespace meniscus::apps {

struct PictureSize {
  int width = 0, height = 0;
};
/// "1280x720"; each from 1 to 16384.
PictureSize parse_size(std::string_view option, std::string_view text);
/// "1,2.5,-3"
glm::vec3 parse_vec3(std::string_view option, std::string_view text);
/// The same in double precision.
glm::dvec3 parse_dvec3(std::string_view option, std::string_view text);
/// "30,20"
glm::vec2 parse_vec2(std::string_view option, std::string_view text);
/// "0:2.5", rising
std::pair<float, float> parse_range(std::string_view option, std::string_view text);

/// "x,y,z:intensity" or "x,y,z:r,g,b"
PointLight parse_lamp(std::string_view option, std::string_view text);

/// "4GB", "1.5GiB", "512MiB", "0": bytes, with B, kB, MB, GB, TB (thousands) or KiB, MiB, GiB, TiB (1024s).
std::uint64_t parse_bytes(std::string_view option, std::string_view text);

/// "A:B:STEP" as Python slices (each part may be missing, negative counts from the end), or "N" alone.
struct FrameSelection {
  std::optional<long long> begin, end;
  long long step = 1;
  std::optional<long long> first_n;  ///< "N": the first N
};
FrameSelection parse_selection(std::string_view option, std::string_view text);
/// The picked places in a sequence of `count` frames.
std::pair<std::size_t, std::size_t> bounds_of(const FrameSelection& selection, std::size_t count);

}  // namespace meniscus::apps
