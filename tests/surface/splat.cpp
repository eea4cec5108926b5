// Splatted spheres against rays and spheres intersected in double precision.
#include "surface/splat.h"

#include <sstream>

#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

struct SphereList {
  std::vector<float> x, y, z, radius;
  void add(vec3 centre, float r) {
    x.push_back(centre.x);
    y.push_back(centre.y);
    z.push_back(centre.z);
    radius.push_back(r);
  }
  Spheres spheres() const { return {x, y, z, radius}; }
};

/// What all spheres do to one ray; `nearly` when some sphere is touched so narrowly that rounding decides.
struct Expected {
  double entry = kInfinity, exit = -kInfinity, sum = 0;
  bool nearly = false;
};

Expected expected(const SphereList& list, const View& view, vec2 point) {
  // The ray in double precision from the view's parts, so as not to compare with its own rounding.
  const double scale = 2.0 * view.half_height / view.height;
  const double u = (static_cast<double>(point.x) - 0.5 * view.width) * scale, v = (0.5 * view.height - point.y) * scale;
  glm::dvec3 origin(view.eye), direction(view.forward);
  if (view.projection == Projection::orthographic)
    origin += u * glm::dvec3(view.right) + v * glm::dvec3(view.up);
  else
    direction = glm::normalize(direction + u * glm::dvec3(view.right) + v * glm::dvec3(view.up));
  Expected result;
  for (std::size_t i = 0; i < list.x.size(); ++i) {
    const glm::dvec3 offset = glm::dvec3(list.x[i], list.y[i], list.z[i]) - origin;
    const double middle = glm::dot(offset, direction), r = list.radius[i];
    const glm::dvec3 across = offset - middle * direction;
    const double half2 = r * r - glm::dot(across, across);
    // Float positions of this size are known to some 1e-7 of the distance.
    const double doubt = 4e-6 * (glm::length(offset) + r) * (glm::length(across) + r);
    if (std::abs(half2) < doubt) result.nearly = true;
    if (half2 <= 0) continue;
    const double half = std::sqrt(half2);
    if (std::abs(middle + half) < 1e-5 * (std::abs(middle) + half)) result.nearly = true;
    if (middle + half <= 0) continue;
    result.entry = std::min(result.entry, std::max(middle - half, 0.0));
    result.exit = std::max(result.exit, middle + half);
    result.sum += middle + half - std::max(middle - half, 0.0);
  }
  return result;
}

/// Entries and exits of spheres that are one set.
void draw(const View& view, const Spheres& spheres, Image<float>& entry, Image<float>& exit) {
  const SphereGroups groups(spheres);
  const GroupedSpheres set{spheres, &groups};
  splat_entries(view, {&set, 1}, entry, exit);
}

void expect_as_in_double(const SphereList& list, const View& view, double tolerance = 2e-4) {
  Image<float> entry, exit;
  draw(view, list.spheres(), entry, exit);
  ASSERT_EQ(entry.width(), view.width);
  ASSERT_EQ(entry.height(), view.height);
  std::size_t met = 0, doubtful = 0, wrong = 0;
  std::ostringstream first;
  const Image<float> sums = splat_chords(view, list.spheres(), 0.25f, 1);
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const Expected e = expected(list, view, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
      const bool hit = e.entry < kInfinity;
      met += hit;
      if (e.nearly) {
        ++doubtful;
        continue;
      }
      bool good = hit == (entry(x, y) < kInfinity) && hit == (exit(x, y) > -kInfinity);
      if (hit)
        good = good && std::abs(entry(x, y) - e.entry) <= tolerance * std::max(1.0, e.exit) &&
               exit(x, y) >= e.exit - tolerance * std::max(1.0, e.exit);
      good = good && std::abs(sums(x, y) - 0.25 * e.sum) <= tolerance * std::max(1.0, e.sum);
      if (!good && wrong++ == 0)
        first << "(" << x << ", " << y << "): " << entry(x, y) << " .. " << exit(x, y) << " sum " << sums(x, y)
              << ", expected " << e.entry << " .. " << e.exit << " sum " << 0.25 * e.sum;
    }
  EXPECT_EQ(wrong, 0u) << first.str();
  EXPECT_GT(met, 0u);
  EXPECT_LT(doubtful, static_cast<std::size_t>(view.width * view.height) / 20);
}

View random_view(Random& random, Projection projection, int width, int height) {
  const vec3 eye = random.in_cube(0.5f), target = eye + random.direction();
  if (projection == Projection::orthographic)
    return orthographic_view(eye, target, {0, 0, 1}, random.between(1, 4), width, height);
  return perspective_view(eye, target, {0, 0, 1}, random.between(0.4f, 2.2f), width, height);
}

TEST(Splat, MatchesRaysAndSpheresInDoublePrecision) {
  Random random(61);
  for (int i = 0; i < 10; ++i) {
    SphereList list;
    for (int n = 0; n < 200; ++n) {
      const vec3 centre = random.in_cube(3);
      list.add(centre, random.between(0.02f, 0.5f));
    }
    // Sizes that are not multiples of the 64 x 64 tile.
    expect_as_in_double(list, random_view(random, kProjections[i % 2], 61 + 13 * i, 97 - 7 * i));
  }
}

TEST(Splat, MatchesForSpheresAroundAndBehindTheEye) {
  Random random(62);
  for (int i = 0; i < 8; ++i) {
    const View view = random_view(random, kProjections[i % 2], 70, 50);
    SphereList list;
    list.add(view.eye + 2.0f * view.forward, 0.3f);
    list.add(view.eye - 0.3f * view.forward, 0.2f);                      // behind
    list.add(view.eye - 0.1f * view.forward + 0.3f * view.right, 0.2f);  // beside, partly before
    list.add(view.eye + 0.05f * view.forward + 0.2f * view.up, 0.19f);   // almost touching
    if (i >= 4) list.add(view.eye + 0.01f * view.right, 0.05f);          // around
    expect_as_in_double(list, view);
  }
}

TEST(Splat, MatchesForHugeTinyAndDistantSpheres) {
  const View view = perspective_view({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0f, 75, 45);
  SphereList huge;
  huge.add({0, -100, 0}, 99.0f);
  huge.add({0, 0, -1000}, 300.0f);
  expect_as_in_double(huge, view, 1e-4);
  SphereList tiny;  // smaller than a pixel: met only if a pixel's centre is
  Random random(63);
  for (int n = 0; n < 4000; ++n) tiny.add({random.between(-1, 1), random.between(-1, 1), -2}, 0.005f);
  expect_as_in_double(tiny, view);
}

TEST(Splat, MatchesAtThePicturesBorder) {
  const View view = perspective_view({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0f, 65, 33);
  SphereList list;
  for (const float side : {-1.0f, 1.0f})
    for (float along = -1.2f; along <= 1.2f; along += 0.17f) {
      list.add(vec3{along * 1.07f, side * 0.546f, -1.0f} * 3.0f, 0.05f);
      list.add(vec3{side * 1.076f, along * 0.546f, -1.0f} * 3.0f, 0.05f);
    }
  expect_as_in_double(list, view);
}

TEST(Splat, TakesOneRadiusForAll) {
  Random random(64);
  SphereList list;
  for (int n = 0; n < 50; ++n) list.add(random.in_cube(1), 0.2f);
  const View view = perspective_view({0, -4, 0}, {0, 0, 0}, {0, 0, 1}, 0.6f, 80, 60);
  Image<float> entry, exit, same_entry, same_exit;
  draw(view, list.spheres(), entry, exit);
  const float radius = 0.2f;
  draw(view, {list.x, list.y, list.z, {&radius, 1}}, same_entry, same_exit);
  EXPECT_TRUE(same_bits(entry, same_entry) && same_bits(exit, same_exit));
}

TEST(Splat, SamplesChordsAtTheMiddlesOfBlocks) {
  Random random(65);
  SphereList list;
  for (int n = 0; n < 40; ++n) list.add(random.in_cube(1), random.between(0.2f, 0.5f));
  for (const Projection projection : kProjections)
    for (const int stride : {2, 3, 8}) {
      const View view = looking_at(Bounds{vec3{-1.4f}, vec3{1.4f}}, {1, 2, 0.5f}, projection, 83, 59);
      const Image<float> sums = splat_chords(view, list.spheres(), 2.0f, stride);
      ASSERT_EQ(sums.width(), (view.width + stride - 1) / stride);
      ASSERT_EQ(sums.height(), (view.height + stride - 1) / stride);
      for (int y = 0; y < sums.height(); ++y)
        for (int x = 0; x < sums.width(); ++x) {
          const vec2 middle{(static_cast<float>(x) + 0.5f) * static_cast<float>(stride),
                            (static_cast<float>(y) + 0.5f) * static_cast<float>(stride)};
          const Expected e = expected(list, view, middle);
          if (e.nearly) continue;
          ASSERT_NEAR(sums(x, y), 2 * e.sum, 1e-3) << x << ", " << y << " stride " << stride;
        }
    }
}

TEST(Splat, EntriesAreTheSameWithWhatIsHiddenLeftOutAndExitsNoNearer) {
  Random random(66);
  // A wall of many layers, in rows as sorted particles are, and a second set of few large spheres.
  SphereList wall, large;
  std::vector<SphereList> layers(12);
  for (int k = 0; k < 12; ++k)
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 60; ++i) {
        const vec3 centre = vec3{i, j, k} * 0.05f - vec3{1.5f, 1.5f, 0.0f} + 0.02f * random.in_cube(1);
        const float radius = i == 30 ? 0.0f : random.between(0.05f, 0.06f);
        wall.add(centre, radius);
        layers[static_cast<std::size_t>(k)].add(centre, radius);
      }
  for (int n = 0; n < 20; ++n) large.add(random.in_cube(2), 0.2f);
  layers.push_back(large);
  const SphereGroups wall_groups(wall.spheres()), large_groups(large.spheres());
  const std::vector<GroupedSpheres> sets{{wall.spheres(), &wall_groups}, {large.spheres(), &large_groups}};
  for (const Projection projection : kProjections)
    for (const vec3 direction : {vec3{0, 0, 1}, vec3{1, 0.4f, 0.5f}, vec3{1, 0.1f, 0.02f}}) {
      const View view = looking_at(Bounds{vec3{-1.6f}, vec3{1.6f}}, direction, projection, 203, 187);
      Image<float> entry, exit;
      splat_entries(view, sets, entry, exit);
      // Each layer alone hides little.
      Image<float> first(view.width, view.height, kInfinity);
      for (const SphereList& layer : layers)
        for (std::size_t begin = 0; begin < layer.x.size(); begin += 600) {
          const std::size_t count = std::min<std::size_t>(600, layer.x.size() - begin);
          Image<float> layer_entry, layer_exit;
          draw(view,
               {{&layer.x[begin], count},
                {&layer.y[begin], count},
                {&layer.z[begin], count},
                {&layer.radius[begin], count}},
               layer_entry, layer_exit);
          for (std::size_t i = 0; i < first.size(); ++i) first[i] = std::min(first[i], layer_entry[i]);
        }
      EXPECT_TRUE(same_bits(entry, first));
      for (int y = 3; y < view.height; y += 17)
        for (int x = 5; x < view.width; x += 17) {
          const vec2 point{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
          for (const SphereList& layer : layers) {
            const Expected e = expected(layer, view, point);
            if (!e.nearly && e.entry < kInfinity) ASSERT_GE(exit(x, y), e.exit - 1e-4);
          }
        }
      for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        Image<float> same_entry, same_exit;
        splat_entries(view, sets, same_entry, same_exit);
        EXPECT_TRUE(same_bits(entry, same_entry) && same_bits(exit, same_exit));
      }
    }
}

TEST(Splat, DrawsNothingOfNothing) {
  const View view = perspective_view({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 1.0f, 10, 7);
  Image<float> entry, exit;
  draw(view, {}, entry, exit);
  for (const float value : entry) EXPECT_EQ(value, kInfinity);
  for (const float value : exit) EXPECT_EQ(value, -kInfinity);
}

}  // namespace
}  // namespace meniscus
