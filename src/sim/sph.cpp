#include "sim/sph.h"

#include <cmath>

#include "meniscus/formulas/fluids.h"
#include "sim/parted_solver.h"
#include "sim/wall_kernel.h"

namespace meniscus {
namespace {

/// Part of the viscosity that acts at walls: between slipping and sticking.
constexpr float kWallFriction = 0.25f;
/// The walls' own push over the square of the speed of sound; twice as much would not be stable in hard impacts.
constexpr float kWallPush = 2.0f;
/// Surface tension acts where the colour field falls by more than this over a smoothing length.
constexpr float kSurfaceGradient = 0.2f;
/// A particle moves no farther than this in a step, in smoothing lengths; what is faster is slowed.
constexpr float kFarthest = 1.0f;

class SphSolver final : public PartedSolver {
 public:
  /// @param options  without gaps
  explicit SphSolver(const FluidOptions& options)
      : PartedSolver(longest_sph_step(options)), options_(options), constants_(sph_constants(options)) {}

 private:
  void part_step(Fluid& fluid, const Boundary& boundary, vec3 gravity, std::span<const vec3> forces, float dt,
                 std::span<Impulse> impulses, StageTimes* times) override {
    const std::size_t count = fluid.size();
    {
      const StageTimer timer(times, "neighbours");
      neighbours_.find(fluid.x, fluid.y, fluid.z, constants_.h);
      impulses_.clear(neighbours_.pieces());
    }
    {
      const StageTimer timer(times, "walls");
      walls_.find(boundary, neighbours_, constants_.h);
    }
    const auto over_pieces = [&](const char* stage, auto body) {
      const StageTimer timer(times, stage);
      parallel_for(count, Neighbours::kPiece, body);
    };
    state_.resize(count, constants_.tension > 0);
    over_pieces("density", [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t given = neighbours_.grid().given_index(i);
        float* velocity = state_.records.data() + 8 * i + 4;
        velocity[0] = fluid.vx[given];
        velocity[1] = fluid.vy[given];
        velocity[2] = fluid.vz[given];
        velocity[3] = 0.0f;
        state_.solid[i] = solid_around(i);
      }
      sph_density(constants_, neighbours_, state_, begin, end);
    });
    over_pieces("forces",
                [&](std::size_t begin, std::size_t end) { sph_forces(constants_, neighbours_, state_, begin, end); });
    over_pieces("move", [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t given = neighbours_.grid().given_index(i);
        move(fluid, i, given, boundary, forces.empty() ? gravity : gravity + forces[given], dt);
      }
    });
    impulses_.add_to(impulses);
  }

  /// Keeps the walls' weights.
  float solid_around(std::size_t i) {
    const std::span<const Wall> walls = walls_.of(i);
    if (walls.empty()) return 0.0f;
    float distance[Boundary::kMostWalls];
    for (std::size_t w = 0; w < walls.size(); ++w) distance[w] = walls[w].distance;
    const WallShares shares = wall_shares(walls, distance, constants_.h);
    std::copy_n(shares.weight, walls.size(), walls_.kept(i));
    return constants_.solid * shares.solid;
  }

  /// Speed first, then place: symplectic, the leapfrog with speeds half a step late.
  void move(Fluid& fluid, std::size_t i, std::uint32_t given, const Boundary& boundary, vec3 outer, float dt) {
    const float h = constants_.h;
    const std::size_t piece = i / Neighbours::kPiece;
    const float mass = options_.rest_density * constants_.volume;
    const std::span<const Wall> walls = walls_.of(i);
    const vec3 position = state_.position(i);
    vec3 velocity = state_.velocity(i);
    vec3 acceleration = outer + vec3{state_.ax[i], state_.ay[i], state_.az[i]};
    vec3 fall{0.0f};
    float bend = 0;
    if (constants_.tension > 0) {
      fall = {state_.nx[i], state_.ny[i], state_.nz[i]};
      bend = state_.bend[i];
    }

    // Walls push with the pressure of the particle and their own, and drag.
    const float* weight = walls_.kept(i);
    const float pressure = pressure_over_density2(constants_.stiffness, state_.inverse_density(i)), per_h = 1.0f / h;
    for (std::size_t w = 0; w < walls.size(); ++w) {
      const Wall& wall = walls[w];
      const float q = wall.distance * per_h;
      const float push = pressure * weight[w] * per_h * formulas::spiky_over_plane(q, 1.0f) +
                         kWallPush * constants_.stiffness * wall_barrier(wall.distance, options_.spacing);
      const float drag = kWallFriction * constants_.kinematic * state_.inverse_density(i) * weight[w] * per_h * per_h *
                         formulas::viscosity_laplacian_beyond(q, 1.0f);
      const vec3 from_wall = push * wall.normal + drag * (wall.velocity - velocity);
      acceleration += from_wall;
      if (wall.body >= 0) impulses_.add(piece, boundary, wall.body, -mass * dt * from_wall, position);
      if (constants_.tension > 0) {
        fall -= weight[w] * per_h * formulas::poly6_over_plane(q, 1.0f) * wall.normal;
        bend += weight[w] * per_h * per_h * formulas::poly6_laplacian_beyond(q, 1.0f);
      }
    }
    // f = -sigma laplacian(c) n / |n|                                                  [Muller2003] eq. 19
    const float steepness = length(fall);
    if (steepness * h > kSurfaceGradient)
      acceleration -= constants_.tension * state_.inverse_density(i) * bend / steepness * fall;

    velocity = slowed(velocity + dt * acceleration, kFarthest * h / dt);
    vec3 place = position + dt * velocity;
    if (neighbours_.coincident(i)) place += 1e-3f * h * some_direction(given);
    stop_at_walls(walls, position, place, velocity, [&](const Wall& wall, vec3 change) {
      impulses_.add(piece, boundary, wall.body, -mass * change, position);
    });
    fluid.x[given] = place.x;
    fluid.y[given] = place.y;
    fluid.z[given] = place.z;
    fluid.vx[given] = velocity.x;
    fluid.vy[given] = velocity.y;
    fluid.vz[given] = velocity.z;
  }

  /// Keeps a particle out of the walls and takes what speed it has into them.
  /// @param felt  called with the change of velocity for walls of bodies
  template <class Felt>
  void stop_at_walls(std::span<const Wall> walls, vec3 from, vec3& place, vec3& velocity, Felt felt) const {
    const float contact = kContact_rel * options_.spacing;
    for (int pass = 0; pass < (walls.size() > 1 ? 3 : 1); ++pass)
      for (const Wall& wall : walls) {
        const float distance = wall.distance + dot(wall.normal, place - from);
        if (distance >= contact) continue;
        // Out of bodies only so far at once, lest one that appears within the water throws it about.
        place += (wall.body < 0 ? contact - distance : std::min(contact - distance, options_.spacing)) * wall.normal;
        const float approach = dot(velocity - wall.velocity, wall.normal);
        if (approach >= 0) continue;
        const vec3 change = -approach * wall.normal;
        velocity += change;
        if (wall.body >= 0) felt(wall, change);
      }
  }

  FluidOptions options_;
  SphConstants constants_;
  NearWalls walls_;
  ImpulseSums impulses_;
  SphState state_;
};

}  // namespace

void SphState::resize(std::size_t size, bool tension) {
  records.resize(kStride * (size + 1));
  const float nobody[kStride] = {1e18f, 1e18f, 1e18f, 1.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  std::copy_n(nobody, kStride, records.end() - kStride);
  for (auto* values : {&solid, &ax, &ay, &az}) values->resize(size);
  if (tension)
    for (auto* values : {&nx, &ny, &nz, &bend}) values->resize(size);
}

std::unique_ptr<FluidSolver> make_sph_solver(const FluidOptions& options) {
  return std::make_unique<SphSolver>(with_defaults(options));
}

}  // namespace meniscus
