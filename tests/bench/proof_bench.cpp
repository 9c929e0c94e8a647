// What it costs to prove edges instead of asking about them every 0.05 joint units, in CPU time of
// one thread.
//
//   proof_bench edges | planning
//
// edges: random ones in the shelf cell, beside steps and FCL's continuous collision, which knows no
// arms. planning: plans of the studies' furniture and of the quickstart's tasks, with goal
// configurations and shortcuts, proven and by steps in turn.

#include <fcl/narrowphase/continuous_collision.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "client/experiments/station_problems.hpp"
#include "client/experiments/studies/fleet.hpp"
#include "client/guided/plan_problem.hpp"
#include "robots/collision/edge_prover.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/planning/path_vertices.hpp"
#include "tests/bench/fcl_world.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/support/places.hpp"

namespace kinship::bench {
namespace {

constexpr double kStep = 0.05;
constexpr std::uint64_t kSeed = 1;

guided::PlanSettings proven() { return {}; }

guided::PlanSettings by_steps() {
  guided::PlanSettings settings;
  settings.resolution = kStep;
  settings.clearance_m = 0;
  return settings;
}

/// Times of the same plans both ways.
struct Times {
  std::vector<double> proven_s, steps_s;
  int proven_solved = 0, steps_solved = 0;
  std::uint64_t refuted = 0;

  void plan(const guided::PlannedRobot& robot, const Problem& problem, bool proves) {
    const double before_s = thread_cpu_s();
    const guided::PlannedProblem planned = guided::plan_problem(
        robot, problem, {}, proves ? proven() : by_steps(), [] { return false; });
    (proves ? proven_s : steps_s).push_back(thread_cpu_s() - before_s);
    (proves ? proven_solved : steps_solved) += planned.result.solved ? 1 : 0;
    refuted += planned.result.refuted_edges;
  }

  void add(const guided::PlannedRobot& robot, const Problem& problem) {
    constexpr int kTimes = 4;  // the first of each warms up
    for (int i = 0; i < kTimes; ++i)
      for (const bool proves : {i % 2 == 0, i % 2 != 0}) {
        plan(robot, problem, proves);
        if (i == 0)
          (proves ? proven_s : steps_s).pop_back();
      }
  }

  void print_as(const std::string& name) const {
    constexpr double kMilliseconds = 1e3;
    constexpr double kMostRatio = 1.3;
    const std::string note = std::to_string(proven_solved) + " solved, " +
                             std::to_string(steps_solved) + " by steps; " +
                             std::to_string(refuted) + " edges refuted";
    print({.name = name + ", mean",
           .value = kMilliseconds * mean(proven_s),
           .unit = "ms",
           .reference = Reference{"steps of 0.05", kMilliseconds * mean(steps_s)},
           .ratio_budget = kMostRatio,
           .note = note});
    print({.name = name + ", median",
           .value = kMilliseconds * median(proven_s),
           .unit = "ms",
           .reference = Reference{"steps of 0.05", kMilliseconds * median(steps_s)},
           .ratio_budget = kMostRatio,
           .note = note});
  }
};

void plan_furniture(int instances) {
  Times all;
  for (const experiments::Study& study : experiments::studies()) {
    if (study.family != "furniture")
      continue;
    for (const experiments::StudyMember& member : experiments::load_fleet(
             study, std::filesystem::path(test::source_dir()) / "robots/models"))
      for (int i = 0; i < instances; ++i)
        all.add({member.robot.chain, member.robot.shapes},
                member.draw(experiments::seed_of(experiments::InstanceSet::Tuning, 0),
                            static_cast<std::uint32_t>(i)));
  }
  all.print_as("furniture");
}

void plan_station(experiments::Station station, int instances) {
  Times all;
  for (const char* name : {"panda", "iiwa14", "ur10e"}) {
    const models::LoadedRobot robot =
        models::load_robot(
            {.source = std::filesystem::path(test::source_dir()) / "robots/models" / name})
            .value_or_throw();
    const guided::PlannedRobot planned(robot.chain, robot.shapes);
    for (int i = 0; i < instances; ++i)
      all.add(planned, experiments::draw_station_problem(
                           station, robot, experiments::placement_at(station, name),
                           {kSeed, static_cast<std::uint32_t>(i), 0}));
  }
  all.print_as(std::string(to_text(station)));
}

/// What of a cell moves, and what stands around, for FCL's continuous collision. It knows no arms:
/// each solid goes from its pose at one end to that at the other along a screw.
class ContinuousWorld {
 public:
  ContinuousWorld(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                  const collision::Surroundings& around)
      : chain_(chain), bodies_(collision::bodies_among({chain, shapes}, around)) {
    for (const collision::Body& body : bodies_)
      shapes_.push_back(fcl_shape(body.solid.shape()));
  }

  bool is_free(const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
    auto at_from = collision::standing_poses(bodies_), at_to = at_from;
    collision::place_bodies(chain_, bodies_, from, at_from);
    collision::place_bodies(chain_, bodies_, to, at_to);
    fcl::ContinuousCollisionRequest<double> request;
    request.ccd_motion_type = fcl::CCDM_SCREW;
    for (std::size_t a = 0; a < bodies_.size(); ++a)
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        if (bodies_[a].joint < 1 || bodies_[b].kind != collision::BodyKind::Obstacle)
          continue;
        fcl::ContinuousCollisionResult<double> result;
        fcl::continuousCollide(shapes_[a].get(), at_from[a], at_to[a], shapes_[b].get(), at_from[b],
                               at_to[b], request, result);
        if (result.is_collide)
          return false;
      }
    return true;
  }

 private:
  const kinematics::Chain& chain_;
  std::vector<collision::Body> bodies_;
  std::vector<std::shared_ptr<fcl::CollisionGeometry<double>>> shapes_;
};

/// One way to answer about edges.
struct Answers {
  double taken_s = 0;
  int free = 0, wrong = 0;  ///< called free, and of those touching

  template <typename Ask>
  void ask(const Ask& is_free, bool is_truly_free) {
    const double before_s = thread_cpu_s();
    const bool said_free = is_free();
    taken_s += thread_cpu_s() - before_s;
    free += said_free ? 1 : 0;
    wrong += said_free && !is_truly_free ? 1 : 0;
  }
};

bool is_free_by(collision::CollisionWorld& world, const Eigen::VectorXd& from,
                const Eigen::VectorXd& to, double step) {
  Eigen::MatrixXd ends(from.size(), 2);
  ends << from, to;
  const Eigen::MatrixXd dense = planning::densified(ends, step);
  return world.free_ahead(dense) == dense.cols();
}

void ask_edges(const std::string& robot, int edges) {
  constexpr double kDense = 1e-3, kSpread_rad = 0.5;
  const kinematics::Chain chain = test::model_chain(robot);
  std::mt19937_64 generator(kSeed);
  std::normal_distribution<double> normal(0, kSpread_rad);
  const ShelfCell cell = make_shelf_cell(chain, generator);
  collision::Surroundings around = cell.surroundings;
  around.checks_links = false;  // as FCL's continuous collision is asked
  const geometry::RobotShapes shapes = model_shapes(robot);
  collision::CollisionWorld world(chain, shapes, around);
  collision::EdgeProver prover(world);
  ContinuousWorld continuous(chain, shapes, around);
  const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
  const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_start, middle);
  Answers proofs, steps, fcl;
  for (int i = 0; i < edges; ++i) {
    const Eigen::VectorXd from = starts.col(i % starts.cols());
    const Eigen::VectorXd to =
        from + Eigen::VectorXd::NullaryExpr(chain.dof(), [&] { return normal(generator); });
    const bool truly = is_free_by(world, from, to, kDense);
    proofs.ask([&] { return prover.prove(from, to).is_free(); }, truly);
    steps.ask([&] { return is_free_by(world, from, to, kStep); }, truly);
    fcl.ask([&] { return continuous.is_free(from, to); }, truly);
  }
  constexpr double kMicroseconds = 1e6;
  const auto figure = [&](const std::string& reference, const Answers& other) {
    const auto text = [](const Answers& answers) {
      return std::to_string(answers.free) + " called free, " + std::to_string(answers.wrong) +
             " of them touch";
    };
    print({.name = robot + ", an edge, beside " + reference,
           .value = kMicroseconds * proofs.taken_s / edges,
           .unit = "us",
           .reference = Reference{reference, kMicroseconds * other.taken_s / edges},
           .note = text(proofs) + "; " + reference + ": " + text(other)});
  };
  figure("steps of 0.05", steps);
  figure("FCL's continuous collision", fcl);
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  using namespace kinship::bench;
  constexpr int kEdges = 2000, kInstances = 24;
  if (argc > 1 && std::string(argv[1]) == "edges")
    for (const char* robot : {"panda", "iiwa14", "ur10e"})
      ask_edges(robot, kEdges);
  if (argc > 1 && std::string(argv[1]) == "planning") {
    plan_furniture(kInstances);
    plan_station(kinship::experiments::Station::Shelf, kInstances);
    plan_station(kinship::experiments::Station::Machine, kInstances);
  }
}
