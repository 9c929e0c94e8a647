// Collision checks and time of our uniform CBiRRT2 against OMPL's RRTConnect on its
// ProjectedStateSpace, side by side: tilt-limited carrying over a post into a bin, the same
// instances, goals, bounds, constraint and resolution.
// Usage: constrained_planning_bench [ROBOT] [INSTANCES]

#include <ompl/base/ConstrainedSpaceInformation.h>
#include <ompl/base/Constraint.h>
#include <ompl/base/spaces/constraint/ProjectedStateSpace.h>

#include <cstdlib>
#include <iostream>

#include "client/planning/cbirrt2.hpp"
#include "client/planning/state_space.hpp"
#include "tests/bench/planning_attempts.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/support/carrying_cell.hpp"

namespace kinship::bench {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr double kStep = 0.1;

/// The region as OMPL takes it: how far roll and pitch are outside their bounds, with its
/// derivative; the projection is OMPL's own.
class TiltConstraint : public ob::Constraint {
 public:
  TiltConstraint(Eigen::Index dof, const planning::RegionConstraint& region)
      : ob::Constraint(static_cast<unsigned>(dof), 2, 0.5e-3), region_(region) {}

  void function(const Eigen::Ref<const Eigen::VectorXd>& q,
                Eigen::Ref<Eigen::VectorXd> out) const override {
    out = region_.excess(q).segment<2>(3);
  }

  void jacobian(const Eigen::Ref<const Eigen::VectorXd>& q,
                Eigen::Ref<Eigen::MatrixXd> out) const override {
    const planning::RegionConstraint::Vector6 excess = region_.excess(q);
    out = region_.derivative(q).middleRows<2>(3);
    for (Eigen::Index i = 0; i < 2; ++i)
      if (excess[3 + i] == 0)
        out.row(i).setZero();
  }

 private:
  const planning::RegionConstraint& region_;
};

struct Carrying {
  const kinematics::Chain& chain;
  collision::CollisionWorld& world;
  const TaskSpaceRegion& upright;
  Instance instance;
  Eigen::Matrix2Xd bounds;

  planning::RegionConstraint constraint() const {
    return {chain, upright, Eigen::Isometry3d::Identity(), bounds};
  }
};

Attempt run_cbirrt2(const Carrying& carrying, double overshoot, std::uint64_t seed) {
  planning::BirrtOptions options;
  options.step = kStep;
  options.overshoot = overshoot;
  options.max_checks = kMaxPlanChecks;
  options.time_limit = std::chrono::seconds(600);
  planning::RegionConstraint constraint = carrying.constraint();
  const planning::IsFree is_free = [&](const Eigen::VectorXd& q) {
    return !carrying.world.collides(q);
  };
  std::mt19937_64 generator(seed);
  return attempt_of(planning::plan_cbirrt2(
      carrying.instance.start, carrying.instance.goals, {is_free, constraint},
      planning::ConfigurationSampler(carrying.bounds), options, generator));
}

/// \param range  of one extension, joint units; 0: OMPL's choice.
Attempt run_ompl(const Carrying& carrying, double range, std::uint64_t seed) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(seed + 1);
  const planning::RegionConstraint region = carrying.constraint();
  const auto ambient = planning::make_state_space(carrying.bounds);
  const auto constraint = std::make_shared<TiltConstraint>(carrying.chain.dof(), region);
  const auto space = std::make_shared<ob::ProjectedStateSpace>(ambient, constraint);
  space->setDelta(kStep);
  const auto information = std::make_shared<ob::ConstrainedSpaceInformation>(space);
  og::SimpleSetup setup(information);
  const auto configuration = [](const ob::State& state) -> Eigen::VectorXd {
    return *state.as<ob::ConstrainedStateSpace::StateType>();
  };
  setup.setStateValidityChecker(
      [&](const ob::State* state) { return !carrying.world.collides(configuration(*state)); });
  return run_rrt_connect(setup, carrying.instance, range, carrying.world,
                         [](const Eigen::VectorXd& q, ob::State& state) {
                           state.as<ob::ConstrainedStateSpace::StateType>()->copy(q);
                         });
}

/// Free configurations at the place, the hand turned by nothing or by half a turn.
Eigen::MatrixXd place_configurations(const kinematics::Chain& chain,
                                     collision::CollisionWorld& world,
                                     const Eigen::Isometry3d& T_base_place,
                                     const Eigen::VectorXd& start) {
  const Eigen::Isometry3d turned = T_base_place * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ());
  const Eigen::MatrixXd one = free_configurations(chain, world, T_base_place, start);
  const Eigen::MatrixXd other = free_configurations(chain, world, turned, start);
  Eigen::MatrixXd goals(chain.dof(), one.cols() + other.cols());
  goals << one, other;
  return goals;
}

int run(const std::string& robot, int instances) {
  const kinematics::Chain chain = test::model_chain(robot);
  const geometry::RobotShapes shapes = model_shapes(robot);
  std::vector<std::vector<Attempt>> attempts(5);
  for (int i = 0; i < instances; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    std::mt19937_64 generator(seed);
    const test::CarryingCell cell = test::make_carrying_cell(chain, generator);
    collision::CollisionWorld world(chain, shapes, cell.surroundings);
    const Eigen::VectorXd middle = (chain.lower() + chain.upper()) / 2;
    const Eigen::MatrixXd starts = free_configurations(chain, world, cell.T_base_pick, middle);
    if (starts.cols() == 0)
      continue;
    const Eigen::VectorXd start = starts.col(0);
    const Carrying carrying = {
        chain,
        world,
        cell.upright,
        {start, place_configurations(chain, world, cell.T_base_place, start)},
        planning::planning_bounds(chain, start)};
    if (carrying.instance.goals.cols() == 0)
      continue;
    attempts[0].push_back(run_cbirrt2(carrying, 1.0, seed));
    attempts[1].push_back(run_cbirrt2(carrying, 1.5, seed));
    attempts[2].push_back(run_ompl(carrying, 0, seed));
    attempts[3].push_back(run_ompl(carrying, 0.5, seed));
    attempts[4].push_back(run_ompl(carrying, 1.5, seed));
    std::cerr << "instance " << i;
    for (const auto& of_planner : attempts)
      std::cerr << "  " << of_planner.back().checks;
    std::cerr << '\n';
  }
  std::cout << robot << ", " << attempts[0].size() << " of " << instances << " instances, step "
            << kStep << ", at most " << kMaxPlanChecks << " checks\n";
  print_header();
  print("CBiRRT2, overshoot 1", attempts[0]);
  print("CBiRRT2, overshoot 1.5", attempts[1]);
  print("RRTConnect, range of OMPL", attempts[2]);
  print("RRTConnect, range 0.5", attempts[3]);
  print("RRTConnect, range 1.5", attempts[4]);
  return attempts[0].empty() ? 1 : 0;
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  return kinship::bench::run(argc > 1 ? argv[1] : "panda", argc > 2 ? std::atoi(argv[2]) : 50);
}
