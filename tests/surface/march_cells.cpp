// Cells without water and amidst it: against all particles one by one, and as many as the particles justify.
#include "surface/march_cells.h"

#include "surface/fixtures.h"
#include "surface/masses.h"

namespace meniscus {
namespace {

using namespace surface_tests;
using Kind = MarchCells::Kind;

RaycastField field_of(const Particles& particles, Keep keep = Keep::band) {
  RaycastField field = make_field(particles, options(), {}, keep);
  find_masses(field);
  return field;
}

/// The density by one sum over all particles, in double precision.
double density_at(const RaycastField& all, vec3 point) {
  const double h = 2.0 * kSpacing;
  double sum = 0;
  for (std::size_t i = 0; i < all.grid.size(); ++i) {
    const double q = glm::length(glm::dvec3(all.grid.position(i)) - glm::dvec3(point)) / h;
    if (q >= 1) continue;
    const double w = q < 0.5 ? 1 - 6 * q * q + 6 * q * q * q : 2 * (1 - q) * (1 - q) * (1 - q);
    sum += static_cast<double>(all.mass[i]) / std::numbers::pi * w;  // spacing^3 8 / h^3 = 1
  }
  return sum;
}

/// A tank, deep enough to have particles that are left out, and drops up to 40 of its widths away.
Particles tank_in_spray() {
  Particles particles = lattice_box(34, 33, 30, 0.2f);
  Random random(17);
  for (int i = 0; i < 3000; ++i) add(particles, 1300 * kSpacing * random.in_cube(1));
  return particles;
}

TEST(MarchCells, TellWaterFromAirAsTheParticlesDo) {
  const Particles particles = tank_in_spray();
  const RaycastField all = field_of(particles, Keep::all);
  const RaycastField field = field_of(particles);
  ASSERT_TRUE(field.grid.has_deep());
  const MarchCells cells(field);
  EXPECT_EQ(cells.cell_size(), kSpacing);
  Random random(3);
  std::size_t inside = 0, outside = 0, deep = 0, known = 0;
  for (int i = 0; i < 3000; ++i) {
    const vec3 point = i % 4 == 0 ? particles.position(random.bits() % particles.size()) + kSpacing * random.in_cube(3)
                                  : kSpacing * random.in_cube(20);
    const Kind kind = cells.at(point);
    const double density = density_at(all, point);
    inside += kind == Kind::inside;
    outside += kind == Kind::outside;
    if (kind == Kind::inside) {
      EXPECT_GT(density, 0.55) << i;
    } else if (kind == Kind::outside) {
      EXPECT_LT(density, 0.5) << i;
    }
    if (glm::all(glm::lessThan(glm::abs(point), kSpacing * vec3(13)))) {
      ++deep;
      known += kind == Kind::inside;
    }
  }
  EXPECT_GT(inside, 500u);
  EXPECT_GT(outside, 500u);
  EXPECT_GT(deep, 100u);
  EXPECT_GT(known, deep - deep / 50);
}

TEST(MarchCells, AreOutsideWhereNoEntrySphereIs) {
  const Particles particles = tank_in_spray();
  const RaycastField field = field_of(particles, Keep::all);
  const MarchCells cells(field);
  // Of the box around each sphere no place is outside; next to a lone one, two cells from the box, all is.
  for (std::size_t i = 0; i < field.grid.size(); i += 5) {
    const vec3 p = field.grid.position(i);
    for (int k = 0; k < 8; ++k) {
      const vec3 off = 0.99f * field.entry_radius[i] * vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      ASSERT_NE(cells.at(p + off), Kind::outside) << i;
    }
  }
  EXPECT_EQ(cells.at(kSpacing * vec3(0, 0, 25)), Kind::outside);
  EXPECT_EQ(cells.at(kSpacing * vec3(0, 0, 1e6f)), Kind::outside);
}

TEST(MarchCells, OfPairsOfParticlesAreThoseTheySpan) {
  Particles two;
  add(two, {0, 0, 0});
  add(two, {500, 20, -3});
  const MarchCells cells(field_of(two));
  EXPECT_EQ(cells.at({0, 0, 0}), Kind::unknown);
  EXPECT_EQ(cells.at({500, 20, -3}), Kind::unknown);
  for (const float t : {0.01f, 0.3f, 0.5f, 0.99f}) EXPECT_EQ(cells.at(t * vec3{500, 20, -3}), Kind::outside);
  EXPECT_LT(cells.memory_bytes(), 8000u);
}

/// The first place at which at() tells another kind, by steps of a fiftieth of a spacing.
float left_by_steps(const MarchCells& cells, const Ray& ray, float t, float limit, Kind kind) {
  for (; t <= limit; t += 0.02f * kSpacing)
    if (cells.at(ray.origin + t * ray.direction) != kind) return t;
  return kInfinity;
}

TEST(MarchCells, AreLeftWhereTheKindChanges) {
  const Particles particles = tank_in_spray();
  const MarchCells cells(field_of(particles));
  Random random(31);
  const vec3 along[] = {
      {1, 0, 0}, {0, -1, 0}, {0, 0, 1}, glm::normalize(vec3{1, 1, 1}), glm::normalize(vec3{-1, 1, 0})};
  std::size_t left[3] = {0, 0, 0};
  for (int i = 0; i < 600; ++i) {
    const vec3 direction = i % 3 == 0 ? along[i / 3 % 5] : random.direction();
    vec3 origin = kSpacing * random.in_cube(24);
    if (i % 7 == 0) origin = kSpacing * glm::round(origin / kSpacing);  // through corners of cells, or next to them
    const Ray ray{origin, direction};
    const Kind kind = cells.at(origin);
    const float limit = 60 * kSpacing;
    const float expected = left_by_steps(cells, ray, 0, limit, kind), found = cells.leave(ray, 0, limit, kind);
    if (expected < kInfinity) {
      ++left[kind];
      // Steps may pass the corner of a cell that the ray cuts off.
      ASSERT_LE(found, expected + 1e-4f * kSpacing) << i;
      if (found < expected - 0.021f * kSpacing) {
        const vec3 at = ray.origin + found * ray.direction;
        bool near = false;
        for (int k = 0; k < 8; ++k)
          near |= cells.at(at + 0.02f * kSpacing * vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)) != kind;
        EXPECT_TRUE(near) << i << ": " << found << " for " << expected;
      }
    } else {
      EXPECT_TRUE(found > limit - kSpacing || cells.at(ray.origin + found * ray.direction) != kind) << i;
    }
  }
  EXPECT_GT(left[Kind::outside], 50u);
  EXPECT_GT(left[Kind::inside], 50u);
}

TEST(MarchCells, AreCrossedFromFarAway) {
  const Particles particles = tank_in_spray();
  const MarchCells cells(field_of(particles));
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      vec3 origin{0.37f * kSpacing}, direction{0};
      origin[axis] = side * 30000 * kSpacing;
      direction[axis] = -side;
      const float t = cells.leave({origin, direction}, 0, kInfinity, Kind::outside);
      ASSERT_LT(t, kInfinity);
      EXPECT_NE(cells.at(origin + (t + 0.01f * kSpacing) * direction), Kind::outside);
      EXPECT_EQ(cells.leave({origin, -direction}, 0, kInfinity, Kind::outside), kInfinity);
      EXPECT_EQ(cells.leave({origin, direction}, 0, kInfinity, Kind::inside), 0.0f);
    }
}

TEST(MarchCells, TakeTheMemoryOfTheSurfaceHoweverWideTheSpray) {
  // A tank of 30 spacings among drops that are spread over a thousand times its width.
  Particles particles = lattice_box(30, 30, 30, 0.2f);
  const std::uint64_t tank = MarchCells(field_of(particles)).memory_bytes();
  EXPECT_LT(tank, 40000u);  // a byte for each of some 33,000 cells and more would be needed
  Random random(11);
  for (int i = 0; i < 20000; ++i) add(particles, 15000 * kSpacing * random.in_cube(1));
  const MarchCells cells(field_of(particles));
  EXPECT_EQ(cells.cell_size(), kSpacing);
  EXPECT_LT(cells.memory_bytes(), tank + 20000u * 400u);
  EXPECT_EQ(cells.at(vec3{0}), Kind::inside);
}

TEST(MarchCells, OfATankDoNotChangeInACloudOfSpray) {
  // Rays within the tank find the same crossings with drops all around, far off, as without.
  const Particles alone = wavy_tank();
  Particles clouded = alone;
  Random random(6);
  for (int i = 0; i < 2000; ++i) {
    const vec3 p = 4000.0f * random.in_cube(1);
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 60) add(clouded, kSpacing * p);
  }
  // The corner of the box, which cells are counted from, is not where it was: crossings move by rounding only.
  const auto one = make_raycast_surface(alone, options()), other = make_raycast_surface(clouded, options());
  std::vector<Ray> rays;
  for (int i = 0; i < 2000; ++i) rays.push_back({kSpacing * random.in_cube(9), random.direction()});
  const std::vector<float> from(rays.size(), 0.0f), limit(rays.size(), 40 * kSpacing);
  std::vector<std::uint8_t> inside(rays.size());
  const RaycastField all = field_of(alone, Keep::all);
  for (std::size_t i = 0; i < rays.size(); ++i) inside[i] = density_at(all, rays[i].origin) >= 0.5;
  std::vector<Crossing> a(rays.size()), b(rays.size()), again(rays.size());
  one->crossings(rays, from, limit, inside, a);
  other->crossings(rays, from, limit, inside, b);
  std::size_t wrong = 0, crossed = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    crossed += a[i].distance < kInfinity;
    if (a[i].distance == b[i].distance) continue;
    wrong += !(std::abs(a[i].distance - b[i].distance) < 0.05f * kSpacing);
  }
  EXPECT_GT(crossed, 1000u);
  EXPECT_LE(wrong, 20u) << "rays that graze water thinner than a step";
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limited(threads);
    make_raycast_surface(clouded, options())->crossings(rays, from, limit, inside, again);
    EXPECT_EQ(std::memcmp(b.data(), again.data(), b.size() * sizeof(Crossing)), 0) << threads;
  }
}

TEST(MarchCells, OfNothingAreOutside) {
  const MarchCells cells(field_of({}));
  EXPECT_EQ(cells.at({0, 0, 0}), Kind::outside);
  EXPECT_EQ(cells.leave({{0, 0, 0}, {1, 0, 0}}, 2, 9, Kind::outside), kInfinity);
  EXPECT_EQ(cells.leave({{0, 0, 0}, {1, 0, 0}}, 2, 9, Kind::inside), 2);
  EXPECT_EQ(cells.memory_bytes(), 0u);
}

}  // namespace
}  // namespace meniscus
