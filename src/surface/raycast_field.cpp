#include "surface/raycast_field.h"

#include <fmt/format.h>

#include "meniscus/formulas/kernels.h"

namespace meniscus {
namespace {

void require(bool holds, std::string_view name, double value, std::string_view range) {
  if (!holds)
    throw Error(
        ErrorCode::invalid_argument,
        ErrorDetail{
            fmt::format("{} is out of range", name), std::string(range), fmt::format("{}", value), {}, {}, {}, {}});
}

RaycastOptions resolved(RaycastOptions options) {
  require(options.spacing > 0 && std::isfinite(options.spacing), "particle spacing", options.spacing, "more than 0 m");
  if (options.smoothing_length == 0) options.smoothing_length = 2.0f * options.spacing;
  if (options.normal_radius == 0) options.normal_radius = 3.0f * options.spacing;
  require(options.smoothing_length >= options.spacing && options.smoothing_length <= 20 * options.spacing,
          "smoothing length", options.smoothing_length, fmt::format("1 to 20 spacings of {} m", options.spacing));
  require(options.normal_radius >= options.spacing && options.normal_radius <= 20 * options.spacing, "normal radius",
          options.normal_radius, fmt::format("1 to 20 spacings of {} m", options.spacing));
  require(options.iso > 0 && options.iso < 1, "iso-value", options.iso, "more than 0 and less than 1");
  require(options.step > 0 && options.step <= 1, "step", options.step, "more than 0, at most 1 smoothing length");
  require(options.refinement_steps >= 0 && options.refinement_steps <= 32, "number of refinement steps",
          options.refinement_steps, "0 to 32");
  require(options.blend_sharpness >= 0, "blend sharpness", options.blend_sharpness, "0 or more");
  require(options.blend_agreement >= 0 && options.blend_agreement <= 1, "blend agreement", options.blend_agreement,
          "0 to 1");
  require(options.filter_radius >= 0 && options.filter_radius <= 32, "filter radius", options.filter_radius,
          "0 to 32 px");
  return options;
}

template <class Value>
Value named(std::string_view what, std::string_view name,
            std::initializer_list<std::pair<std::string_view, Value>> known) {
  std::string names;
  for (const auto& [known_name, value] : known) {
    if (known_name == name) return value;
    if (!names.empty()) names += ", ";
    names += known_name;
  }
  throw Error(ErrorCode::invalid_argument,
              ErrorDetail{fmt::format("there is no {} called '{}'", what, name), names, {}, {}, {}, {}, {}});
}

}  // namespace

Kernel kernel_of(std::string_view name) {
  return named<Kernel>("kernel", name,
                       {{"cubic_spline", Kernel::cubic_spline}, {"poly6", Kernel::poly6}, {"wyvill", Kernel::wyvill}});
}

NormalMethod normal_method_of(std::string_view name) {
  return named<NormalMethod>(
      "way to find normals", name,
      {{"gradient", NormalMethod::gradient}, {"pca", NormalMethod::pca}, {"blend", NormalMethod::blend}});
}

Refinement refinement_of(std::string_view name) {
  return named<Refinement>("refinement", name, {{"secant", Refinement::secant}, {"bisection", Refinement::bisection}});
}

float kernel_value(Kernel kernel, float r, float h) {
  switch (kernel) {
    case Kernel::cubic_spline:
      return formulas::cubic_spline(r, h);
    case Kernel::poly6:
      return formulas::poly6(r, h);
    case Kernel::wyvill:
      break;
  }
  return formulas::wyvill(r, h);
}

MassRule mass_rule(const RaycastOptions& options) {
  const float s = options.spacing;
  const float volume = s * s * s;
  const auto density_at = [&](float r) { return volume * kernel_value(options.kernel, r, options.smoothing_length); };
  MassRule rule;
  rule.lone_density = density_at(0.0f);
  const float drop_radius = 0.62035f * s;
  rule.lone_mass = std::max(1.0f, options.iso / std::max(density_at(drop_radius), 1e-6f));
  const int reach = static_cast<int>(options.smoothing_length / s) + 1;
  float sheet = 0;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) sheet += density_at(s * std::sqrt(static_cast<float>(x * x + y * y)));
  rule.full_density = std::max(0.93f * sheet, 1.001f * rule.lone_density);
  return rule;
}

namespace {

BandGrid::Options grid_options(const RaycastOptions& options, Keep keep, float least_spacing) {
  const float cell = options.smoothing_length;
  BandGrid::Options wanted;
  wanted.cell_size = cell;
  if (keep == Keep::all || (keep == Keep::band && !options.cull_interior)) return wanted;
  const float inside = cell * cell * cell / (least_spacing * least_spacing * least_spacing);
  wanted.well_filled = BandGrid::well_filled(inside);
  // Marches reach a smoothing length, normals their radius into the water.
  const float reach = std::max(options.smoothing_length, options.normal_radius);
  wanted.kept_layers = keep == Keep::band ? static_cast<int>(std::ceil(reach / cell)) : 1 << 20;
  return wanted;
}

}  // namespace

RaycastField make_field(const Particles& particles, const RaycastOptions& given, std::span<const vec3> colours,
                        Keep keep, float least_spacing) {
  const RaycastOptions options = resolved(given);
  if (!colours.empty() && colours.size() != particles.size())
    throw Error(ErrorCode::invalid_argument,
                fmt::format("{} colours were given for {} particles", colours.size(), particles.size()));
  RaycastField field;
  field.options = options;
  field.least_spacing = least_spacing > 0 ? least_spacing : options.spacing;
  BandGrid::Options wanted = grid_options(options, keep, field.least_spacing);
  wanted.keep_index = keep != Keep::band || !colours.empty();  // who keeps a band asks for positions
  field.grid = BandGrid(particles, wanted);
  const float volume = options.spacing * options.spacing * options.spacing;
  field.scale = volume * kernel_value(options.kernel, 0.0f, options.smoothing_length);
  field.step = options.step * options.smoothing_length;
  const std::size_t count = field.grid.size();
  field.mass.resize(count + BandGrid::kPadding);
  std::fill_n(field.mass.begin() + static_cast<std::ptrdiff_t>(count), BandGrid::kPadding, 0.0f);
  field.entry_radius.resize(count);
  if (!colours.empty())
    for (auto colour : {&RaycastField::red, &RaycastField::green, &RaycastField::blue})
      (field.*colour).resize(count + BandGrid::kPadding, 0.0f);
  const float radius = entry_radius_at(options, 1.0f);
  field.widest_entry = radius / options.smoothing_length;
  constexpr std::size_t kGrain = 1 << 15;
  parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::fill(&field.mass[begin], &field.mass[begin] + (end - begin), 1.0f);
    std::fill(&field.entry_radius[begin], &field.entry_radius[begin] + (end - begin), radius);
    if (colours.empty()) return;
    for (std::size_t i = begin; i < end; ++i) {
      const vec3 colour = colours[field.grid.given_index(i)];
      field.red[i] = colour.x;
      field.green[i] = colour.y;
      field.blue[i] = colour.z;
    }
  });
  return field;
}

}  // namespace meniscus
