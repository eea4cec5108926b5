// What must not change the picture: rigid motion, the particles' order, threads, instruction sets, repetition.
#include "surface/fixtures.h"

namespace meniscus {
namespace {

using namespace surface_tests;

View moved(View view, const glm::mat3& turn, vec3 shift) {
  view.eye = turn * view.eye + shift;
  view.right = turn * view.right;
  view.up = turn * view.up;
  view.forward = turn * view.forward;
  return view;
}

TEST(RigidMotion, LeavesThePictureAsItIs) {
  Random random(91);
  const Particles particles = wavy_tank();
  for (int i = 0; i < 4; ++i) {
    const vec3 a = random.direction(), b = glm::normalize(glm::cross(a, random.direction()));
    const glm::mat3 turn(a, b, glm::cross(a, b));
    const vec3 shift = random.in_cube(0.7f);
    const Particles turned = surface_tests::moved(particles, [&](vec3 p) { return turn * p + shift; });
    const View view = looking_at(particles.bounds(), {1, -0.4f, 0.7f}, kProjections[i % 2], 120, 90);
    for (const bool cull : {false, true}) {
      RaycastOptions with = options();
      with.cull_interior = cull;
      const SurfaceBuffers before = make_raycast_surface(particles, with)->see(view);
      SurfaceBuffers after = make_raycast_surface(turned, with)->see(moved(view, turn, shift));
      for (vec3& n : after.normal) n = glm::transpose(turn) * n;
      const Difference d = difference(before, after);
      EXPECT_GT(d.hits, 1000u);
      EXPECT_LT(d.mismatch, 5e-4) << d;
      EXPECT_LT(d.depth_p99, cull ? 0.01 : 1e-3) << d;
      EXPECT_LT(d.normal_mean, 0.1) << d;
      double thickness_most = 0;
      for (std::size_t p = 0; p < before.thickness.size(); ++p)
        thickness_most =
            std::max(thickness_most, std::abs(static_cast<double>(before.thickness[p]) - after.thickness[p]));
      EXPECT_LT(thickness_most, 0.05 * kSpacing);
    }
  }
}

TEST(Permutation, LeavesThePictureAsItIs) {
  const Particles particles = wavy_tank();
  Random random(92);
  std::vector<std::size_t> order(particles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.bits() % i]);
  Particles shuffled;
  std::vector<vec3> colours, shuffled_colours;
  for (std::size_t i = 0; i < particles.size(); ++i) colours.push_back(vec3{0.5f} + 4.0f * particles.position(i));
  for (const std::size_t i : order) {
    add(shuffled, particles.position(i));
    shuffled_colours.push_back(colours[i]);
  }
  const View view = looking_at(particles.bounds(), {1, -0.4f, 0.7f}, Projection::perspective, 160, 120);
  const SurfaceBuffers a = make_raycast_surface(particles, options(), colours)->see(view);
  const SurfaceBuffers b = make_raycast_surface(shuffled, options(), shuffled_colours)->see(view);
  const Difference d = difference(a, b);
  EXPECT_GT(d.hits, 2000u);
  EXPECT_LT(d.mismatch, 2e-4) << d;
  EXPECT_LT(d.depth_p999, 1e-3) << d;
  EXPECT_LT(d.normal_p99, 0.05) << d;
  for (std::size_t i = 0; i < a.colour.size(); ++i)
    if (a.depth[i] < kInfinity && b.depth[i] < kInfinity) {
      ASSERT_LT(glm::length(a.colour[i] - b.colour[i]), 2e-3f);
    }
}

SurfaceBuffers everything(const Particles& particles, const View& view, SurfaceBuffers* refined) {
  std::vector<vec3> colours;
  for (std::size_t i = 0; i < particles.size(); ++i) colours.push_back(vec3{0.5f} + particles.position(i));
  const auto surface = make_raycast_surface(particles, options(), colours);
  SurfaceBuffers seen = surface->see(view);
  std::vector<vec2> points;
  for (int i = 0; i < 1000; ++i)
    points.emplace_back(0.37f * static_cast<float>(i % 300), 0.21f * static_cast<float>(i));
  for (vec2& p : points)
    p = {std::min(p.x, static_cast<float>(view.width) - 0.5f), std::min(p.y, static_cast<float>(view.height) - 0.5f)};
  *refined = surface->refine(view, seen, points);
  return seen;
}

TEST(Threads, GiveTheSameBitsForAnyNumber) {
  for (const Particles& particles : {wavy_tank(), random_cloud(2000, 200, 93)}) {  // dense and sparse
    const View view = looking_at(particles.bounds(), {1, -0.4f, 0.7f}, Projection::perspective, 203, 141);
    SurfaceBuffers reference, reference_refined;
    for (const int threads : {1, 2, 5, 2}) {
      const ThreadLimit limit(threads);
      SurfaceBuffers refined;
      const SurfaceBuffers seen = everything(particles, view, &refined);
      if (reference.depth.empty()) {
        reference = seen;
        reference_refined = refined;
        EXPECT_GT(hits(seen), 100u);
        continue;
      }
      EXPECT_TRUE(same_bits(seen, reference)) << threads;
      EXPECT_TRUE(same_bits(refined, reference_refined)) << threads;
    }
  }
}

TEST(Threads, GiveTheSameBitsWhereSpheresAreManyEnoughForSeveralBlocks) {
  const Particles particles = random_cloud(120'000, 60, 94);
  const View view = looking_at(particles.bounds(), {1, -0.4f, 0.7f}, Projection::perspective, 101, 77);
  SurfaceBuffers reference;
  for (const int threads : {1, 5}) {
    const ThreadLimit limit(threads);
    const SurfaceBuffers seen = make_raycast_surface(particles, options())->see(view);
    if (reference.depth.empty())
      reference = seen;
    else
      EXPECT_TRUE(same_bits(seen, reference));
  }
}

/// Peak signal to noise ratio over all pixels, dB.
template <class T, class Size>
double psnr(const Image<T>& a, const Image<T>& b, double peak, Size size) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += size(a[i], b[i]);
  return 10 * std::log10(peak * peak / std::max(sum / static_cast<double>(a.size()), 1e-30));
}

class BestInstructionSet {
 public:
  ~BestInstructionSet() { use_instruction_set("best"); }
};

TEST(InstructionSets, GiveTheSamePicture) {
  const BestInstructionSet restore;
  const auto sets = instruction_sets();
  ASSERT_FALSE(sets.empty());
  const Particles particles = wavy_tank();
  const View view = looking_at(particles.bounds(), {1, -0.4f, 0.7f}, Projection::perspective, 160, 120);
  use_instruction_set(sets.front());
  SurfaceBuffers refined;
  const SurfaceBuffers best = everything(particles, view, &refined);
  const double extent = glm::length(particles.bounds().extent());
  for (const std::string& set : sets) {
    use_instruction_set(set);
    const SurfaceBuffers seen = everything(particles, view, &refined);
    EXPECT_LT(difference(best, seen).mismatch, 2e-4) << set;
    EXPECT_GT(psnr(best.normal, seen.normal, 1.0,
                   [](vec3 p, vec3 q) { return static_cast<double>(glm::dot(p - q, p - q)) / 3; }),
              80)
        << set;
    EXPECT_GT(psnr(best.depth, seen.depth, extent,
                   [&](float p, float q) {
                     if (p == q) return 0.0;
                     return p < kInfinity && q < kInfinity ? std::pow(static_cast<double>(p) - q, 2) : extent * extent;
                   }),
              60)
        << set;
    EXPECT_GT(psnr(best.thickness, seen.thickness, extent,
                   [](float p, float q) { return std::pow(static_cast<double>(p) - q, 2); }),
              60)
        << set;
    EXPECT_GT(psnr(best.colour, seen.colour, 1.0,
                   [](vec3 p, vec3 q) { return static_cast<double>(glm::dot(p - q, p - q)) / 3; }),
              60)
        << set;
  }
}

TEST(InstructionSets, AreNamedWhenAnotherIsAskedFor) {
  const BestInstructionSet restore;
  try {
    use_instruction_set("nonsense");
    ADD_FAILURE() << "was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
    EXPECT_NE(std::string(error.what()).find("nonsense"), std::string::npos);
    for (const std::string& set : instruction_sets())
      EXPECT_NE(std::string(error.what()).find(set), std::string::npos) << set;
  }
}

}  // namespace
}  // namespace meniscus
