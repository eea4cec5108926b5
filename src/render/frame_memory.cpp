#include "render/frame_memory.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "render/guessed.h"
#include "surface/slab_surface.h"

namespace meniscus {
namespace {

// Bytes, as measured at 1280x720 and 2560x1440 (see docs/performance.md).
constexpr double kShadingAPixel = 30;   ///< radiance, the picture, what is behind the water, the outlines' rays
constexpr double kTracingAPixel = 20;   ///< paths through the water
constexpr double kOutlinesAPixel = 40;  ///< more, where the rays of many outlines are cast at once
constexpr double kEncoderAPixel = 110;  ///< x264 looks some forty pictures ahead
constexpr std::uint64_t kCaustics = 64u << 20;
constexpr std::uint64_t kShadow = 8u << 20;
constexpr std::uint64_t kRain = 160u << 20;
constexpr double kMeshFactor = 4;  ///< bytes of a mesh with its tree over those of its file

/// A tank of water of 2 : 1 : 2, filled to the brim.
Bounds tank_of(double particles, float spacing) {
  const float side = spacing * static_cast<float>(std::cbrt(particles / 4));
  return {{0, 0, 0}, {2 * side, side, 2 * side}};
}

bool follows_rays(const PictureOptions& picture) {
  const bool coloured = picture.colour.has_value();
  return picture.show == Show::water && (picture.optics.refraction == RefractionMethod::ray_traced ||
                                         (picture.caustics && picture.shadow && !coloured) || picture.rain);
}

RaycastOptions options_of(float spacing, const PictureOptions& picture) {
  RaycastOptions options = picture.surface;
  options.spacing = spacing;
  return options;
}

std::uint64_t bytes(double value) { return static_cast<std::uint64_t>(std::max(value, 0.0)); }

}  // namespace

bool can_be_cut(SurfaceMethod method, RefractionMethod refraction, bool transparent, bool caustics, bool rain) {
  if (method != SurfaceMethod::raycast || rain) return false;
  const bool flat = refraction == RefractionMethod::thickness || refraction == RefractionMethod::image_space;
  return !transparent || (flat && !caustics);
}

bool can_be_cut(const PictureOptions& picture) {
  const bool looks = picture.show != Show::water;
  const bool transparent = !looks && material_preset(material_name(picture), 1.0f).transparent;
  const bool caustics = picture.caustics && picture.shadow && !picture.colour;
  return picture.sizes.empty() &&
         can_be_cut(picture.method, picture.optics.refraction, transparent, caustics, picture.rain.has_value());
}

std::uint64_t ray_pixels(const PictureOptions& picture) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(picture.width) * static_cast<std::uint64_t>(picture.height);
  return picture.antialias == Antialias::full ? 4 * pixels : pixels;
}

std::uint64_t picture_bytes(const PictureOptions& picture, PictureFormat format) {
  const double rays = static_cast<double>(ray_pixels(picture));
  const double pixels = static_cast<double>(picture.width) * picture.height;
  double sum = kShadingAPixel * rays;
  if (picture.show == Show::water && picture.optics.refraction == RefractionMethod::ray_traced)
    sum += kTracingAPixel * rays;
  if (picture.memory_limit > 0 && picture.antialias == Antialias::edges && can_be_cut(picture))
    sum += kOutlinesAPixel * pixels;
  if (format == PictureFormat::mp4) sum += kEncoderAPixel * pixels;
  std::uint64_t total = bytes(sum);
  if (picture.show == Show::water && picture.shadow) total += picture.caustics && !picture.colour ? kCaustics : kShadow;
  if (picture.rain) total += kRain;
  for (const BodyOptions& body : picture.bodies) {
    std::error_code error;
    const std::uintmax_t size = body.path.empty() ? 0 : std::filesystem::file_size(body.path, error);
    if (!error) total += bytes(kMeshFactor * static_cast<double>(size));
  }
  return total;
}

std::uint64_t surface_bytes(std::uint64_t particles, const Bounds& known, float spacing, const PictureOptions& picture,
                            int slabs) {
  const double n = static_cast<double>(particles);
  const std::uint64_t pixels = ray_pixels(picture);
  const Bounds bounds = known.empty() ? tank_of(n, spacing) : known;
  const vec3 cells = bounds.extent() / spacing + 4.0f;
  const double volume = static_cast<double>(cells.x) * static_cast<double>(cells.y) * static_cast<double>(cells.z);
  switch (picture.method) {
    case SurfaceMethod::spheres:
      return bytes(40 * n + 64 * static_cast<double>(pixels));
    case SurfaceMethod::surfels:
      return bytes(60 * n + 90 * std::min(n, 80 * std::pow(n, 2.0 / 3)) + 80 * static_cast<double>(pixels));
    case SurfaceMethod::height_field:
      return bytes(24 * n + 100 * std::pow(volume, 2.0 / 3) + 64 * static_cast<double>(pixels));
    case SurfaceMethod::raycast:
      break;
  }
  std::uint64_t sum =
      slab_bytes(slabs, particles, bounds, options_of(spacing, picture), pixels, picture.colour.has_value());
  // Rays through the water need cells: a quarter of a byte each in a tank, some hundred for a drop far from others.
  if (follows_rays(picture) && slabs <= 1) sum += bytes(std::min(0.25 * volume, 400 * n));
  return sum;
}

int slabs_for(std::uint64_t limit, std::uint64_t particles, const Bounds& bounds, float spacing,
              const PictureOptions& picture) {
  if (surface_bytes(particles, bounds, spacing, picture, 1) <= limit) return 1;
  if (!can_be_cut(picture)) return 0;
  return slabs_within(limit, particles, bounds.empty() ? tank_of(static_cast<double>(particles), spacing) : bounds,
                      options_of(spacing, picture), ray_pixels(picture), picture.colour.has_value());
}

std::uint64_t least_surface_bytes(std::uint64_t particles, const Bounds& bounds, float spacing,
                                  const PictureOptions& picture) {
  const std::uint64_t whole = surface_bytes(particles, bounds, spacing, picture, 1);
  if (!can_be_cut(picture)) return whole;
  return std::min(
      whole, least_slab_bytes(particles, bounds.empty() ? tank_of(static_cast<double>(particles), spacing) : bounds,
                              options_of(spacing, picture), ray_pixels(picture), picture.colour.has_value()));
}

std::uint64_t resident_bytes() {
  std::uint64_t size = 0, resident = 0;
  if (!(std::ifstream("/proc/self/statm") >> size >> resident)) return peak_rss_bytes();
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::string size_text(std::uint64_t size) {
  const double b = static_cast<double>(size);
  if (b >= 1e9) return fmt::format("{:.3g} GB", b / 1e9);
  if (b >= 1e6) return fmt::format("{:.3g} MB", b / 1e6);
  return b >= 1e3 ? fmt::format("{:.3g} kB", b / 1e3) : fmt::format("{} bytes", size);
}

}  // namespace meniscus
