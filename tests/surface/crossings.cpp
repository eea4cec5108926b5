// Rays through the water against a plain march in double precision, and what must hold for any of them.
#include "meniscus/formulas/kernels.h"
#include "surface/fixtures.h"
#include "surface/raycast_field.h"

namespace meniscus {
namespace {

using namespace surface_tests;

/// The density of eq. 1 by one sum over all particles, in double precision; cubic spline, masses as given.
class Oracle {
 public:
  Oracle(const Particles& particles, const RaycastOptions& given) : options_(given) {
    RaycastOptions resolved = given;
    if (resolved.smoothing_length == 0) resolved.smoothing_length = 2 * resolved.spacing;
    options_ = resolved;
    for (std::size_t i = 0; i < particles.size(); ++i) positions_.push_back(glm::dvec3(particles.position(i)));
    masses_.assign(positions_.size(), 1.0);
    for (std::size_t i = 0; i < positions_.size(); ++i) all_.push_back(i);
    if (!resolved.keep_thin) return;
    const MassRule rule = mass_rule(resolved);
    std::vector<double> masses;
    for (const glm::dvec3& p : positions_)
      masses.push_back(static_cast<double>(mass_at(rule, static_cast<float>(density(p)))));
    masses_ = masses;
  }

  double density(glm::dvec3 point) const { return density(point, all_); }

  double density(glm::dvec3 point, const std::vector<std::size_t>& among) const {
    const double h = options_.smoothing_length, s = options_.spacing;
    double sum = 0;
    for (const std::size_t i : among) {
      const double q = glm::length(positions_[i] - point) / h;
      if (q >= 1) continue;
      // Monaghan's spline with support h: 8 / (pi h^3) times 2 (1 - q)^3 beyond half of it.
      const double w = q < 0.5 ? 1 - 6 * q * q + 6 * q * q * q : 2 * (1 - q) * (1 - q) * (1 - q);
      sum += masses_[i] * 8 / (std::numbers::pi * h * h * h) * w;
    }
    return s * s * s * sum;
  }

  bool in_water(glm::dvec3 point) const { return density(point) >= static_cast<double>(options_.iso); }

  /// Particles whose kernels the ray runs through.
  std::vector<std::size_t> along(glm::dvec3 o, glm::dvec3 d) const {
    std::vector<std::size_t> near;
    for (const std::size_t i : all_)
      if (glm::length(glm::cross(positions_[i] - o, d)) < 1.01 * static_cast<double>(options_.smoothing_length))
        near.push_back(i);
    return near;
  }

  /// The first crossing after `from`, by steps of a fiftieth of a spacing and bisection.
  double crossing(const Ray& ray, double from, double limit, bool inside) const {
    const glm::dvec3 o(ray.origin), d(ray.direction);
    const std::vector<std::size_t> near = along(o, d);
    const auto is_in = [&](double t) { return density(o + t * d, near) >= static_cast<double>(options_.iso); };
    const double step = 0.02 * options_.spacing;
    double before = from;
    for (double t = from + step; t <= limit; before = t, t += step) {
      if (is_in(t) == inside) continue;
      double low = before, high = t;
      for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (is_in(middle) == inside ? low : high) = middle;
      }
      return high;
    }
    return std::numeric_limits<double>::infinity();
  }

 private:
  RaycastOptions options_;
  std::vector<glm::dvec3> positions_;
  std::vector<double> masses_;
  std::vector<std::size_t> all_;
};

struct Query {
  std::vector<Ray> rays;
  std::vector<float> from, limit;
  std::vector<std::uint8_t> inside;
  void add(const Ray& ray, float f, float l, bool in) {
    rays.push_back(ray);
    from.push_back(f);
    limit.push_back(l);
    inside.push_back(in);
  }
  std::vector<Crossing> ask(const Surface& surface) const {
    std::vector<Crossing> found(rays.size());
    surface.crossings(rays, from, limit, inside, found);
    return found;
  }
};

TEST(Crossings, AgreeWithAPlainMarchInDoublePrecision) {
  // Rays from anywhere to anywhere in a wavy tank with drops, each on the side where it says it is.
  const Particles particles = wavy_tank();
  const RaycastOptions chosen = options();
  const auto surface = make_raycast_surface(particles, chosen);
  ASSERT_TRUE(surface->can_march());
  const Oracle oracle(particles, chosen);
  Random random(4);
  Query query;
  std::vector<double> expected;
  while (query.rays.size() < 300) {
    const vec3 origin = kSpacing * vec3{random.between(-11, 11), random.between(-11, 11), random.between(-6, 6)};
    const double density = oracle.density(glm::dvec3(origin));
    if (std::abs(density - 0.5) < 0.02) continue;
    const Ray ray{origin, random.direction()};
    const float from = query.rays.size() % 3 == 0 ? 0.4f * kSpacing : 0.0f;
    const bool inside = oracle.in_water(glm::dvec3(origin) + static_cast<double>(from) * glm::dvec3(ray.direction));
    const double limit = query.rays.size() % 5 == 0 ? 6 * kSpacing : 60 * kSpacing;
    query.add(ray, from, static_cast<float>(limit), inside);
    expected.push_back(oracle.crossing(ray, from, limit, inside));
  }
  const std::vector<Crossing> found = query.ask(*surface);
  std::size_t wrong = 0, crossed = 0, in = 0;
  std::vector<double> errors;
  for (std::size_t i = 0; i < found.size(); ++i) {
    in += query.inside[i];
    crossed += expected[i] < 1e9;
    if ((found[i].distance < kInfinity) != (expected[i] < 1e9)) {
      ++wrong;
      continue;
    }
    if (!(found[i].distance < kInfinity)) {
      EXPECT_EQ(found[i].normal, vec3{0.0f});
      continue;
    }
    errors.push_back(std::abs(static_cast<double>(found[i].distance) - expected[i]) / kSpacing);
    wrong += errors.back() > 0.1;
    EXPECT_NEAR(glm::length(found[i].normal), 1.0f, 1e-4f);
  }
  EXPECT_GT(crossed, 150u);
  EXPECT_GT(in, 80u);
  EXPECT_LE(wrong, 4u) << "rays that graze water thinner than a step";
  EXPECT_LT(quantile(errors, 0.9), 0.004);
}

TEST(Crossings, StartFromTheSurfaceItself) {
  // On with the ray from what see() shows: into the water and out at its far side, and out of it again.
  const Particles particles = wavy_tank();
  const RaycastOptions chosen = options();
  const auto surface = make_raycast_surface(particles, chosen);
  const Oracle oracle(particles, chosen);
  const View view = looking_at(particles.bounds(), {0.4f, -1, 0.8f}, Projection::perspective, 24, 20);
  const SurfaceBuffers seen = surface->see(view);
  Query in;
  for_each_hit(view, seen,
               [&](int x, int y, const Ray& ray, vec3) { in.add(ray, seen.depth(x, y), 100 * kSpacing, true); });
  const std::vector<Crossing> far = in.ask(*surface);
  Query out;
  std::size_t close = 0, outwards = 0;
  for (std::size_t i = 0; i < far.size(); ++i) {
    ASSERT_LT(far[i].distance, kInfinity) << "what goes in comes out";
    const double start = static_cast<double>(in.from[i]) + 0.01 * kSpacing;
    const double expected = oracle.crossing(in.rays[i], start, 100 * kSpacing, true);
    close += std::abs(static_cast<double>(far[i].distance) - expected) < 0.02 * kSpacing;
    outwards += glm::dot(far[i].normal, in.rays[i].direction) > 0;
    out.add(in.rays[i], far[i].distance, kInfinity, false);
  }
  EXPECT_GE(static_cast<double>(close), 0.97 * static_cast<double>(far.size()));
  EXPECT_GE(static_cast<double>(outwards), 0.97 * static_cast<double>(far.size()));
  const std::vector<Crossing> again = out.ask(*surface);
  std::size_t same = 0, met = 0;
  for (std::size_t i = 0; i < again.size(); ++i) {
    const double start = static_cast<double>(out.from[i]) + 0.01 * kSpacing;
    const double expected = oracle.crossing(out.rays[i], start, 100 * kSpacing, false);
    met += expected < 1e9;
    same += (again[i].distance < kInfinity) == (expected < 1e9) &&
            (!(expected < 1e9) || std::abs(static_cast<double>(again[i].distance) - expected) < 0.05 * kSpacing);
  }
  EXPECT_GT(met, 5u);
  EXPECT_GE(static_cast<double>(same), 0.97 * static_cast<double>(again.size()));
}

TEST(Crossings, HaveTheDepthsAndNormalsOfTheSeenSurface) {
  const Particles particles = wavy_tank();
  RaycastOptions chosen = options();
  chosen.filter_radius = 0;
  const auto surface = make_raycast_surface(particles, chosen);
  const View view = looking_at(particles.bounds(), {0.4f, -1, 0.8f}, Projection::perspective, 60, 50);
  const SurfaceBuffers seen = surface->see(view);
  Query query;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) query.add(pixel_ray(view, x, y), 0, kInfinity, false);
  const std::vector<Crossing> found = query.ask(*surface);
  SurfaceBuffers marched = seen;
  for (std::size_t i = 0; i < found.size(); ++i) {
    marched.depth[i] = found[i].distance;
    marched.normal[i] = found[i].normal;
  }
  const Difference d = difference(seen, marched);
  EXPECT_GT(d.hits, 500u);
  EXPECT_LT(d.mismatch, 0.002) << d;
  EXPECT_LT(d.depth_p99, 0.02) << d;
  EXPECT_LT(d.normal_p99, 1.0) << d;
}

TEST(Crossings, DoNotDependOnThreadsNorOnTheOtherRays) {
  const Particles particles = wavy_tank();
  Random random(8);
  Query query;
  for (int i = 0; i < 3000; ++i)
    query.add({kSpacing * random.in_cube(10), random.direction()}, 0, kInfinity, random.bits() & 1u);
  std::vector<Crossing> first;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    const auto surface = make_raycast_surface(particles, options());
    const std::vector<Crossing> found = query.ask(*surface);
    if (first.empty()) first = found;
    ASSERT_EQ(std::memcmp(first.data(), found.data(), found.size() * sizeof(Crossing)), 0) << threads;
  }
  const auto surface = make_raycast_surface(particles, options());
  for (std::size_t i = 0; i < 200; ++i) {
    Query one;
    one.add(query.rays[i], query.from[i], query.limit[i], query.inside[i]);
    EXPECT_EQ(one.ask(*surface)[0].distance, first[i].distance) << i;
  }
}

TEST(Crossings, GoThroughADropOfOneParticle) {
  Particles particles;
  add(particles, {0.1f, 0.2f, 0.3f});
  const auto surface = make_raycast_surface(particles, options());
  const float radius = static_cast<float>(kDropRadius) * kSpacing;
  for (const float off : {0.0f, 0.5f, 0.9f, 0.97f}) {
    const Ray ray{{0.1f - 1, 0.2f + off * radius, 0.3f}, {1, 0, 0}};
    Query query;
    query.add(ray, 0, kInfinity, false);
    const Crossing entry = query.ask(*surface)[0];
    const float half = std::sqrt(1 - off * off) * radius;
    ASSERT_NEAR(entry.distance, 1 - half, 0.05f * kSpacing) << off;
    Query on;
    on.add(ray, entry.distance, kInfinity, true);
    const Crossing exit = on.ask(*surface)[0];
    ASSERT_NEAR(exit.distance, 1 + half, 0.05f * kSpacing) << off;
    EXPECT_GT(glm::dot(exit.normal, ray.direction), 0) << off;
    Query past;
    past.add(ray, exit.distance, kInfinity, false);
    EXPECT_EQ(past.ask(*surface)[0].distance, kInfinity);
  }
}

TEST(Crossings, CrossAtTheStartWhereTheSideIsWrong) {
  const auto surface = make_raycast_surface(lattice_box(12, 12, 12), options());
  Query query;
  query.add({{0, 0, 0}, {1, 0, 0}}, 0.01f, kInfinity, false);   // deep inside, said to be outside
  query.add({{0, 0, 5}, {1, 0, 0}}, 0.25f, kInfinity, true);    // in the air, said to be inside
  query.add({{0, 0, 0}, {1, 0, 0}}, 0.0f, 2 * kSpacing, true);  // ends before the surface
  const std::vector<Crossing> found = query.ask(*surface);
  EXPECT_EQ(found[0].distance, 0.01f);
  EXPECT_EQ(found[1].distance, 0.25f);
  EXPECT_EQ(found[2].distance, kInfinity);
}

TEST(Crossings, FindNoWaterWhereThereIsNone) {
  const auto surface = make_raycast_surface({}, options());
  Query query;
  query.add({{0, 0, 0}, {1, 0, 0}}, 0, kInfinity, false);
  EXPECT_EQ(query.ask(*surface)[0].distance, kInfinity);
  Query none;
  EXPECT_TRUE(none.ask(*surface).empty());
}

TEST(Crossings, SurviveAnyRay) {
  Particles spray = clumped_cloud(600, 30, 5);
  add(spray, {300, 2, 1});  // far away: cells that are not stored densely
  const auto surface = make_raycast_surface(spray, options());
  Random random(21);
  Query query;
  const vec3 odd[] = {{0, 0, 1}, {0, -1, 0}, {1, 0, 0}, {1, 1e-20f, 0}};
  for (int i = 0; i < 2000; ++i)
    query.add({kSpacing * random.in_cube(20), i % 7 ? random.direction() : odd[i % 4]},
              kSpacing * random.between(-2, 9), i % 3 ? kInfinity : random.between(-1, 3), random.bits() & 1u);
  const std::vector<Crossing> found = query.ask(*surface);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!(found[i].distance < kInfinity)) continue;
    ASSERT_GE(found[i].distance, std::max(query.from[i], 0.0f));
    ASSERT_LE(found[i].distance, query.limit[i]);
    ASSERT_NEAR(glm::length(found[i].normal), 1.0f, 1e-4f);
  }
}

TEST(Crossings, RefuseListsOfDifferentLengths) {
  const auto surface = make_raycast_surface(lattice_box(3, 3, 3), options());
  std::vector<Ray> rays(2);
  std::vector<float> one(1), two(2);
  std::vector<std::uint8_t> inside(2);
  std::vector<Crossing> found(2);
  EXPECT_THROW(surface->crossings(rays, one, two, inside, found), Error);
}

TEST(Crossings, AreRefusedByASurfaceThatCannotMarch) {
  const auto surface = make_plain_raycast_surface(lattice_box(3, 3, 3), options());
  EXPECT_FALSE(surface->can_march());
  EXPECT_THROW(surface->crossings({}, {}, {}, {}, {}), Error);
}

}  // namespace
}  // namespace meniscus
