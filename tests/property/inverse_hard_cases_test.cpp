#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/joint_space.hpp"
#include "robots/inverse/lane_chain.hpp"
#include "robots/inverse/solver.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/chain_parts.hpp"
#include "tests/support/joint_distance.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/twins.hpp"

namespace kinship::inverse::inverse_hard_cases_test {
namespace {

using kinematics::Chain;
using kinematics::ChainParts;
using test::distance;

constexpr std::uint64_t kSeed = 23;
const std::vector<std::string> kModels = {"panda",  "iiwa14",    "iiwa7",       "ur10e",
                                          "sawyer", "sara_like", "planar_5r_a", "planar_7r_c"};

/// Asks for the pose of a configuration, and checks everything that comes back.
struct Asked {
  Asked(const Chain& chain, const Solver& solver, const Eigen::VectorXd& q,
        const InverseOptions& options = {})
      : Asked(chain, solver, kinematics::T_base_tip(chain, q), options) {}

  Asked(const Chain& chain, const Solver& solver, const Eigen::Isometry3d& T_base_tip,
        const InverseOptions& options = {})
      : found(solver.solve(T_base_tip, options)) {
    const Eigen::MatrixXd& all = found.configurations;
    EXPECT_EQ(all.cols() == 0, found.reason != NoSolution::None);
    for (Eigen::Index i = 0; i < all.cols(); ++i) {
      EXPECT_TRUE(chain.within_limits(all.col(i))) << all.col(i).transpose();
      EXPECT_TRUE(reaches(chain, T_base_tip * chain.T_tip_transfer(), all.col(i)))
          << all.col(i).transpose();
      for (Eigen::Index k = 0; k < i; ++k)
        EXPECT_GE(distance(chain, all.col(i), all.col(k)), options.min_distance);
    }
  }

  bool solved() const { return found.configurations.cols() > 0; }

  InverseSolutions found;
};

Eigen::VectorXd draw(const Chain& chain, std::mt19937_64& generator) {
  return test::random_configuration(chain, generator);
}

/// Share of poses of random configurations that are solved.
double solved_share(const Chain& chain, int poses, std::mt19937_64& generator) {
  const Solver solver(chain);
  int solved = 0;
  for (int i = 0; i < poses; ++i)
    solved += Asked(chain, solver, draw(chain, generator)).solved() ? 1 : 0;
  return static_cast<double>(solved) / poses;
}

TEST(InverseOfAnyChain, OfOneToTenJointsTurningAndSlidingOfAnySize) {
  std::mt19937_64 generator(kSeed);
  for (int joints = 1; joints <= 10; ++joints)
    for (const double length_m : {1e-3, 0.3, 20.0})
      for (const double sliding : {0.0, 0.3}) {
        const Chain chain = test::random_chain({.joints = joints,
                                                .length_m = length_m,
                                                .limit = 2.5,
                                                .sliding_share = sliding,
                                                .continuous_share = 0.2},
                                               generator);
        EXPECT_GE(solved_share(chain, 25, generator), 0.95)
            << joints << " joints of " << length_m << " m, sliding " << sliding;
      }
}

TEST(InverseOfAnyChain, WithFreeTaskAxes) {
  std::mt19937_64 generator(kSeed);
  for (int mask = 1; mask < 63; mask += 4) {
    ChainParts parts = test::parts_of(test::random_chain({}, generator));
    for (std::size_t axis = 0; axis < 6; ++axis)
      parts.task_axes.matters[axis] = (mask >> axis & 1) != 0;
    EXPECT_GE(solved_share(Chain(parts), 10, generator), 0.95) << mask;
  }
}

class InverseOf : public testing::TestWithParam<std::string> {
 protected:
  Chain chain_ = test::model_chain(GetParam());
  std::mt19937_64 generator_{kSeed};
};

TEST_P(InverseOf, EveryJointAtALimit) {
  const Solver solver(chain_);
  int solved = 0;
  constexpr int kPoses = 30;
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::VectorXd q =
        (draw(chain_, generator_).array() > 0.5 * (chain_.lower() + chain_.upper()).array())
            .select(chain_.upper(), chain_.lower());
    solved += Asked(chain_, solver, q).solved() ? 1 : 0;
  }
  EXPECT_GE(solved, 0.9 * kPoses);  // a corner of the limits: of some arms the only configuration
}

TEST_P(InverseOf, OriginsPerturbed) {
  for (const double size : {1e-4, 1e-3, 5e-3}) {
    const Chain twin =
        kinematics::read_chain(
            test::calibrated_twin(test::model_description(GetParam()), "twin", size, kSeed))
            .value();
    EXPECT_GE(solved_share(twin, 60, generator_), 0.98) << size;
  }
}

TEST_P(InverseOf, AnyNumberOfThreadsGivesTheSameBytes) {
  constexpr std::size_t kPoses = 60;
  const Solver solver(chain_);
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < kPoses; ++i)
    poses.push_back(kinematics::T_base_tip(chain_, draw(chain_, generator_)));
  const auto solve_all = [&](std::size_t threads) {
    std::vector<Eigen::MatrixXd> found(kPoses);
    std::vector<std::jthread> workers;
    for (std::size_t t = 0; t < threads; ++t)
      workers.emplace_back([&, t] {
        for (std::size_t i = t; i < kPoses; i += threads)
          found[i] = solver.solve(poses[i], {.seed = 5}).configurations;
      });
    workers.clear();
    return found;
  };
  const auto one = solve_all(1), three = solve_all(3);
  for (std::size_t i = 0; i < kPoses; ++i) {
    EXPECT_EQ(one[i], three[i]);
    EXPECT_EQ(one[i], inverse(chain_, poses[i], {.seed = 5}).configurations);
  }
}

TEST_P(InverseOf, EveryInstructionSetGivesTheSameSolutions) {
  constexpr int kPoses = 300;
  std::vector<Solver> solvers;
  for (const InstructionSet& set : instruction_sets())
    solvers.emplace_back(chain_, set.kernels, Solver::Engines::Descents);
  std::vector<int> same(solvers.size(), 0);
  for (int i = 0; i < kPoses; ++i) {
    const Eigen::Isometry3d T = kinematics::T_base_tip(chain_, draw(chain_, generator_));
    const Eigen::MatrixXd first = solvers.front().solve(T).configurations;
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      const Eigen::MatrixXd other = solvers[s].solve(T).configurations;
      same[s] += first.cols() == other.cols() && (first - other).norm() < 1e-5 ? 1 : 0;
    }
  }
  for (std::size_t s = 0; s < solvers.size(); ++s)
    EXPECT_GE(same[s], 0.995 * kPoses) << instruction_sets()[s].name;
}

INSTANTIATE_TEST_SUITE_P(Models, InverseOf, testing::ValuesIn(kModels),
                         [](const auto& instance) { return instance.param; });

TEST(InverseReasons, AMillimetreOutOfReachOfAnyArm) {
  std::mt19937_64 generator(kSeed);
  for (const std::string& model : kModels) {
    const Chain chain = test::model_chain(model);
    const Solver solver(chain);
    // No arm reaches farther than its longest configuration: taken as stretched by trying.
    for (int i = 0; i < 10; ++i) {
      Eigen::Isometry3d T = kinematics::T_base_tip(chain, draw(chain, generator));
      T.translation().head<2>() *= 50;
      EXPECT_EQ(Asked(chain, solver, T).found.reason, NoSolution::OutOfReach) << model;
    }
  }
}

}  // namespace
}  // namespace kinship::inverse::inverse_hard_cases_test
