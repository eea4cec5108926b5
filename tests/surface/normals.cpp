// Normals of [Xiao2017] 3.3 where the answer is known without summing.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

glm::mat3 random_turn(Random& random) {
  const vec3 a = random.direction(), b = glm::normalize(glm::cross(a, random.direction()));
  return glm::mat3(a, b, glm::cross(a, b));
}

TEST(PcaNormals, OfASheetAreTheSheetsNormal) {
  Random random(81);
  for (int i = 0; i < 6; ++i) {
    const glm::mat3 turn = i == 0 ? glm::mat3(1.0f) : random_turn(random);
    const Particles sheet = moved(lattice_box(20, 20, 2, 0.1f, random.bits()), [&](vec3 p) { return turn * p; });
    const vec3 normal = turn[2];
    for (const NormalMethod method : {NormalMethod::pca, NormalMethod::blend}) {
      RaycastOptions with = options();
      with.normals = method;
      const View view = looking_at(sheet.bounds(), normal + 0.3f * turn[0], Projection::orthographic, 96, 96);
      const SurfaceBuffers seen = make_raycast_surface(sheet, with)->see(view);
      double most = 0;
      int looked = 0;
      for_each_hit(view, seen, [&](int x, int y, const Ray&, vec3 point) {
        const vec3 at = glm::transpose(turn) * point;
        if (std::max(std::abs(at.x), std::abs(at.y)) > 6 * kSpacing) return;
        most = std::max(most, degrees_between(seen.normal(x, y), normal));
        ++looked;
      });
      EXPECT_GT(looked, 300);
      EXPECT_LT(most, 4.0) << i;
    }
  }
}

TEST(Normals, PointOutOfTheWaterTowardsTheEye) {
  const Particles particles = wavy_tank();
  for (const NormalMethod method : {NormalMethod::gradient, NormalMethod::pca, NormalMethod::blend}) {
    RaycastOptions with = options();
    with.normals = method;
    const View view = looking_at(particles.bounds(), {1, 1, 1}, Projection::perspective, 96, 72);
    const SurfaceBuffers seen = make_raycast_surface(particles, with)->see(view);
    std::size_t away = 0;
    for_each_hit(view, seen, [&](int x, int y, const Ray& ray, vec3) {
      away += glm::dot(seen.normal(x, y), ray.direction) > 0.2f;
    });
    EXPECT_LT(static_cast<double>(away) / static_cast<double>(hits(seen)), method == NormalMethod::pca ? 0.15 : 0.02);
  }
}

TEST(FewNeighbours, LeaveTheGradientAlone) {
  // Fewer than five particles have no covariance to speak of: all methods give the gradient.
  for (const int count : {1, 2, 3, 4}) {
    Random random(82);
    Particles drop;
    for (int i = 0; i < count; ++i) add(drop, 0.4f * kSpacing * random.in_cube(1));
    const View view = looking_at(drop.bounds().grown(kSpacing), {1, 2, 3}, Projection::orthographic, 64, 64);
    RaycastOptions with = options();
    with.filter_radius = 0;
    with.normals = NormalMethod::gradient;
    const SurfaceBuffers gradient = make_raycast_surface(drop, with)->see(view);
    for (const NormalMethod method : {NormalMethod::pca, NormalMethod::blend}) {
      with.normals = method;
      const Difference d = difference(gradient, make_raycast_surface(drop, with)->see(view));
      EXPECT_GT(d.hits, 50u);
      EXPECT_LT(d.normal_p99, 1e-2) << count;
    }
  }
}

TEST(CollinearNeighbours, LeaveTheGradientAlone) {
  Particles line;
  for (int i = 0; i < 12; ++i) add(line, vec3{static_cast<float>(i) * kSpacing, 0, 0});
  const View view = looking_at(line.bounds().grown(kSpacing), {0, 1, 0.4f}, Projection::orthographic, 128, 96);
  RaycastOptions with = options();
  with.filter_radius = 0;
  with.normals = NormalMethod::gradient;
  const SurfaceBuffers gradient = make_raycast_surface(line, with)->see(view);
  for (const NormalMethod method : {NormalMethod::pca, NormalMethod::blend}) {
    with.normals = method;
    const Difference d = difference(gradient, make_raycast_surface(line, with)->see(view));
    EXPECT_GT(d.hits, 200u);
    EXPECT_LT(d.normal_p99, 0.1) << d;
  }
}

TEST(Blend, OnAFlatSurfaceIsSmootherThanTheGradient) {
  // What figure 3 of the paper shows, in numbers: jittered particles, no filter.
  const Particles particles = lattice_box(24, 24, 8, 0.25f);
  const View view = looking_at(particles.bounds(), {0.2f, 0.1f, 1}, Projection::orthographic, 96, 96);
  const auto deviation = [&](NormalMethod method, int filter) {
    RaycastOptions with = options();
    with.normals = method;
    with.filter_radius = filter;
    const SurfaceBuffers seen = make_raycast_surface(particles, with)->see(view);
    double sum = 0;
    int count = 0;
    for_each_hit(view, seen, [&](int x, int y, const Ray&, vec3 point) {
      if (std::max(std::abs(point.x), std::abs(point.y)) > 7 * kSpacing || point.z < 0) return;
      sum += degrees_between(seen.normal(x, y), {0, 0, 1});
      ++count;
    });
    return sum / count;
  };
  const double gradient = deviation(NormalMethod::gradient, 0), pca = deviation(NormalMethod::pca, 0),
               blend = deviation(NormalMethod::blend, 0), filtered = deviation(NormalMethod::blend, 4);
  EXPECT_LT(pca, gradient);
  EXPECT_LT(blend, gradient);
  EXPECT_LT(filtered, blend);
}

}  // namespace
}  // namespace meniscus
