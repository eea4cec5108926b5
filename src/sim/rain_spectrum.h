/// How many drops of which size there are in the air and come down.
#pragma once

#include <cstdint>
#include <vector>

namespace meniscus {

/// Drops of all diameters for one rain rate: the numbers in air of [MarshallPalmer1948], scaled by one factor so that
/// the drops of all sizes, falling as [GunnKinzer1949] measured, bring exactly that rate.
class RainSpectrum {
 public:
  /// @param rate         mm/h, >= 0
  /// @param smallest_mm  diameters of the drops that are made, 0 < smallest < largest
  RainSpectrum(double rate, double smallest_mm, double largest_mm);

  double scale() const { return scale_; }            ///< factor on the numbers of [MarshallPalmer1948]
  double arrivals() const { return arrivals_; }      ///< made drops that come down, 1/(m^2 s)
  double water() const { return water_; }            ///< that they bring, m/s
  double extinction() const { return extinction_; }  ///< of all drops, 1/m
  // The diameters in equal steps.
  std::size_t steps() const { return below_.size() - 1; }
  double first() const { return first_; }                                                         ///< m
  double step() const { return step_; }                                                           ///< m
  double middle(std::size_t i) const { return first_ + step_ * (static_cast<double>(i) + 0.5); }  ///< m
  double part(std::size_t i) const { return below_[i + 1] - below_[i]; }  ///< of the made drops, in a step
  /// Diameter, m, below which is the part `u`, 0 .. 1, of the made drops that come down.
  float diameter(double u) const {
    std::size_t i = guide_[static_cast<std::size_t>(u * static_cast<double>(guide_.size() - 1))];
    while (below_[i + 1] < u) ++i;
    const double t = (u - below_[i]) / (below_[i + 1] - below_[i]);
    return static_cast<float>(first_ + step_ * (static_cast<double>(i) + t));
  }

 private:
  double scale_ = 1, arrivals_ = 0, water_ = 0, extinction_ = 0;
  double first_ = 0, step_ = 0;       ///< m
  std::vector<double> below_;         ///< part of the drops below the i-th diameter; rises from 0 to 1
  std::vector<std::uint32_t> guide_;  ///< step of below_ to begin at
};

}  // namespace meniscus
