#include "sim/pbf.h"

#include <cmath>

#include "meniscus/formulas/fluids.h"
#include "sim/parted_solver.h"
#include "sim/wall_kernel.h"

namespace meniscus {
namespace {

/// Part of XSPH's blend that acts at walls: between slipping and sticking.
constexpr float kWallFriction = 0.25f;
/// The walls' own push, times h^2; 2 and more would not be stable.
constexpr float kWallPush = 0.2f;
/// With a single iteration nothing dampens what it overshoots: energy grows.
constexpr int kFewestIterations = 2;
/// A particle moves no farther than this in a step, in smoothing lengths; what is faster is slowed.
constexpr float kFarthest = 2.0f;

class PbfSolver final : public PartedSolver {
 public:
  /// @param options  without gaps
  explicit PbfSolver(const FluidOptions& options)
      : PartedSolver(longest_pbf_step(options)), options_(options), constants_(pbf_constants(options)) {}

 private:
  void part_step(Fluid& fluid, const Boundary& boundary, vec3 gravity, std::span<const vec3> forces, float dt,
                 std::span<Impulse> impulses, StageTimes* times) override {
    const std::size_t count = fluid.size();
    const auto over_pieces = [&](const char* stage, auto body) {
      const StageTimer timer(times, stage);
      parallel_for(count, Neighbours::kPiece, body);
    };
    const auto each = [&](const char* stage, auto body) {
      over_pieces(stage, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) body(i);
      });
    };
    for (auto* values : {&ahead_x_, &ahead_y_, &ahead_z_}) values->resize(count);
    each("move", [&](std::size_t i) { predict(fluid, i, forces.empty() ? gravity : gravity + forces[i], dt); });
    {
      const StageTimer timer(times, "neighbours");
      neighbours_.find(ahead_x_, ahead_y_, ahead_z_, constants_.h);
    }
    {
      const StageTimer timer(times, "walls");
      walls_.find(boundary, neighbours_, constants_.h);
      impulses_.clear(neighbours_.pieces());
    }
    state_.resize(count, options_.vorticity > 0);
    each("walls", [&](std::size_t i) { begin_at_walls(fluid, i); });
    for (int iteration = 0; iteration < std::max(options_.iterations, kFewestIterations); ++iteration) {
      over_pieces("constraint", [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) feel_walls(i);
        pbf_lambda(constants_, neighbours_, state_, begin, end);
      });
      over_pieces("constraint", [&](std::size_t begin, std::size_t end) {
        pbf_change(constants_, neighbours_, state_, begin, end);
        for (std::size_t i = begin; i < end; ++i) change(boundary, i, dt);
      });
    }
    each("velocity", [&](std::size_t i) {
      const vec3 velocity = (place(i) - start_of(fluid, i)) / dt;
      set_record(state_.velocity, i, velocity);
    });
    over_pieces("velocity", [&](std::size_t begin, std::size_t end) {
      pbf_blend(constants_, neighbours_, state_, begin, end);
      for (std::size_t i = begin; i < end; ++i) finish(fluid, boundary, i);
    });
    if (options_.vorticity > 0) {
      over_pieces("velocity", [&](std::size_t begin, std::size_t end) {
        pbf_curl_slope(constants_, neighbours_, state_, begin, end);
        for (std::size_t i = begin; i < end; ++i) confine(fluid, i, dt);
      });
    }
    impulses_.add_to(impulses);
  }

  vec3 place(std::size_t i) const { return state_.place_of(i); }
  vec3 start_of(const Fluid& fluid, std::size_t i) const {
    const std::uint32_t given = neighbours_.grid().given_index(i);
    return {fluid.x[given], fluid.y[given], fluid.z[given]};
  }
  static void set_record(std::vector<float>& records, std::size_t i, vec3 value) {
    records[4 * i] = value.x;
    records[4 * i + 1] = value.y;
    records[4 * i + 2] = value.z;
    records[4 * i + 3] = 0.0f;
  }
  void set_place(std::size_t i, vec3 place) { set_record(state_.place, i, place); }

  void predict(const Fluid& fluid, std::size_t given, vec3 outer, float dt) {
    const vec3 velocity =
        slowed(vec3{fluid.vx[given], fluid.vy[given], fluid.vz[given]} + dt * outer, kFarthest * constants_.h / dt);
    ahead_x_[given] = fluid.x[given] + dt * velocity.x;
    ahead_y_[given] = fluid.y[given] + dt * velocity.y;
    ahead_z_[given] = fluid.z[given] + dt * velocity.z;
  }

  /// What began the step within a wall is put out of it without becoming faster.
  void begin_at_walls(Fluid& fluid, std::size_t i) {
    const std::uint32_t given = neighbours_.grid().given_index(i);
    const vec3 start = start_of(fluid, i), ahead = neighbours_.grid().position(i);
    vec3 out = neighbours_.coincident(i) ? 1e-3f * constants_.h * some_direction(given) : vec3{0.0f};
    for (const Wall& wall : walls_.of(i)) {
      const float distance = wall.distance + dot(wall.normal, start + out - ahead);
      if (distance < contact()) out += limited(wall, contact() - distance) * wall.normal;
    }
    fluid.x[given] += out.x;
    fluid.y[given] += out.y;
    fluid.z[given] += out.z;
    set_place(i, ahead + out);
  }

  float contact() const { return kContact_rel * options_.spacing; }
  /// Out of bodies only so far at once, lest one that appears within the water throws it about.
  float limited(const Wall& wall, float way) const { return wall.body < 0 ? way : std::min(way, options_.spacing); }

  /// The walls' part of the density and of its gradient, where the particle is now; keeps the slopes of each wall's.
  void feel_walls(std::size_t i) {
    const std::span<const Wall> walls = walls_.of(i);
    float solid = 0;
    vec3 gradient{0.0f};
    if (!walls.empty()) {
      float distance[Boundary::kMostWalls];
      distances(walls, i, distance);
      const WallShares shares = wall_shares(walls, distance, constants_.h);
      solid = constants_.solid * shares.solid;
      const float per_h = 1.0f / constants_.h;
      float* slope = walls_.kept(i);
      for (std::size_t w = 0; w < walls.size(); ++w) {
        slope[w] = constants_.solid * shares.weight[w] * per_h * formulas::spiky_over_plane(distance[w] * per_h, 1.0f);
        gradient -= slope[w] * walls[w].normal;
      }
    }
    state_.solid[i] = solid;
    state_.wall_x[i] = gradient.x;
    state_.wall_y[i] = gradient.y;
    state_.wall_z[i] = gradient.z;
  }

  void distances(std::span<const Wall> walls, std::size_t i, float* distance) const {
    const vec3 moved = place(i) - neighbours_.grid().position(i);
    for (std::size_t w = 0; w < walls.size(); ++w) distance[w] = walls[w].distance + dot(walls[w].normal, moved);
  }

  void change(const Boundary& boundary, std::size_t i, float dt) {
    const vec3 before = place(i);
    vec3 way{state_.dx[i], state_.dy[i], state_.dz[i]};
    // Neighbours and walls move it not as far in all as walls were looked for: nothing leaves through a wall that it
    // does not know.
    const float farthest = 0.45f * constants_.h / static_cast<float>(std::max(options_.iterations, kFewestIterations)),
                distance_now = length(way);
    if (!(distance_now <= farthest)) way *= std::isfinite(distance_now) ? farthest / distance_now : 0.0f;
    vec3 now = before + way;
    const std::span<const Wall> walls = walls_.of(i);
    if (!walls.empty()) {
      const float mass_rate = options_.rest_density * constants_.volume / dt;
      const vec3 centre = neighbours_.grid().position(i);
      float distance[Boundary::kMostWalls];
      distances(walls, i, distance);
      const auto push = [&](const Wall& wall, vec3 out) {
        now += out;
        if (wall.body >= 0) impulses_.add(i / Neighbours::kPiece, boundary, wall.body, -mass_rate * out, before);
      };
      const float* slope = walls_.kept(i);
      // The slope of the particle's own constraint, as for its neighbours, and the walls' own push. (To count lambda
      // twice, as if the water beyond the wall were pressed as well, feeds energy in: water at rest then boils.)
      for (std::size_t w = 0; w < walls.size(); ++w) {
        const float own = kWallPush * constants_.h * constants_.h * wall_barrier(distance[w], options_.spacing);
        push(walls[w], std::min(own - state_.lambda(i) * slope[w], farthest) * walls[w].normal);
      }
      for (int pass = 0; pass < (walls.size() > 1 ? 3 : 1); ++pass)
        for (const Wall& wall : walls) {
          const float gap = wall.distance + dot(wall.normal, now - centre);
          if (gap < contact()) push(wall, limited(wall, contact() - gap) * wall.normal);
        }
    }
    set_place(i, now);
  }

  /// Speeds and places to where they are kept; walls drag.
  void finish(Fluid& fluid, const Boundary& boundary, std::size_t i) {
    const std::uint32_t given = neighbours_.grid().given_index(i);
    vec3 velocity = state_.velocity_of(i);
    vec3 added{state_.dx[i], state_.dy[i], state_.dz[i]};
    const std::span<const Wall> walls = walls_.of(i);
    if (!walls.empty() && constants_.blend > 0) {
      float distance[Boundary::kMostWalls];
      distances(walls, i, distance);
      const WallShares shares = wall_shares(walls, distance, constants_.h);
      const float mass = options_.rest_density * constants_.volume;
      for (std::size_t w = 0; w < walls.size(); ++w) {
        const float part =
            kWallFriction * constants_.blend * shares.weight[w] * formulas::poly6_beyond(distance[w], constants_.h);
        const vec3 drag = part * (walls[w].velocity - velocity);
        added += drag;
        if (walls[w].body >= 0) impulses_.add(i / Neighbours::kPiece, boundary, walls[w].body, -mass * drag, place(i));
      }
    }
    velocity += added;
    fluid.vx[given] = velocity.x;
    fluid.vy[given] = velocity.y;
    fluid.vz[given] = velocity.z;
    const vec3 now = place(i);
    fluid.x[given] = now.x;
    fluid.y[given] = now.y;
    fluid.z[given] = now.z;
  }

  /// v += dt epsilon N x omega with N along the gradient of |omega|.                      [Macklin2013] eq. 16
  void confine(Fluid& fluid, std::size_t i, float dt) const {
    const vec3 slope{state_.dx[i], state_.dy[i], state_.dz[i]};
    const float steepness = length(slope);
    if (!(steepness * constants_.h > 1e-3f * state_.pressed[4 * i + 3])) return;
    const vec3 curl{state_.curl_x[i], state_.curl_y[i], state_.curl_z[i]};
    const vec3 added = dt * options_.vorticity * constants_.h / steepness * cross(slope, curl);
    const std::uint32_t given = neighbours_.grid().given_index(i);
    fluid.vx[given] += added.x;
    fluid.vy[given] += added.y;
    fluid.vz[given] += added.z;
  }

  FluidOptions options_;
  PbfConstants constants_;
  NearWalls walls_;
  ImpulseSums impulses_;
  PbfState state_;
  std::vector<float> ahead_x_, ahead_y_, ahead_z_;  ///< predicted positions, m, in the given order
};

}  // namespace

void PbfState::resize(std::size_t size, bool vorticity) {
  const auto far_away = [&](std::vector<float>& records, float where) {
    records.resize(4 * (size + 1));
    for (int k = 0; k < 3; ++k) records[4 * size + static_cast<std::size_t>(k)] = where;
    records[4 * size + 3] = 0.0f;
  };
  far_away(place, 1e12f);
  far_away(pressed, 1e12f);
  far_away(velocity, 0.0f);
  for (auto* values : {&solid, &wall_x, &wall_y, &wall_z, &dx, &dy, &dz}) values->resize(size);
  if (vorticity)
    for (auto* values : {&curl_x, &curl_y, &curl_z}) values->resize(size);
}

std::unique_ptr<FluidSolver> make_pbf_solver(const FluidOptions& options) {
  return std::make_unique<PbfSolver>(with_defaults(options));
}

}  // namespace meniscus
