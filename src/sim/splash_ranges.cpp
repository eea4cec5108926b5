/// Which splash a drop makes on what, and within what ranges.              [Mizukami2013] section 2.2, table 1
#include <array>
#include <string>

#include "meniscus/sim.h"

namespace meniscus {
namespace {

/// A column of table 1; measured on asphalt.
struct Column {
  int fewest, most;
  float lowest_deg, highest_deg;
  float slowest, fastest;
};
constexpr Column kWet{1, 5, 1, 30, 0.1f, 1.0f};
constexpr Column kPuddle3mm{4, 14, 1, 60, 0.15f, 1.5f};
constexpr Column kPuddle5mm{12, 22, 1, 90, 0.2f, 2.0f};
constexpr Column kPuddle10mm{1, 1, 90, 90, 0.1f, 2.0f};

/// Parts of a range. The table has no means: those of medium drops on asphalt stand in the middle.
constexpr float kMiddle = 0.5f;
constexpr float kBySize = 0.15f;   ///< that small drops' means lie lower, and large drops' higher
constexpr float kSmoother = 0.1f;  ///< that the means of concrete and steel lie lower than those of asphalt
constexpr float kSigma = 0.2f;     ///< standard deviation
/// Those of cones: they rise by about 2, 13 and 45 mm, each by the size of its drop, and seldom by twice as much.
constexpr float kConeSmall = 0.05f, kConeMedium = 0.21f, kConeLarge = 0.44f;
constexpr float kConeSigma = 0.25f;  ///< standard deviation, over the mean

constexpr float kSmall = 0.0015f, kMedium = 0.003f;  ///< m, below which a drop is small, medium

const Column& column(Wetness wetness) {
  switch (wetness) {
    case Wetness::puddle_10mm:
      return kPuddle10mm;
    case Wetness::puddle_5mm:
      return kPuddle5mm;
    case Wetness::puddle_3mm:
      return kPuddle3mm;
    default:
      return kWet;
  }
}

}  // namespace

std::string_view name_of(SplashKind kind) {
  switch (kind) {
    case SplashKind::none:
      return "none";
    case SplashKind::scattering:
      return "scattering";
    case SplashKind::crown_cone:
      return "crown_cone";
    case SplashKind::disk:
      return "disk";
  }
  return "none";
}

SplashKind splash_kind(GroundMaterial material, Wetness wetness) {
  switch (wetness) {
    // "Seeps into the object, without forming a water splash", "except for the griddle": there it "remains".
    case Wetness::dry:
      return material == GroundMaterial::steel ? SplashKind::disk : SplashKind::none;
    // None "on the concrete with enough moisture", scattering on the asphalt's small hollows. Wet steel is not in the
    // paper: it soaks nothing up, so what wets it stands on it as a film.
    case Wetness::wet:
      return material == GroundMaterial::concrete ? SplashKind::none : SplashKind::scattering;
    // "When the film of water has stretched on the surface."
    case Wetness::puddle_3mm:
    case Wetness::puddle_5mm:
      return SplashKind::scattering;
    // "10 mm or deeper": "regardless of the material of the surface".
    case Wetness::puddle_10mm:
      return SplashKind::crown_cone;
  }
  return SplashKind::none;
}

DropSize drop_size_of(float diameter) {
  return diameter < kSmall ? DropSize::small : diameter < kMedium ? DropSize::medium : DropSize::large;
}

SplashRanges splash_ranges(GroundMaterial material, Wetness wetness, DropSize size) {
  const SplashKind kind = splash_kind(material, wetness);
  if (kind != SplashKind::scattering && kind != SplashKind::crown_cone)
    throw Error(ErrorCode::invalid_argument, {"no droplets leave such a splash",
                                              "a scattering or crown_cone splash",
                                              std::string(name_of(kind)) + " on " + std::string(name_of(wetness)) +
                                                  " " + std::string(name_of(material)),
                                              {},
                                              {},
                                              {},
                                              "ask splash_kind() first"});
  const Column& c = column(wetness);
  float mean = kMiddle, sigma = kSigma;
  if (kind == SplashKind::crown_cone) {
    mean = size == DropSize::small ? kConeSmall : size == DropSize::medium ? kConeMedium : kConeLarge;
    sigma = kConeSigma * mean;
  } else {
    if (size == DropSize::small) mean -= kBySize;
    if (size == DropSize::large) mean += kBySize;
    if (material != GroundMaterial::asphalt) mean -= kSmoother;
  }

  SplashRanges r;
  r.fewest = c.fewest, r.most = c.most;
  r.lowest_deg = c.lowest_deg, r.highest_deg = c.highest_deg;
  r.slowest = c.slowest, r.fastest = c.fastest;
  const auto numbers = static_cast<float>(c.most - c.fewest);
  const float angles = c.highest_deg - c.lowest_deg, speeds = c.fastest - c.slowest;
  r.number_mean = static_cast<float>(c.fewest) + mean * numbers, r.number_sigma = sigma * numbers;
  r.angle_mean_deg = c.lowest_deg + mean * angles, r.angle_sigma_deg = sigma * angles;
  r.speed_mean = c.slowest + mean * speeds, r.speed_sigma = sigma * speeds;
  return r;
}

}  // namespace meniscus
