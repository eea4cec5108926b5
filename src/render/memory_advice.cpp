// What would make a frame fit into the memory that may be used: each change is tried before it is named.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "render/frame_memory.h"

namespace meniscus {
namespace {

constexpr int kLeastEdge = 120;                     ///< px; nobody wants a smaller picture
constexpr std::uint64_t kMargin = 2 * 1000 * 1000;  ///< bytes; the program's own size differs from run to run

/// Other options, and how to ask for them.
struct Change {
  PictureOptions picture;
  std::vector<std::string> said;
};

/// The water drawn in parts.
std::optional<Change> in_parts(const PictureOptions& picture) {
  Change change{picture, {}};
  PictureOptions& other = change.picture;
  if (picture.heights || picture.method == SurfaceMethod::spheres) return {};
  if (picture.method != SurfaceMethod::raycast) change.said.emplace_back("--surface raycast");
  other.method = SurfaceMethod::raycast;
  if (picture.rain) change.said.emplace_back("no rain");
  other.rain.reset();
  const RefractionMethod refraction = picture.optics.refraction;
  if (!can_be_cut(other) && refraction != RefractionMethod::thickness && refraction != RefractionMethod::image_space) {
    other.optics.refraction = RefractionMethod::thickness;
    change.said.emplace_back("--refraction thickness");
  }
  if (!can_be_cut(other) && other.caustics) {
    other.caustics = false;
    change.said.emplace_back("--no-caustics");
  }
  if (change.said.empty() || !can_be_cut(other)) return {};
  return change;
}

/// The largest of the picture's halves, quarters ... that fits; none does: nothing.
std::optional<Change> smaller(Change change, FunctionRef<bool(const PictureOptions&)> fits) {
  PictureOptions& picture = change.picture;
  while (std::min(picture.width, picture.height) >= 2 * kLeastEdge) {
    picture.width = picture.width / 4 * 2;  // films want even numbers
    picture.height = picture.height / 4 * 2;
    if (!fits(picture)) continue;
    change.said.push_back(fmt::format("--size {}x{}", picture.width, picture.height));
    return change;
  }
  return {};
}

}  // namespace

Error does_not_fit(const PictureOptions& picture, std::uint64_t limit, const std::string& path,
                   const std::string& problem, FunctionRef<std::uint64_t(const PictureOptions&)> least) {
  const auto fits = [&](const PictureOptions& other) { return least(other) + kMargin <= limit; };
  std::vector<std::string> help;
  const auto name_if_it_fits = [&](const Change& change) {
    if (!change.said.empty() && fits(change.picture)) help.push_back(fmt::format("{}", fmt::join(change.said, " ")));
  };
  Change other{picture, {}};
  if (picture.antialias == Antialias::full) {
    other.picture.antialias = Antialias::edges;
    other.said.emplace_back("--antialias edges");
    name_if_it_fits(other);
  }
  if (const std::optional<Change> cut = in_parts(picture)) name_if_it_fits(*cut);
  if (const std::optional<Change> small = smaller({picture, {}}, fits)) name_if_it_fits(*small);
  if (help.empty()) {  // all of it together
    if (std::optional<Change> cut = in_parts(other.picture)) {
      cut->said.insert(cut->said.begin(), other.said.begin(), other.said.end());
      other = std::move(*cut);
    }
    name_if_it_fits(other);
    if (help.empty())
      if (const std::optional<Change> small = smaller(other, fits)) name_if_it_fits(*small);
  }
  const std::uint64_t needed = least(picture);
  // Rounded up to two digits, with a little more, as the program's own size differs from run to run.
  const double megabytes = 1.05e-6 * static_cast<double>(needed);
  const double unit = std::pow(10.0, std::max(0.0, std::floor(std::log10(std::max(megabytes, 1.0))) - 1));
  help.push_back(fmt::format("--memory-limit {:.0f}MB", std::ceil(megabytes / unit) * unit));
  std::string advice = "what would do: ";
  for (std::size_t i = 0; i < help.size(); ++i) advice += (i == 0 ? "" : i + 1 < help.size() ? ", " : " or ") + help[i];
  return Error(ErrorCode::limit_exceeded, {problem,
                                           fmt::format("no more than the limit of {}", size_text(limit)),
                                           fmt::format("about {} needed", size_text(needed)),
                                           path,
                                           {},
                                           {},
                                           advice});
}

}  // namespace meniscus
