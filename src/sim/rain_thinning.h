/// Which drops are made where the rain is looked at from somewhere: all near the eye, fewer farther away.
#pragma once

#include <vector>

#include "meniscus/base.h"
#include "sim/rain_spectrum.h"

namespace meniscus {

/// Each drop has a number u of its own, 0 .. 1, and is made if u < p. At a distance r from an eye around which all are
/// made within w, with D_m the mean diameter of the drops that come down,
///   p = max(least, min(1, q g)),   q = min(1, (w / r)^2),   g = max(1, (D / D_m)^2)
/// so that as many drops are made in every ring as wide as its distance, and large ones, that are seen best, are all
/// made up to w D / D_m, and none stands for more than 1 / least. What is made stands for 1 / p drops: water and sizes
/// are right in the mean everywhere.
class RainThinning {
 public:
  /// @param least  0 < least <= 1
  RainThinning(const RainSpectrum& spectrum, double least);
  double least() const { return least_; }
  double favour(double diameter) const;          ///< g, >= 1, the same for all of a step of the spectrum
  double kept(double q, double diameter) const;  ///< p
  /// Part of all drops of a region that is made with the eye over its middle, where most are.
  /// @param sides  of the region, m
  /// @param whole  w, m, >= 0
  double kept_over(glm::dvec2 sides, double whole) const;

 private:
  double kept_at(double q) const;  ///< part of the drops of all sizes

  double least_;
  double first_, step_;         ///< m, of the spectrum
  std::vector<double> favour_;  ///< by its steps
  std::vector<double> kept_;    ///< by the logarithm of q
};

/// The drops of which low <= u / g < high; those with u < least are in the layer that begins at 0.
/// A layer is made only where the eye is near enough for some of its drops to be kept, q > low.
class RainLayer {
 public:
  RainLayer(const RainSpectrum& spectrum, const RainThinning& thinning, double low, double high);

  double low() const { return low_; }
  double share() const { return share_; }  ///< of all drops
  struct Drop {
    float diameter;  ///< m
    float u;
  };
  /// @param part, within  uniform in [0, 1)
  Drop drop(double part, double within, const RainThinning& thinning) const;

 private:
  struct Between {
    double low, high;
  };
  Between between(double favour) const;  ///< of u, for drops with this g

  double low_, high_, least_, share_ = 0;
  double first_ = 0, step_ = 0;  ///< m
  std::vector<double> below_;    ///< part of the layer's drops below the i-th diameter; rises from 0 to 1
};

}  // namespace meniscus
