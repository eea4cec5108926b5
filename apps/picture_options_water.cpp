/// Options on the water itself: surface, colour, optics.
#include "commands.h"
#include "option_group.h"

namespace meniscus::apps {

void PictureArguments::add_surface(CLI::App& command) {
  OptionGroup group(command, "Surface", setters_);
  group.text(
      "--surface", "NAME", [](PictureOptions& p, const std::string& name) { p.method = surface_method_of(name); },
      "What represents the water: raycast, surfels, height_field, or spheres to see the particles themselves (default: "
      "raycast)");
  group.text(
      "--kernel", "NAME",
      [](PictureOptions& p, const std::string& name) { p.surface.kernel = p.surfels.kernel = kernel_of(name); },
      "Smoothing kernel: cubic_spline, poly6 or wyvill (default: cubic_spline; wyvill for surfels)");
  group.text(
      "--radius-attribute", "NAME", [](PictureOptions& p, const std::string& name) { p.sizes.radius = name; },
      "Attribute with each particle's radius, m, half its spacing; --surface raycast only (default: all are alike)");
  group.text(
      "--smoothing-attribute", "NAME",
      [](PictureOptions& p, const std::string& name) { p.sizes.smoothing_length = name; },
      "Attribute with the reach of each particle's kernel, m (default: as many of its spacings as "
      "--smoothing-length has)");
  group.number<float>(
      "--iso", "FRACTION", [](PictureOptions& p, float v) { p.surface.iso = v; },
      "Density of the surface as a fraction of that inside the water, 0 to 1 (default: 0.5)");
  group.number<float>(
      "--step", "LENGTHS", [](PictureOptions& p, float v) { p.surface.step = v; },
      "Step of the march, in smoothing lengths, up to 1 (default: 0.25)");
  group.text(
      "--refinement", "NAME",
      [](PictureOptions& p, const std::string& name) { p.surface.refinement = refinement_of(name); },
      "How the crossing is closed in on: secant or bisection (default: secant)");
  group.number<int>(
      "--refinement-steps", "N", [](PictureOptions& p, int v) { p.surface.refinement_steps = v; },
      "Evaluations after the crossing has been bracketed, 0 to 32 (default: 2)");
  group.text(
      "--normals", "NAME",
      [](PictureOptions& p, const std::string& name) { p.surface.normals = normal_method_of(name); },
      "Normals: gradient, pca or blend of both (default: blend)");
  group.number<float>(
      "--normal-radius", "METRES", [](PictureOptions& p, float v) { p.surface.normal_radius = v; },
      "Reach of the normals' sums, m (default: 3 spacings)");
  group.number<float>(
      "--blend-sharpness", "D", [](PictureOptions& p, float v) { p.surface.blend_sharpness = v; },
      "How fast the blend turns to the gradient where both normals differ (default: 10)");
  group.number<float>(
      "--blend-agreement", "K", [](PictureOptions& p, float v) { p.surface.blend_agreement = v; },
      "Cosine between both normals from which on pca alone is taken (default: 0.998)");
  group.number<int>(
      "--filter-radius", "PIXELS", [](PictureOptions& p, int v) { p.surface.filter_radius = v; },
      "Radius of the filter that smooths the normals, px; 0 switches it off (default: 4)");
  group.flag(
      "--no-keep-thin", [](PictureOptions& p) { p.surface.keep_thin = false; },
      "Particles of equal mass, as published: drops, jets and thin sheets shrink or vanish");
  group.number<float>(
      "--grid-step", "METRES", [](PictureOptions& p, float v) { p.surfels.grid_step = v; },
      "Surfels: between points of the density grid, m (default: half a spacing)");
  group.number<float>(
      "--gap-threshold", "METRES", [](PictureOptions& p, float v) { p.surfels.gap_threshold = v; },
      "Surfels: between neighbours beyond which points are added, m (default: 1.5 grid steps)");
  group.number<float>(
      "--epsilon", "METRES", [](PictureOptions& p, float v) { p.surfels.epsilon = v; },
      "Surfels: discs this close in depth are blended, m (default: a spacing)");
  group.number<float>(
      "--column-step", "METRES",
      [](PictureOptions& p, float v) { p.height_field.step = in_range("--column-step", v, 1e-9f, 1e9f); },
      "Height field: between columns, m (default: half a spacing)");
  group.number<float>(
      "--column-smoothing", "METRES",
      [](PictureOptions& p, float v) { p.height_field.smoothing = in_range("--column-smoothing", v, 0.0f, 1e9f); },
      "Height field: standard deviation of a Gaussian over the heights, m; 0: none (default: by the spacing)");
  group.number<float>(
      "--iso-radius", "METRES",
      [](PictureOptions& p, float v) { p.height_field.iso_radius = in_range("--iso-radius", v, 1e-9f, 1e9f); },
      "Height field: reach of a particle's potential, m (default: by the spacing)");
  group.number<int>(
      "--drop-isolated", "N",
      [](PictureOptions& p, int v) {
        if (v < 0) throw UsageError("--drop-isolated: 0 or more was expected");
        p.drop_isolated = v;
      },
      "Leave out particles with fewer than N others within a smoothing length (default: 0, none)");
  group.list(
      "--foam", "FILE", [](PictureOptions& p, const std::string& file) { p.foam.files.push_back(file); },
      "Particles of spray, foam or bubbles, a file with {} for the frame's number, drawn as soft white discs; may be "
      "repeated");
  group.number<float>(
      "--foam-radius", "METRES",
      [](PictureOptions& p, float v) { p.foam.look.radius = in_range("--foam-radius", v, 1e-9f, 1e9f); },
      "Radius of a particle of foam, m (default: 0.3 spacings)");
  group.number<float>(
      "--foam-opacity", "FRACTION",
      [](PictureOptions& p, float v) { p.foam.look.opacity = in_range("--foam-opacity", v, 0.0f, 1.0f); },
      "Opacity in the middle of a particle of foam, 0 to 1 (default: 0.6)");
}

void PictureArguments::add_colour(CLI::App& command) {
  OptionGroup group(command, "Colour", setters_);
  group.text(
      "--color-by", "ATTRIBUTE", [this](PictureOptions&, const std::string& name) { color_by_ = name; },
      "Colour the water by a particle attribute; of vectors the magnitude (see meniscus info for their names)");
  group.text(
      "--colormap", "NAME", [this](PictureOptions&, const std::string& name) { colormap_ = colormap_of(name); },
      "viridis, magma, turbo, coolwarm or grey (default: viridis)");
  group.text(
      "--range", "LOW:HIGH",
      [this](PictureOptions&, const std::string& text) { range_ = parse_range("--range", text); },
      "Values at the ends of the map (default: the smallest and largest of the whole sequence)");
  group.flag(
      "--legend", [](PictureOptions& p) { p.legend = true; }, "Draw a colour bar");
}

void PictureArguments::add_optics(CLI::App& command) {
  OptionGroup group(command, "Optics", setters_);
  group.text(
      "--refraction", "NAME",
      [](PictureOptions& p, const std::string& name) { p.optics.refraction = refraction_method_of(name); },
      "How rays go on behind the surface: thickness (one interface, the far side guessed), image_space (one interface, "
      "iteration in the picture of the scene), virtual_eye (one interface, objects drawn from virtual eyes), "
      "ray_traced (through the water, best) (default: ray_traced)");
  group.text(
      "--fresnel", "exact|schlick",
      [](PictureOptions& p, const std::string& name) { p.optics.fresnel = fresnel_formula_of(name); },
      "How much is reflected: Fresnel's equations or Schlick's approximation (default: exact)");
  group.flag(
      "--dispersion", [](PictureOptions& p) { p.optics.dispersion = true; },
      "Red, green and blue light are refracted differently");
  group.number<int>(
      "--bounces", "N", [](PictureOptions& p, int v) { p.optics.bounces = in_range("--bounces", v, 1, 64); },
      "Interfaces in a ray-traced path at most, 1 to 64 (default: 8)");
  group.number<int>(
      "--iterations", "N",
      [](PictureOptions& p, int v) {
        p.optics.iterations = p.caustics_options.iterations = in_range("--iterations", v, 1, 256);
      },
      "Image-space refraction and caustics: projections onto the ray at most, 1 to 256 (default: 8)");
  group.number<float>(
      "--threshold", "METRES",
      [](PictureOptions& p, float v) {
        p.optics.threshold = p.caustics_options.threshold = in_range("--threshold", v, 0.0f, 1e30f);
      },
      "Image-space refraction and caustics: distance from the scene that counts as met, m (default: from the pixels)");
  group.number<float>(
      "--ior", "N", [](PictureOptions& p, float v) { p.ior = v; },
      "Index of refraction, above 1 (default: the material's; water 1.333)");
  group.number<float>(
      "--roughness", "R",
      [](PictureOptions& p, float v) {
        if (!(v >= 0 && v <= 1)) throw UsageError("--roughness: 0 to 1 was expected");
        p.roughness = v;
      },
      "Of the water's mirror image, 0 to 1 (default: the material's)");
}

void PictureArguments::add_eyes(CLI::App& command) {
  OptionGroup group(command, "Virtual eyes", setters_);
  group.number<int>(
      "--eye-map", "PIXELS",
      [](PictureOptions& p, int v) { p.optics.eyes.map_size = in_range("--eye-map", v, 8, 4096); },
      "Edge of a face of the cube maps, px (default: by the picture)");
  group.text(
      "--eye-lookup", "position|direction",
      [](PictureOptions& p, const std::string& name) {
        if (name != "position" && name != "direction")
          throw UsageError("--eye-lookup: position or direction was expected, not '" + name + "'");
        p.optics.eyes.object_position = p.optics.eyes.static_position = name == "position";
      },
      "How maps are looked into: by where a ray passes, or by its direction alone, as published");
  group.flag(
      "--no-displaced-eye", [](PictureOptions& p) { p.optics.eyes.displaced_eye = false; },
      "Maps are drawn from the eye itself");
  group.flag(
      "--no-scale-correction",
      [](PictureOptions& p) { p.optics.eyes.scale_correction = p.optics.eyes.object_position = false; },
      "Refracted parts keep the size that they have from one virtual eye; objects are looked up by direction");
  group.flag(
      "--no-adaptation", [](PictureOptions& p) { p.optics.eyes.adaptation = false; },
      "The surface is not bent towards a plane around objects");
  group.flag(
      "--no-trapezium", [](PictureOptions& p) { p.optics.eyes.trapezium = false; },
      "Objects are looked for in all of the surface, not only between them and the eye");
  group.text(
      "--trapezium", "A,B",
      [](PictureOptions& p, const std::string& text) {
        const vec2 widths = parse_vec2("--trapezium", text);
        p.optics.eyes.trapezium_a = in_range("--trapezium", widths.x, 0.0f, 1e9f);
        p.optics.eyes.trapezium_b = in_range("--trapezium", widths.y, 0.0f, 1e9f);
      },
      "Half widths of the trapezium at the object and at the eye's end, m (default: by the object's size)");
  group.flag(
      "--per-point",
      [](PictureOptions& p) {
        p.optics.eyes.per_point = true;
        p.optics.eyes.object_position = false;
      },
      "Every point of an object from its own virtual eye: for wide objects; they are looked up by direction");
  group.number<float>(
      "--adaptation-width", "METRES",
      [](PictureOptions& p, float v) {
        p.optics.eyes.adaptation_width = in_range("--adaptation-width", v, 1e-9f, 1e9f);
      },
      "Beyond an object's outline, m (default: by its size)");
  group.number<float>(
      "--combine-distance", "METRES",
      [](PictureOptions& p, float v) {
        p.optics.eyes.combine_distance = in_range("--combine-distance", v, 0.0f, 1e9f);
      },
      "Objects nearer to each other than this share an eye, m (default: by their size)");
}

}  // namespace meniscus::apps
