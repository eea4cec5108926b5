/// Spheres drawn into a picture: where rays first and last meet one, and how much of them rays run through.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Spheres by their centres and radii, world space, m; structure of arrays of one length. A radius of zero: no sphere.
struct Spheres {
  std::span<const float> x, y, z;
  std::span<const float> radius;  ///< one a sphere, or one for all
};

/// Boxes around runs of up to sixteen consecutive spheres, sixteen of them to a cluster, which pass a view together:
/// small when consecutive spheres lie near each other, as those of sorted particles do. It depends on no view.
class SphereGroups {
 public:
  static constexpr int kRun = 16;   ///< most spheres in a run: one vector
  static constexpr int kRuns = 16;  ///< most runs in a cluster
  struct Cluster {
    alignas(64) float x[kRuns], y[kRuns], z[kRuns];  ///< m, middles of the runs' boxes
    alignas(64) float half_x[kRuns], half_y[kRuns],
        half_z[kRuns];           ///< m, of their extents; negative where there is no run
    std::uint32_t begin[kRuns];  ///< their first spheres
    std::uint8_t count[kRuns];   ///< of their spheres
    vec3 low, high;              ///< m, of all
    int runs;
  };
  SphereGroups() = default;
  /// @throws Error limit_exceeded: more than 2^32 spheres
  explicit SphereGroups(const Spheres& spheres);
  /// Pieces of the clusters, in the order of the spheres.
  std::span<const std::vector<Cluster>> pieces() const { return pieces_; }
  std::size_t clusters() const;
  std::uint64_t memory_bytes() const;

 private:
  std::vector<std::vector<Cluster>> pieces_;
};

/// Spheres and their groups, which outlive the call that they are given to.
struct GroupedSpheres {
  Spheres spheres;
  const SphereGroups* groups;
};

/// For every pixel centre the least distance at which its ray enters a sphere
/// of any of the sets (0 if it starts inside of one) and a distance behind
/// which it leaves none; +infinity and -infinity where it meets none. Entries
/// are exact, exits may be too far: they are those of the boxes of runs, and
/// hold for squares of 8 x 8 pixels.
void splat_entries(const View& view, std::span<const GroupedSpheres> sets, Image<float>& entry, Image<float>& exit);

/// For every `stride`-th pixel in both directions (at the centre of each block of stride x stride pixels) the
/// summed length of its ray inside the spheres, times `weight`; ceil(width / stride) x ceil(height / stride).
/// The sum runs in the order of the spheres, whatever the number of threads.
Image<float> splat_chords(const View& view, const Spheres& spheres, float weight, int stride);

}  // namespace meniscus
