/// Spheres drawn into a picture: where rays first and last meet one, and how much of them rays run through.
#pragma once

#include "meniscus/base.h"

namespace meniscus {

/// Spheres by their centres and radii, world space, m; structure of arrays of one length. A radius of zero: no sphere.
struct Spheres {
  std::span<const float> x, y, z;
  std::span<const float> radius;  ///< one a sphere, or one for all
};

/// Boxes around runs of consecutive spheres, which pass a view together: few and small when consecutive spheres lie
/// near each other, as those of sorted particles do. It depends on no view.
class SphereGroups {
 public:
  struct Group {
    vec3 low, high;  ///< m, of the spheres
    std::uint32_t begin, end;
  };
  SphereGroups() = default;
  /// @throws Error limit_exceeded: more than 2^32 spheres
  explicit SphereGroups(const Spheres& spheres);
  std::span<const Group> groups() const { return groups_; }
  std::uint64_t memory_bytes() const { return groups_.capacity() * sizeof(Group); }

 private:
  std::vector<Group> groups_;
};

/// Spheres and their groups, which outlive the call that they are given to.
struct GroupedSpheres {
  Spheres spheres;
  const SphereGroups* groups;
};

/// For every pixel centre the least distance at which its ray enters a sphere (0 if it starts inside of one)
/// and the largest at which it leaves one; +infinity and -infinity where it meets none.
void splat_depth(const View& view, const Spheres& spheres, Image<float>& entry, Image<float>& exit);

/// The same entries, of several sets of spheres together, and exits that may be too far: spheres behind what covers a
/// part of the picture whole are not drawn, and the far side of their groups' boxes is taken. Where a ray meets no
/// sphere, entry and exit are +infinity and -infinity as above.
void splat_entries(const View& view, std::span<const GroupedSpheres> sets, Image<float>& entry, Image<float>& exit);

/// For every `stride`-th pixel in both directions (at the centre of each block of stride x stride pixels) the
/// summed length of its ray inside the spheres, times `weight`; ceil(width / stride) x ceil(height / stride).
/// The sum runs in the order of the spheres, whatever the number of threads.
Image<float> splat_chords(const View& view, const Spheres& spheres, float weight, int stride);

}  // namespace meniscus
