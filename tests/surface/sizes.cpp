// Particles with spacings and smoothing lengths of their own, against sums over all of them in double precision.
#include "surface/particle_sizes.h"
#include "surface/sized_clouds.h"

namespace meniscus {
namespace {

using namespace surface_tests;

using dvec3 = glm::dvec3;

/// rho(x) = sum_j m_j s_j^3 W(|x - p_j|, h_j) with the cubic spline, and eq. 2 to 6 with radii and volumes of their
/// own.
class Sums {
 public:
  Sums(const Cloud& cloud, const RaycastOptions& with) : with_(with) {
    const double per_spacing = with.smoothing_length == 0 ? 2 : with.smoothing_length / with.spacing;
    for (std::size_t i = 0; i < cloud.particles.size(); ++i) {
      const double s = cloud.spacing.empty() ? with.spacing : cloud.spacing[i];
      const double h = cloud.smoothing_length.empty() ? s * per_spacing : cloud.smoothing_length[i];
      all_.push_back({dvec3(cloud.particles.position(i)), s, h, 1});
    }
    if (!with.keep_thin) return;
    std::vector<double> mass;
    for (const One& one : all_) {
      RaycastOptions own = with;
      own.spacing = static_cast<float>(one.s);
      own.smoothing_length = static_cast<float>(one.h);
      const MassRule rule = mass_rule(own);
      const double thin =
          (rule.full_density - density(one.at)) / (static_cast<double>(rule.full_density) - rule.lone_density);
      mass.push_back(1 + (static_cast<double>(rule.lone_mass) - 1) * std::clamp(thin, 0.0, 1.0));
    }
    for (std::size_t i = 0; i < all_.size(); ++i) all_[i].mass = mass[i];
  }

  double density(dvec3 x) const {
    double sum = 0;
    for (const One& one : all_) {
      const double q = glm::length(x - one.at) / one.h;
      if (q >= 1) continue;
      const double shape = q < 0.5 ? 1 - 6 * q * q + 6 * q * q * q : 2 * std::pow(1 - q, 3);
      sum += one.mass * std::pow(one.s / one.h, 3) * 8 / std::numbers::pi * shape;
    }
    return sum;
  }

  /// First place along the ray where rho reaches the iso-value, by small steps and bisection.
  double first_crossing(const Ray& ray, double last) const {
    const dvec3 origin(ray.origin), direction(ray.direction);
    Sums part;
    double first = last;
    for (const One& one : all_) {
      const dvec3 off = one.at - origin;
      const double along = glm::dot(off, direction);
      if (glm::length(off - along * direction) > one.h) continue;
      part.all_.push_back(one);
      first = std::min(first, along - one.h);
    }
    const double step = 0.02 * with_.spacing;
    for (double t = std::max(first, 0.0); t < last; t += step) {
      if (part.density(origin + t * direction) < with_.iso) continue;
      double low = std::max(t - step, 0.0), high = t;
      for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (part.density(origin + middle * direction) < with_.iso ? low : high) = middle;
      }
      return high;
    }
    return static_cast<double>(kInfinity);
  }

  dvec3 normal(dvec3 x) const {
    const double per_spacing = with_.normal_radius == 0 ? 3 : with_.normal_radius / with_.spacing;
    dvec3 gradient{0}, mean{0};
    double weights = 0;
    std::vector<std::pair<dvec3, double>> near;
    for (const One& one : all_) {
      const double R = per_spacing * one.s, r = glm::length(x - one.at), volume = std::pow(one.s, 3);
      if (r >= R) continue;
      gradient += volume * -45 / (std::numbers::pi * std::pow(R, 6)) * (R - r) * (R - r) * (x - one.at) / r;
      const double weight = volume * (1 - std::pow(r / R, 3));
      near.emplace_back(one.at, weight);
      mean += weight * one.at;
      weights += weight;
    }
    mean /= weights;
    glm::dmat3 c(0.0);
    for (const auto& [p, weight] : near) c += weight / weights * glm::outerProduct(p - mean, p - mean);
    const dvec3 outwards = -glm::normalize(gradient);
    if (near.size() < static_cast<std::size_t>(kFewestNeighboursForPca)) return outwards;
    // By powers of (trace - C), whose largest eigenvalue is the least of C.
    glm::dmat3 m = glm::dmat3(1.0) - c / (c[0][0] + c[1][1] + c[2][2]);
    for (int i = 0; i < 40; ++i) {
      m = m * m;
      m = m / (m[0][0] + m[1][1] + m[2][2]);
    }
    int column = 0;
    for (int i = 1; i < 3; ++i)
      if (m[i][i] > m[column][column]) column = i;
    dvec3 pca = glm::normalize(m[column]);
    if (glm::dot(pca, outwards) < 0) pca = -pca;
    const double w = std::min(1.0, std::exp(10 * (glm::dot(outwards, pca) - 0.998)));
    return glm::normalize((1 - w) * outwards + w * pca);
  }

 private:
  struct One {
    dvec3 at;
    double s, h, mass;
  };
  Sums() = default;

  RaycastOptions with_;
  std::vector<One> all_;
};

using Make = std::unique_ptr<Surface> (*)(const Particles&, const RaycastOptions&, std::span<const vec3>, StageTimes*,
                                          const ParticleSizes&);

class Sizes : public testing::TestWithParam<Make> {
 protected:
  static std::unique_ptr<Surface> surface(const Cloud& cloud, const RaycastOptions& with = options(),
                                          std::span<const vec3> colours = {}) {
    return GetParam()(cloud.particles, with, colours, nullptr, cloud.sizes());
  }
};

TEST_P(Sizes, DepthIsTheFirstCrossingOfTheSumOverAllSizes) {
  for (int which = 0; which < 4; ++which)
    for (const bool keep_thin : {true, false}) {
      const Cloud& cloud = cloud_of(which);
      RaycastOptions with = options();
      with.keep_thin = keep_thin;
      with.want_normals = with.want_thickness = false;
      const Sums sums(cloud, with);
      const View view = looking_at(cloud.particles.bounds(), {1, 0.6f, 0.8f}, kProjections[which % 2], 26, 20);
      const SurfaceBuffers seen = surface(cloud, with)->see(view);
      int mismatches = 0;
      std::vector<double> errors;
      for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
          const double expected = sums.first_crossing(pixel_ray(view, x, y), 2.0 * glm::length(view.eye));
          const bool hit = seen.depth(x, y) < kInfinity, expects = expected < static_cast<double>(kInfinity);
          mismatches += hit != expects;
          if (hit && expects) errors.push_back(std::abs(seen.depth(x, y) - expected) / kSpacing);
        }
      const std::string what = "cloud " + std::to_string(which) + (keep_thin ? "" : ", unit masses");
      EXPECT_GT(errors.size(), 60u) << what;
      EXPECT_LE(mismatches, 2) << what;  // what a march of a quarter of h can step over
      EXPECT_LT(quantile(errors, 0.5), 0.01) << what;
      EXPECT_LT(quantile(errors, 0.95), 0.03) << what;
    }
}

TEST_P(Sizes, NormalsHaveRadiiAndVolumesOfTheirOwn) {
  for (int which = 0; which < 4; ++which) {
    const Cloud& cloud = cloud_of(which);
    RaycastOptions with = options();
    with.filter_radius = 0;
    const Sums sums(cloud, with);
    const View view = looking_at(cloud.particles.bounds(), {0.4f, -0.6f, 1}, Projection::perspective, 36, 27);
    const SurfaceBuffers seen = surface(cloud, with)->see(view);
    std::vector<double> off;
    for_each_hit(view, seen, [&](int x, int y, const Ray&, vec3 point) {
      off.push_back(degrees_between(seen.normal(x, y), vec3(sums.normal(dvec3(point)))));
    });
    ASSERT_GT(off.size(), 150u) << which;
    EXPECT_LT(quantile(off, 0.5), 0.05) << which;
    EXPECT_LT(quantile(off, 0.98), 0.3) << which;
  }
}

TEST_P(Sizes, ThatAreAllAlikeGiveTheBitsOfNoSizes) {
  const Particles particles = wavy_tank(4);
  const View view = looking_at(particles.bounds(), {1, 0.5f, 0.9f}, Projection::perspective, 60, 44);
  RaycastOptions with = options();
  const auto seen = GetParam()(particles, with, {}, nullptr, {})->see(view);
  const std::vector<float> spacing(particles.size(), kSpacing), length(particles.size(), 2 * kSpacing);
  EXPECT_TRUE(same_bits(seen, GetParam()(particles, with, {}, nullptr, {spacing, {}})->see(view)));
  EXPECT_TRUE(same_bits(seen, GetParam()(particles, with, {}, nullptr, {spacing, length})->see(view)));
  with.spacing = 3 * kSpacing;  // what the options say does not matter then
  EXPECT_TRUE(same_bits(seen, GetParam()(particles, with, {}, nullptr, {spacing, {}})->see(view)));
}

TEST_P(Sizes, ThatAreNearlyAlikeGiveNearlyThePictureOfNoSizes) {
  const Particles particles = wavy_tank(4);
  const View view = looking_at(particles.bounds(), {1, 0.5f, 0.9f}, Projection::perspective, 60, 44);
  std::vector<float> spacing(particles.size(), kSpacing);
  for (std::size_t i = 0; i < spacing.size(); i += 2) spacing[i] *= 1.001f;
  const Difference d = difference(GetParam()(particles, options(), {}, nullptr, {})->see(view),
                                  GetParam()(particles, options(), {}, nullptr, {spacing, {}})->see(view));
  EXPECT_GT(d.hits, 500u);
  EXPECT_LT(d.mismatch, 3e-3) << d;
  EXPECT_LT(d.depth_p99, 0.05) << d;
  EXPECT_LT(d.normal_p99, 1.0) << d;
}

TEST_P(Sizes, ThicknessIsTheVolumeOfEachParticle) {
  Cloud cloud;
  Random random(6);
  double volume = 0;
  for (int i = 0; i < 60; ++i) {
    const float s = i % 2 == 0 ? 0.05f : 0.15f;
    cloud.put(random.in_cube(0.5f), s);
    volume += std::pow(static_cast<double>(s), 3);
  }
  const View view = orthographic_view({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 1.6f, 320, 320);
  const Image<float> thickness = surface(cloud)->thickness(view);
  double seen = 0;
  for (const float t : thickness) seen += static_cast<double>(t) * std::pow(1.6 / 320, 2);
  EXPECT_NEAR(seen / volume, 1, 0.045);  // smoothing keeps the volume to 4 %
}

TEST_P(Sizes, ColoursMixByVolume) {
  // A large red and a small blue particle in one place: red is worth 27 of the blue one.
  Cloud cloud;
  cloud.put({0, 0, 0}, 0.15f);
  cloud.put({0, 0, 0}, 0.05f);
  RaycastOptions with = options();
  with.keep_thin = false;
  with.iso = 0.3f;
  const std::vector<vec3> colours{{1, 0, 0}, {0, 0, 1}};
  const View view = orthographic_view({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 0.1f, 9, 9);
  const SurfaceBuffers seen = surface(cloud, with, colours)->see(view);
  ASSERT_LT(seen.depth(4, 4), kInfinity);
  const double r = 1 - static_cast<double>(seen.depth(4, 4));
  const auto weight = [&](double h) {
    return r < h ? (2 * r < h ? 1 - 6 * std::pow(r / h, 2) + 6 * std::pow(r / h, 3) : 2 * std::pow(1 - r / h, 3)) : 0.0;
  };
  const double red = weight(0.3), blue = weight(0.1);
  EXPECT_NEAR(seen.colour(4, 4).x, red / (red + blue), 1e-3);
}

TEST_P(Sizes, AreRefusedWithTheParticleWhenTheyAreNoLengths) {
  const Particles particles = lattice_box(3, 3, 3);
  const auto error = [&](const std::vector<float>& spacing, const std::vector<float>& length) {
    try {
      GetParam()(particles, options(), {}, nullptr, {spacing, length});
    } catch (const Error& thrown) {
      return std::string(thrown.what());
    }
    return std::string("no error");
  };
  const std::vector<float> good(27, kSpacing);
  for (const float bad : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), kInfinity}) {
    std::vector<float> spacing = good;
    spacing[7] = bad;
    EXPECT_NE(error(spacing, {}).find("particle 7"), std::string::npos) << error(spacing, {});
    EXPECT_NE(error({}, spacing).find("particle 7"), std::string::npos) << error({}, spacing);
  }
  EXPECT_NE(error(std::vector<float>(26, kSpacing), {}).find("26"), std::string::npos);
  EXPECT_NE(error({}, std::vector<float>(28, kSpacing)).find("28"), std::string::npos);
  std::vector<float> wide = good;
  wide[3] = 1e6f * kSpacing;
  EXPECT_NE(error(wide, {}).find("64"), std::string::npos) << error(wide, {});
  wide[3] = 63 * kSpacing;
  EXPECT_EQ(error(wide, {}), "no error");
  std::vector<float> length(27, 2 * kSpacing);
  length[5] = 0.9f * kSpacing;
  EXPECT_NE(error(good, length).find("particle 5"), std::string::npos) << error(good, length);
}

TEST_P(Sizes, OfNoParticlesAreNoWater) {
  const View view = orthographic_view({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 1, 8, 8);
  EXPECT_EQ(hits(GetParam()(Particles{}, options(), {}, nullptr, {})->see(view)), 0u);
}

INSTANTIATE_TEST_SUITE_P(Plain, Sizes, testing::Values(&make_plain_raycast_surface));
INSTANTIATE_TEST_SUITE_P(Fast, Sizes, testing::Values(&make_raycast_surface));

}  // namespace
}  // namespace meniscus
