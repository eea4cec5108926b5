/// What the section on rain shares with the command line.
#pragma once

#include "render/scene_file_fields.h"

namespace meniscus::scene_file {

/// "all", "splashes", "streaks" or "neither".
RainShown rain_shown_of(const std::string& name);

/// Points with velocities. @throws Error  as read_particles(); not_found: no velocities
std::shared_ptr<const Particles> wind_field_of(const std::string& path);

}  // namespace meniscus::scene_file
