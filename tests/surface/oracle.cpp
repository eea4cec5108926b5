// Depth and normals against the paper's equations summed over all particles in double precision.
#include "meniscus/formulas/kernels.h"
#include "surface/fixtures.h"
#include "surface/raycast_field.h"

namespace meniscus {
namespace {

using namespace surface_tests;

using dvec3 = glm::dvec3;

/// Shapes W(q) / W(0) and the values W(0, h) h^3 written again, in double precision.
double kernel_shape(Kernel kernel, double q) {
  if (q >= 1) return 0;
  switch (kernel) {
    case Kernel::cubic_spline:
      return q < 0.5 ? 1 - 6 * q * q + 6 * q * q * q : 2 * std::pow(1 - q, 3);
    case Kernel::poly6:
      return std::pow(1 - q * q, 3);
    case Kernel::wyvill:
      break;
  }
  const double a = q * q;
  return 1 - 22.0 / 9 * a + 17.0 / 9 * a * a - 4.0 / 9 * a * a * a;
}
double top(Kernel kernel) {
  switch (kernel) {
    case Kernel::cubic_spline:
      return 8 / std::numbers::pi;
    case Kernel::poly6:
      return 315 / (64 * std::numbers::pi);
    case Kernel::wyvill:
      break;
  }
  return 2835 / (4 * 184 * std::numbers::pi);
}

/// rho of eq. 1 relative to the bulk, with the masses that thin parts are given.
class Field {
 public:
  Field(const Particles& particles, RaycastOptions with) : particles_(particles), with_(with) {
    if (with_.smoothing_length == 0) with_.smoothing_length = 2 * with_.spacing;
    if (with_.normal_radius == 0) with_.normal_radius = 3 * with_.spacing;
    mass_.assign(particles.size(), 1.0);
    if (!with_.keep_thin) return;
    const MassRule rule = mass_rule(with_);
    std::vector<double> mass;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const double thin = (rule.full_density - density(dvec3(particles.position(i)))) /
                          (static_cast<double>(rule.full_density) - rule.lone_density);
      mass.push_back(1 + (static_cast<double>(rule.lone_mass) - 1) * std::clamp(thin, 0.0, 1.0));
    }
    mass_ = mass;
  }
  double density(dvec3 at) const {
    const double h = with_.smoothing_length, scale = std::pow(with_.spacing / h, 3) * top(with_.kernel);
    double sum = 0;
    for (std::size_t j = 0; j < particles_.size(); ++j) {
      const dvec3 off = dvec3(particles_.position(j)) - at;
      const double r2 = glm::dot(off, off);
      if (r2 < h * h) sum += mass_[j] * kernel_shape(with_.kernel, std::sqrt(r2) / h);
    }
    return scale * sum;
  }
  /// First place along the ray where rho reaches the iso-value, by small steps from its start and bisection.
  double first_crossing(const Ray& ray, double last) const {
    const dvec3 origin(ray.origin), direction(ray.direction);
    const double step = 0.02 * with_.spacing;
    // Only the particles near the ray matter.
    Particles near;
    std::vector<double> masses;
    for (std::size_t j = 0; j < particles_.size(); ++j) {
      const dvec3 off = dvec3(particles_.position(j)) - origin;
      if (glm::length(off - glm::dot(off, direction) * direction) > with_.smoothing_length) continue;
      add(near, particles_.position(j));
      masses.push_back(mass_[j]);
    }
    Field part(near, with_, masses);
    for (double t = 0; t < last; t += step) {
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

  struct Normals {
    dvec3 gradient, pca, blend;
    double w;
  };
  /// Eq. 2 to 6 as the paper writes them.
  Normals normals(dvec3 at) const {
    const double R = with_.normal_radius;
    dvec3 gradient{0}, mean{0};
    double weights = 0;
    std::vector<std::pair<dvec3, double>> near;
    for (std::size_t j = 0; j < particles_.size(); ++j) {
      const dvec3 p(particles_.position(j));
      const double r = glm::length(at - p);
      if (r >= R) continue;
      gradient += -45 / (std::numbers::pi * std::pow(R, 6)) * (R - r) * (R - r) * (at - p) / r;
      const double weight = 1 - std::pow(r / R, 3);
      near.emplace_back(p, weight);
      mean += weight * p;
      weights += weight;
    }
    mean /= weights;
    glm::dmat3 c(0.0);
    for (const auto& [p, weight] : near) c += weight / weights * glm::outerProduct(p - mean, p - mean);
    Normals result{};
    result.gradient = -glm::normalize(gradient);  // out of the water: against the density's gradient
    result.pca = least_eigenvector(c);
    if (glm::dot(result.pca, result.gradient) < 0) result.pca = -result.pca;
    result.w = std::min(1.0, std::exp(10 * (glm::dot(result.gradient, result.pca) - 0.998)));
    result.blend = glm::normalize((1 - result.w) * result.gradient + result.w * result.pca);
    return result;
  }

 private:
  Field(const Particles& particles, RaycastOptions with, std::vector<double> masses)
      : particles_(particles), with_(with), mass_(std::move(masses)) {}
  /// By powers of (trace - C), whose largest eigenvalue is the least of C: no relation to Jacobi's iteration.
  static dvec3 least_eigenvector(const glm::dmat3& c) {
    const double trace = c[0][0] + c[1][1] + c[2][2];
    glm::dmat3 m = glm::dmat3(1.0) - c / trace;
    for (int i = 0; i < 40; ++i) {
      m = m * m;
      m = m / (m[0][0] + m[1][1] + m[2][2]);
    }
    int column = 0;
    for (int i = 1; i < 3; ++i)
      if (m[i][i] > m[column][column]) column = i;
    return glm::normalize(m[column]);
  }

  Particles particles_;
  RaycastOptions with_;
  std::vector<double> mass_;
};

TEST(RaycastDepth, IsTheFirstCrossingAlongTheRay) {
  const Particles particles = wavy_tank();
  for (const Kernel kernel : kKernels)
    for (const bool keep_thin : {true, false}) {
      RaycastOptions with = options();
      with.kernel = kernel;
      with.keep_thin = keep_thin;
      with.want_normals = with.want_thickness = false;
      const Field field(particles, with);
      const View view = looking_at(particles.bounds(), {1, 0.3f, 0.8f}, Projection::perspective, 30, 22);
      const SurfaceBuffers seen = make_raycast_surface(particles, with)->see(view);
      int mismatches = 0;
      std::vector<double> errors;
      for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
          const double expected = field.first_crossing(pixel_ray(view, x, y), 2.0 * glm::length(view.eye));
          const bool hit = seen.depth(x, y) < kInfinity;
          mismatches += hit != (expected < static_cast<double>(kInfinity));
          if (hit && expected < static_cast<double>(kInfinity))
            errors.push_back(std::abs(seen.depth(x, y) - expected) / kSpacing);
        }
      const std::string what = std::string(surface_tests::name_of(kernel)) + (keep_thin ? "" : ", unit masses");
      EXPECT_GT(errors.size(), 100u) << what;
      EXPECT_LE(mismatches, 2) << what;  // what a march of a quarter of h can step over
      EXPECT_LT(quantile(errors, 0.5), 0.01) << what;
      EXPECT_LT(quantile(errors, 0.95), 0.03) << what;
    }
}

TEST(RaycastDepth, ConvergesWithTheStepAndTheRefinement) {
  const Particles particles = lattice_ball(5, 0.2f);
  RaycastOptions with = options();
  with.want_normals = with.want_thickness = false;
  with.step = 0.05f;
  with.refinement = Refinement::bisection;
  with.refinement_steps = 12;
  const Field field(particles, with);
  const View view = looking_at(particles.bounds(), {1, 0.3f, 0.8f}, Projection::orthographic, 24, 24);
  const SurfaceBuffers seen = make_raycast_surface(particles, with)->see(view);
  std::vector<double> errors;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      if (seen.depth(x, y) < kInfinity)
        errors.push_back(std::abs(seen.depth(x, y) - field.first_crossing(pixel_ray(view, x, y), 10)) / kSpacing);
  ASSERT_GT(errors.size(), 100u);
  EXPECT_LT(quantile(errors, 0.99), 3e-4);
}

TEST(RaycastNormals, AreThoseOfEquations2To6) {
  const Particles particles = wavy_tank();
  const Field field(particles, options());
  const View view = looking_at(particles.bounds(), {0.3f, 0.6f, 1}, Projection::perspective, 40, 30);
  bool some_blended = false;
  for (const NormalMethod method : {NormalMethod::gradient, NormalMethod::pca, NormalMethod::blend}) {
    RaycastOptions with = options();
    with.normals = method;
    with.filter_radius = 0;
    const SurfaceBuffers fast = make_raycast_surface(particles, with)->see(view),
                         plain = make_plain_raycast_surface(particles, with)->see(view);
    std::vector<double> fast_off, plain_off;
    for (const SurfaceBuffers* seen : {&fast, &plain})
      for_each_hit(view, *seen, [&](int x, int y, const Ray&, vec3 point) {
        if (point.z > 4 * kSpacing) return;  // drops: see FewNeighbours
        const Field::Normals n = field.normals(dvec3(point));
        some_blended = some_blended || (n.w > 0.05 && n.w < 0.95);
        const dvec3 expected = method == NormalMethod::gradient ? n.gradient
                               : method == NormalMethod::pca    ? n.pca
                                                                : n.blend;
        (seen == &fast ? fast_off : plain_off).push_back(degrees_between(seen->normal(x, y), vec3(expected)));
      });
    ASSERT_GT(fast_off.size(), 200u);
    EXPECT_LT(quantile(fast_off, 0.99), 0.2);
    EXPECT_LT(quantile(plain_off, 0.99), 0.2);
  }
  EXPECT_TRUE(some_blended);
}

}  // namespace
}  // namespace meniscus
