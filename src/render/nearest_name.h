/// What somebody may have meant by an unknown name.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace meniscus {

/// Letters to insert, delete, change or swap with their neighbour, upper and lower case alike.   [Damerau1964]
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known name that is nearest to `name`, the first of equals; empty if none is near: more than a third of its
/// letters would have to change.
std::string nearest_name(std::string_view name, std::span<const std::string> known);

}  // namespace meniscus
