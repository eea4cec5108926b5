#include <fmt/format.h>
#include <hwy/highway.h>
#include <algorithm>
#include <cctype>

#include "meniscus/surface.h"

namespace meniscus {
namespace {

std::string lower_case(const char* name) {
  std::string text(name);
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Those that the vectorised loops are compiled for and that this processor runs.
std::vector<std::pair<std::string, std::int64_t>> targets() {
  std::vector<std::pair<std::string, std::int64_t>> found;
  hwy::SetSupportedTargetsForTest(0);
  std::int64_t supported = static_cast<std::int64_t>(hwy::SupportedTargets()) & static_cast<std::int64_t>(HWY_TARGETS) &
                           ~static_cast<std::int64_t>(HWY_SSSE3 | HWY_AVX3_DL);
  for (; supported != 0; supported &= supported - 1) {
    const std::int64_t target = supported & -supported;  // lower bits are better sets
    found.emplace_back(lower_case(hwy::TargetName(static_cast<decltype(hwy::SupportedTargets())>(target))), target);
  }
  return found;
}

}  // namespace

std::vector<std::string> instruction_sets() {
  std::vector<std::string> names;
  for (const auto& [name, target] : targets()) names.push_back(name);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  return names;
}

void use_instruction_set(std::string_view name) {
  const auto known = targets();
  if (name != "best") {
    const auto found = std::find_if(known.begin(), known.end(), [&](const auto& entry) { return entry.first == name; });
    if (found == known.end()) {
      std::string names = "best";
      for (const auto& entry : known) names += ", " + entry.first;
      throw Error(
          ErrorCode::invalid_argument,
          ErrorDetail{fmt::format("this processor has no instruction set '{}'", name), names, {}, {}, {}, {}, {}});
    }
    hwy::SetSupportedTargetsForTest(static_cast<decltype(hwy::SupportedTargets())>(found->second));
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace meniscus
